// SPDX-License-Identifier: BSD-3-Clause
#include "density/row_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "codec/beam_tables.hpp"
#include "curlidar/io.hpp"
#include "protocol/tulip_image.hpp"
#include "sensor/own_frame.hpp"

namespace curlidar::density {
namespace {

/// Cells without a return on the columns that are missing between a ring's returns.
void add_missing(const std::vector<RowCell>& ring, std::uint32_t columns,
                 std::vector<RowCell>& cells) {
  constexpr double kApart = 1.8;  // columns: returns beside each other are nearer
  const double column = 2 * std::numbers::pi / columns;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    const double wide = ring[i + 1].azimuth - ring[i].azimuth;
    if (wide < kApart * column) continue;
    const auto missing = static_cast<int>(std::lround(wide / column));
    for (int k = 1; k < missing; ++k) {
      const double azimuth = ring[i].azimuth + wide * k / missing;
      cells.push_back({ring[i].row, static_cast<float>(azimuth), 0, 0});
    }
  }
}

}  // namespace

const BeamModel* OwnScan::beams() const {
  const bool known = lattice && lattice->beams.beams.size() == rings.sensor.rings.size();
  return known ? &lattice->beams : nullptr;
}

Result<OwnScan> read_own_frame(const std::string& path) {
  CURLIDAR_TRY_ASSIGN(cloud, read_cloud(path));
  CURLIDAR_TRY_ASSIGN(rings, detect_sensor(cloud));
  CURLIDAR_TRY_ASSIGN(fit, find_sensor_lattice(cloud, rings, {}));
  OwnScan own{path, fit ? in_own_frame(cloud, *fit) : std::move(cloud), std::move(rings), {}};
  own.lattice = std::move(fit);
  return own;
}

Result<RowScan> image_rows(const Cloud& own) {
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

Result<RowScan> ring_rows(const OwnScan& own) {
  const Detection& detection = own.rings;
  if (detection.source == RingSource::uniform) {
    return Error{ErrorCode::unsupported, "the rings of a scan cannot be told"};
  }
  RowScan scan;
  scan.elevations = detection.ring_elevations;
  scan.columns = detection.sensor.columns;
  scan.exact = true;
  std::vector<std::vector<RowCell>> rings(scan.elevations.size());
  for (std::size_t i = 0; i < own.cloud.size(); ++i) {
    const Vec3& p = own.cloud.positions[i];
    const std::uint16_t ring = detection.ring_of_point[i];
    if (ring == kNoRing || !is_return(p)) continue;
    rings[ring].push_back({ring, static_cast<float>(azimuth_of(p)),
                           static_cast<float>(elevation_of(p)), static_cast<float>(norm(p))});
  }
  for (std::vector<RowCell>& ring : rings) {
    std::sort(ring.begin(), ring.end(),
              [](const RowCell& a, const RowCell& b) { return a.azimuth < b.azimuth; });
    scan.cells.insert(scan.cells.end(), ring.begin(), ring.end());
    add_missing(ring, scan.columns, scan.cells);
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
