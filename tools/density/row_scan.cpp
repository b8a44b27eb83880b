// SPDX-License-Identifier: BSD-3-Clause
#include "density/row_scan.hpp"

#include <utility>

#include "base/try.hpp"
#include "codec/beam_tables.hpp"
#include "curlidar/io.hpp"
#include "report/measure/tulip.hpp"
#include "sensor/own_frame.hpp"

namespace curlidar::density {

Result<Cloud> read_own_frame(const std::string& path) {
  CURLIDAR_TRY_ASSIGN(cloud, read_cloud(path));
  CURLIDAR_TRY_ASSIGN(rings, detect_sensor(cloud));
  CURLIDAR_TRY_ASSIGN(fit, find_sensor_lattice(cloud, rings, {}));
  return fit ? in_own_frame(cloud, *fit) : std::move(cloud);
}

RowScan image_rows(const Cloud& own) {
  namespace tulip = bench::tulip;
  RowScan scan;
  for (std::size_t row = 0; row < tulip::kRows; ++row) {
    scan.elevations.push_back(tulip::elevation_of_row(static_cast<double>(tulip::kRows - 1 - row)));
  }
  scan.columns = tulip::kColumns;
  const tulip::Image image = tulip::project(own);
  std::vector<float> elevations(image.range_m.size(), 0);
  for (const Vec3& p : own.positions) {
    std::size_t row = 0, column = 0;
    if (!is_return(p) || !tulip::locate(p, row, column)) continue;
    elevations[row * tulip::kColumns + column] = static_cast<float>(elevation_of(p));
  }
  for (std::size_t cell = 0; cell < image.range_m.size(); ++cell) {
    const std::size_t row = cell / tulip::kColumns, column = cell % tulip::kColumns;
    scan.cells.push_back({static_cast<std::uint16_t>(tulip::kRows - 1 - row),
                          static_cast<float>(tulip::azimuth_of_column(static_cast<double>(column))),
                          elevations[cell], static_cast<float>(image.range_m[cell])});
  }
  return scan;
}

RingPoints rings_of(const RowScan& scan, const DensityProfile& profile, bool given) {
  std::vector<std::uint16_t> ring_of_row(scan.elevations.size(), kNoRing);
  std::vector<double> elevations;
  for (std::size_t row = 0; row < ring_of_row.size(); ++row) {
    if (profile.is_given(row) != given) continue;
    ring_of_row[row] = static_cast<std::uint16_t>(elevations.size());
    elevations.push_back(scan.elevations[row]);
  }
  std::vector<Vec3> positions;
  std::vector<std::uint16_t> ring_of_point;
  for (const RowCell& cell : scan.cells) {
    if (!(cell.range_m > 0) || ring_of_row[cell.row] == kNoRing) continue;
    const double elevation =
        scan.exact ? cell.elevation : profile.elevation(cell.row, cell.range_m);
    positions.push_back(direction_of(elevation, cell.azimuth) * cell.range_m);
    ring_of_point.push_back(ring_of_row[cell.row]);
  }
  return {positions, ring_of_point, std::move(elevations), scan.columns};
}

}  // namespace curlidar::density
