// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/try.hpp"
#include "image/range_image.hpp"

namespace curlidar {
namespace {

/// Everything that decides which of two returns keeps a cell, best first.
struct Claim {
  double offset2 = std::numeric_limits<double>::infinity();  ///< squared angle to the centre
  double range = 0;
};

Status check(const ProjectSettings& s) {
  const auto invalid = [](const char* what) { return Error{ErrorCode::invalid_argument, what}; };
  if (s.columns < 4 || s.columns > 65536) return invalid("columns must be in 4..65536");
  if (s.rows > 4096) return invalid("rows must be at most 4096");
  if (!(s.min_range_m >= 0) || !std::isfinite(s.min_range_m)) {
    return invalid("the minimum range must be a finite number of metres, 0 or more");
  }
  if (!(s.max_range.metres >= 0) || !(s.max_range.percentile >= 0) ||
      s.max_range.percentile > 100) {
    return invalid("the maximum range must be metres above 0 or a percentile in (0, 100]");
  }
  return {};
}

}  // namespace

double resolve_max_range(const RangeLimit& limit, const Cloud& cloud, const SensorProfile& sensor) {
  if (limit.percentile > 0) {
    std::vector<double> ranges;
    ranges.reserve(cloud.size());
    for (const Vec3& p : cloud.positions) {
      if (is_return(p)) ranges.push_back(norm(p));
    }
    return percentile(ranges, limit.percentile / 100);
  }
  return limit.metres > 0 ? limit.metres : sensor.max_range_m;
}

Lattice make_lattice(const ProjectSettings& settings, const SensorProfile& sensor) {
  if (settings.row_rule == RowRule::rings) {
    return Lattice::from_rings(sensor.elevations(), settings.columns);
  }
  const auto rows =
      settings.rows != 0 ? settings.rows : static_cast<std::uint32_t>(sensor.rings.size());
  return Lattice::uniform(rows, settings.columns, sensor.fov_up, sensor.fov_down);
}

RangeImage fill_range_image(const Cloud& cloud, const std::vector<std::uint16_t>& ring_of_point,
                            const Lattice& lattice, RowRule row_rule, double min_range_m,
                            double max_range_m, const std::vector<bool>& keep,
                            ProjectionCounts& counts) {
  RangeImage image{lattice, std::vector<double>(lattice.cells(), 0.0),
                   std::vector<std::uint32_t>(lattice.cells(), kNoPoint)};
  std::vector<Claim> claims(lattice.cells());
  const double column_angle = 2 * std::numbers::pi / lattice.columns();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    if (!is_return(p)) continue;
    ++counts.returns;
    if (!keep.empty() && !keep[i]) {
      ++counts.outliers;
      continue;
    }
    const double range = norm(p);
    if (range < min_range_m || range > max_range_m) {
      ++counts.out_of_range;
      continue;
    }
    const double elevation = elevation_of(p);
    const double fine_row = lattice.row_of(elevation);
    const double row =
        row_rule == RowRule::rings ? static_cast<double>(ring_of_point[i]) : std::round(fine_row);
    if (!(row >= 0 && row < lattice.rows())) {
      ++counts.out_of_fov;
      continue;
    }
    const double fine_column = lattice.column_of(azimuth_of(p));
    const double column = std::round(fine_column);
    const double across = (fine_column - column) * column_angle * std::cos(elevation);
    const double along = elevation - lattice.elevation(row);
    const double offset2 = across * across + along * along;
    const std::size_t cell = image.index(static_cast<std::size_t>(row),
                                         static_cast<std::size_t>(column) % lattice.columns());
    Claim& best = claims[cell];
    if (image.occupied(cell)) ++counts.collided;
    if (offset2 < best.offset2 || (offset2 == best.offset2 && range < best.range)) {
      best = {offset2, range};
      image.range[cell] = range;
      image.source[cell] = static_cast<std::uint32_t>(i);
    }
  }
  counts.kept =
      counts.returns - counts.outliers - counts.out_of_range - counts.out_of_fov - counts.collided;
  return image;
}

Result<Cloud> project(const Cloud& cloud, const Detection& detection,
                      const ProjectSettings& settings, ProjectionCounts* counts) {
  CURLIDAR_TRY(check(settings));
  CURLIDAR_TRY(validate(detection.sensor));
  if (cloud.size() == 0) return Error{ErrorCode::invalid_argument, "the cloud has no points"};
  if (detection.ring_of_point.size() != cloud.size()) {
    return Error{ErrorCode::invalid_argument,
                 "the detection belongs to another cloud: it has a different number of points"};
  }
  ProjectionCounts local;
  const double max_range = resolve_max_range(settings.max_range, cloud, detection.sensor);
  const Lattice lattice =
      settings.row_rule == RowRule::rings
          ? Lattice::from_rings(detection.ring_elevations, settings.columns)
          : make_lattice(settings, detection.sensor);
  const RangeImage image =
      fill_range_image(cloud, detection.ring_of_point, lattice,
                       settings.row_rule, settings.min_range_m, max_range, {}, local);
  std::vector<std::uint32_t> sources(image.source);
  std::replace(sources.begin(), sources.end(), kNoPoint, 0u);
  Cloud out = select(cloud, sources);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t row = 0; row < image.lattice.rows(); ++row) {
    for (std::size_t column = 0; column < image.lattice.columns(); ++column) {
      const std::size_t cell = image.index(row, column);
      out.positions[cell] =
          image.occupied(cell) ? image.point(row, column) : Vec3{kNan, kNan, kNan};
    }
  }
  for (Attribute& attribute : out.attributes) {
    const std::size_t components = attribute.components;
    std::visit(
        [&](auto& values) {
          for (std::size_t cell = 0; cell < image.source.size(); ++cell) {
            if (image.occupied(cell)) continue;
            for (std::size_t k = 0; k < components; ++k) values[cell * components + k] = 0;
          }
        },
        attribute.values);
  }
  out.width = image.lattice.columns();
  out.height = image.lattice.rows();
  if (counts != nullptr) *counts = local;
  return out;
}

}  // namespace curlidar
