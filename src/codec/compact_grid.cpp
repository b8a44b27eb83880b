// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/try.hpp"
#include "codec/compact_model.hpp"
#include "image/range_image.hpp"

namespace curlidar {
namespace {

/// How far a point may look from its cell's middle, in column widths, to be a cell's centre: text
/// files round coordinates.
constexpr double kCentreTolerance = 0.02;
/// Elevations stay this far from the poles, where rows have no columns.
constexpr double kSteepest = std::numbers::pi / 2 - 1e-3;

/// Gives rows without a return a place between, above or below the others, in order.
void place_empty_rows(std::vector<double>& elevations, const std::vector<bool>& known,
                      double usual_step) {
  const std::size_t rows = elevations.size();
  std::size_t first = 0;
  while (!known[first]) ++first;
  std::size_t last = rows - 1;
  while (!known[last]) --last;
  const double step =
      last > first ? (elevations[first] - elevations[last]) / static_cast<double>(last - first)
                   : usual_step;
  const auto room = [](double from_pole, std::size_t count) {
    return from_pole / static_cast<double>(count + 1);
  };
  const double up = std::min(step, room(kSteepest - elevations[first], first));
  for (std::size_t k = first; k-- > 0;) elevations[k] = elevations[k + 1] + up;
  const double down = std::min(step, room(kSteepest + elevations[last], rows - 1 - last));
  for (std::size_t k = last + 1; k < rows; ++k) elevations[k] = elevations[k - 1] - down;
  for (std::size_t k = first + 1; k < last; ++k) {
    if (known[k]) continue;
    std::size_t next = k;
    while (!known[next]) ++next;
    const double share = 1 / static_cast<double>(next - k + 1);
    elevations[k] = elevations[k - 1] + (elevations[next] - elevations[k - 1]) * share;
  }
}

bool strictly_descending(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(),
                            [](double a, double b) { return !(a > b); }) == values.end();
}

/// Distance from the middle of `column`, in columns, across the seam too.
double column_offset(double fine_column, std::uint32_t column, std::uint32_t columns) {
  const double offset = std::abs(fine_column - column);
  return std::min(offset, columns - offset);
}

/// The elevation of every row if the returns of an organised cloud are the centres of its cells.
std::optional<std::vector<double>> rows_of_cell_centres(const Cloud& cloud) {
  if (!cloud.organised() || cloud.width < 4 || cloud.width > 65536 || cloud.height > kMaxRings) {
    return std::nullopt;
  }
  const Lattice circle = Lattice::from_rings({0}, cloud.width);
  const double tolerance = kCentreTolerance * 2 * std::numbers::pi / cloud.width;
  std::vector<double> elevations(cloud.height, 0);
  std::vector<bool> known(cloud.height, false);
  bool any = false;
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    double sum = 0, low = 10, high = -10;
    std::size_t count = 0;
    for (std::uint32_t column = 0; column < cloud.width; ++column) {
      const Vec3& p = cloud.positions[std::size_t{row} * cloud.width + column];
      if (!is_return(p)) continue;
      const double fine = circle.column_of(azimuth_of(p));
      if (column_offset(fine, column, cloud.width) > kCentreTolerance) return std::nullopt;
      const double elevation = elevation_of(p);
      sum += elevation;
      low = std::min(low, elevation);
      high = std::max(high, elevation);
      ++count;
    }
    if (count == 0) continue;
    if (high - low > 2 * tolerance) return std::nullopt;
    elevations[row] = sum / static_cast<double>(count);
    known[row] = any = true;
  }
  if (!any) return std::nullopt;
  place_empty_rows(elevations, known, 2 * std::numbers::pi / cloud.width);
  if (!strictly_descending(elevations)) return std::nullopt;
  return elevations;
}

double max_range_of(const CompactSettings& settings, const Cloud& cloud) {
  if (settings.max_range.metres == 0 && settings.max_range.percentile == 0) {
    return kMaxCompactRangeM;
  }
  return std::min(resolve_max_range(settings.max_range, cloud, {}), kMaxCompactRangeM);
}

/// Columns of an organised cloud: the side that is not the rings'.
std::uint32_t default_columns(const Cloud& cloud, const Detection& detection) {
  if (!cloud.organised()) return kCompactColumns;
  const std::uint32_t side =
      detection.sensor.rings.size() == cloud.width && detection.sensor.rings.size() != cloud.height
          ? cloud.height
          : cloud.width;
  return side >= 4 && side <= 65536 ? side : kCompactColumns;
}

Result<GriddedScan> project_rings(const Cloud& cloud, const EncodeSettings& settings,
                                  double max_range) {
  CURLIDAR_TRY_ASSIGN(
      detection, settings.sensor ? assign_rings(cloud, *settings.sensor) : detect_sensor(cloud));
  if (detection.sensor.pattern == ScanPattern::limited_field) {
    return Error{ErrorCode::unsupported,
                 "the scan comes from a limited-field scanner, which cannot be coded yet: a sensor "
                 "that spins through the full turn is needed"};
  }
  const std::uint32_t columns =
      settings.compact.columns != 0 ? settings.compact.columns : default_columns(cloud, detection);
  return ring_scan(cloud, detection, columns, settings.compact.min_range_m, max_range);
}

/// Sums over the returns of one row; weights are squared ranges, so that distances in metres count.
struct RowSums {
  double n = 0, r = 0, rr = 0, t = 0, rt = 0;  ///< t = range * elevation

  void add(double range, double elevation) {
    n += 1;
    r += range;
    rr += range * range;
    t += range * elevation;
    rt += range * range * elevation;
  }
  /// Of elevation = e + height / range, that is t = e range + height.
  double height() const { return (t * rr - rt * r) / (n * rr - r * r); }
  double elevation_for(double height) const { return (rt - height * r) / rr; }
  /// Whether ranges spread enough to tell the height from the elevation.
  bool tells_height() const { return n >= 32 && n * rr - r * r > 0.01 * n * rr; }
};

