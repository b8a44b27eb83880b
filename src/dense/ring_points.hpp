// SPDX-License-Identifier: BSD-3-Clause
// The returns of a scan on their rings, as the sensor itself saw them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "curlidar/field.hpp"

namespace curlidar {

/// A return in cylinder coordinates around the spin axis.
struct RingPoint {
  double azimuth = 0;      ///< in [-pi, pi]
  double rho = 0;          ///< from the axis, metres, above 0
  double z = 0;            ///< metres
  std::uint32_t cell = 0;  ///< row * columns + column, or the number of the raw return
};

/// From one azimuth to another the short way, radians in [-pi, pi]; both lie in [-pi, pi].
double turn_between(double from, double to);

/// The sample of a ring nearest to an azimuth on one side.
struct RingSample {
  const RingPoint* point = nullptr;  ///< none: the ring is empty
  double away = 0;                   ///< from the azimuth, in columns, >= 0
};

/// Rings are numbered from the top; those of a field are its rows by elevation.
class RingPoints {
 public:
  /// The returns of a field, its patches made to meet (patch_joints).
  explicit RingPoints(const Field& field);
  /// Raw samples: `ring_of_point[i]` is the ring of positions[i], below elevations.size(); others
  /// and slots without a return are left out. `elevations` in radians, descending; `columns` are
  /// those of a turn.
  RingPoints(std::span<const Vec3> positions, std::span<const std::uint16_t> ring_of_point,
             std::vector<double> elevations, std::uint32_t columns);

  std::size_t rings() const { return begin_.size() - 1; }
  std::uint32_t columns() const { return columns_; }
  bool empty() const { return points_.empty(); }
  /// The usual step from sample to sample, radians.
  double column_step() const { return column_step_; }
  /// Nominal ones of the rings.
  const std::vector<double>& elevations() const { return elevations_; }
  double height_m(std::size_t ring) const { return heights_[ring]; }
  /// The field's row of a ring.
  std::uint32_t row(std::size_t ring) const { return rows_[ring]; }

  /// The samples of a ring by azimuth.
  std::span<const RingPoint> ring(std::size_t ring) const {
    return std::span(points_).subspan(begin_[ring], begin_[ring + 1] - begin_[ring]);
  }
  /// The samples at or before an azimuth of [-pi, pi], and behind it, around the seam. O(1) for
  /// samples spread as columns are.
  std::pair<RingSample, RingSample> around(std::size_t ring, double azimuth) const;
  /// The first sample of ring(ring) beyond an azimuth; their number where none is. O(1) as above.
  std::size_t first_beyond(std::size_t ring, double azimuth) const;
  /// The sample `steps` samples on from sample `at` of a ring that is not empty, around the seam.
  const RingPoint& walk(std::size_t ring, std::size_t at, std::ptrdiff_t steps) const;

  /// Whether any ring has a return within `reach` columns of an azimuth: else no laser fired there.
  bool fired(double azimuth) const;

 private:
  void take(std::vector<std::vector<RingPoint>> rings);
  std::size_t bin(double azimuth) const;

  std::vector<double> elevations_, heights_;
  std::vector<std::uint32_t> rows_;
  std::uint32_t columns_ = 0;
  double column_step_ = 0;
  std::vector<RingPoint> points_;   ///< ring by ring, by azimuth
  std::vector<std::size_t> begin_;  ///< of each ring in points_
  std::vector<std::uint32_t>
      start_;                        ///< of each ring and bin of azimuth: its first sample or later
  std::vector<std::uint8_t> fired_;  ///< of each bin of azimuth
};

}  // namespace curlidar