/// Heights of rows that cannot tell their own come from the nearest row that can.
void copy_missing_heights(std::vector<double>& heights, const std::vector<bool>& known) {
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (known[k]) continue;
    for (std::size_t d = 1; d < heights.size(); ++d) {
      if (k >= d && known[k - d]) {
        heights[k] = heights[k - d];
        break;
      }
      if (k + d < heights.size() && known[k + d]) {
        heights[k] = heights[k + d];
        break;
      }
    }
  }
}

/// Mean vertical distance of the returns from where their rows look, metres.
double mean_distance(const Cloud& cloud, const GriddedScan& scan, const RowModel& rows) {
  double sum = 0;
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    const double height = rows.height.empty() ? 0 : rows.height[row];
    for (std::uint32_t column = 0; column < scan.columns; ++column) {
      const std::size_t cell = scan.cell(row, column);
      if (scan.source[cell] == kNoPoint) continue;
      const double range = scan.range[cell];
      const double looks = rows.elevation[row] + height / range;
      sum += range * std::abs(elevation_of(cloud.positions[scan.source[cell]]) - looks);
    }
  }
  return sum / static_cast<double>(std::max<std::size_t>(scan.counts.kept, 1));
}

}  // namespace

std::optional<GriddedScan> cell_centre_scan(const Cloud& cloud, double min_range_m,
                                            double max_range_m) {
  std::optional<std::vector<double>> elevations = rows_of_cell_centres(cloud);
  if (!elevations) return std::nullopt;
  GriddedScan out;
  out.rows = cloud.height;
  out.columns = cloud.width;
  out.elevations = *std::move(elevations);
  out.cell_centres = true;
  out.min_range_m = min_range_m;
  out.max_range_m = max_range_m;
  out.sensor = "grid";
  out.range.assign(cloud.size(), 0);
  out.source.assign(cloud.size(), kNoPoint);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_return(cloud.positions[i])) continue;
    ++out.counts.returns;
    const double range = norm(cloud.positions[i]);
    if (range < min_range_m || range > max_range_m) {
      ++out.counts.out_of_range;
      continue;
    }
    ++out.counts.kept;
    out.range[i] = range;
    out.source[i] = static_cast<std::uint32_t>(i);
  }
  return out;
}

GriddedScan ring_scan(const Cloud& cloud, const Detection& detection, std::uint32_t columns,
                      double min_range_m, double max_range_m) {
  GriddedScan out;
  RangeImage image = fill_range_image(cloud, detection.ring_of_point,
                                      Lattice::from_rings(detection.ring_elevations, columns),
                                      RowRule::rings, min_range_m, max_range_m, {}, out.counts);
  out.rows = image.lattice.rows();
  out.columns = columns;
  out.range = std::move(image.range);
  out.source = std::move(image.source);
  out.min_range_m = min_range_m;
  out.max_range_m = max_range_m;
  out.elevations = detection.ring_elevations;
  out.sensor = detection.sensor.name;
  return out;
}

Result<GriddedScan> grid_scan(const Cloud& cloud, const EncodeSettings& settings) {
  if (count_returns(cloud) == 0) {
    return Error{ErrorCode::invalid_argument,
                 "the cloud has no return: every point is (0, 0, 0) or not finite"};
  }
  const double max_range = max_range_of(settings.compact, cloud);
  const bool own_columns = settings.compact.columns == 0 || settings.compact.columns == cloud.width;
  std::optional<GriddedScan> centres;
  if (!settings.sensor && own_columns) {
    centres = cell_centre_scan(cloud, settings.compact.min_range_m, max_range);
  }
  GriddedScan scan;
  if (centres) {
    scan = *std::move(centres);
  } else {
    CURLIDAR_TRY_ASSIGN(projected, project_rings(cloud, settings, max_range));
    scan = std::move(projected);
  }
  if (scan.counts.kept == 0) {
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("no return is left to code: of {} returns {} are out of range and {} "
                    "fit no ring; check the sensor and the limits",
                    scan.counts.returns, scan.counts.out_of_range, scan.counts.out_of_fov)};
  }
  return scan;
}

RowModel fit_rows(const Cloud& cloud, const GriddedScan& scan, double error_m) {
  // Heights cost about a byte a ring, some 2 % of a file at 5 cm.
  constexpr double kWorth = 0.02;
  const RowModel plain{scan.elevations, {}};
  if (scan.cell_centres) return plain;
  RowModel fitted{scan.elevations, std::vector<double>(scan.rows, 0)};
  std::vector<RowSums> sums(scan.rows);
  std::vector<bool> known(scan.rows, false);
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    for (std::uint32_t column = 0; column < scan.columns; ++column) {
      const std::size_t cell = scan.cell(row, column);
      if (scan.source[cell] == kNoPoint) continue;
      sums[row].add(scan.range[cell], elevation_of(cloud.positions[scan.source[cell]]));
    }
    known[row] = sums[row].tells_height();
    if (known[row]) fitted.height[row] = sums[row].height();
  }
  copy_missing_heights(fitted.height, known);
  for (std::uint32_t row = 0; row < scan.rows; ++row) {
    if (sums[row].n > 0) fitted.elevation[row] = sums[row].elevation_for(fitted.height[row]);
  }
  if (!strictly_descending(fitted.elevation)) return plain;
  const double without = mean_distance(cloud, scan, plain);
  const double with = mean_distance(cloud, scan, fitted);
  const double gain = std::hypot(error_m, without) - std::hypot(error_m, with);
  return gain > kWorth * error_m ? fitted : plain;
}

}  // namespace curlidar
