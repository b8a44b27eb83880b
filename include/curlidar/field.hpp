// SPDX-License-Identifier: BSD-3-Clause
// "Range in direction d": the continuous representation, whatever is beneath it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "curlidar/lattice.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar {

/// A line of sight in the frame of the coded cloud.
struct Sightline {
  Vec3 origin{};     ///< near the sensor: metres away from it are too far
  Vec3 direction{};  ///< of any length above 0
};

/// What there is along a line of sight.
enum class Seen : std::uint8_t {
  unknown,  ///< outside of what was scanned, or too far from any sample to say
  nothing,  ///< no return: sky, or a gap that was seen to be one
  surface,  ///< a surface that is to be believed
};

/// What a field says along one line of sight.
struct RangeEstimate {
  /// From the line's origin, metres. Also where no surface is believed, if there is anything to
  /// guess from; else NaN.
  double range_m = std::numeric_limits<double>::quiet_NaN();
  /// Probability that a surface is there and |error of range_m| <= 5 cm; 0 .. 1. NaN: not told, as
  /// by all fields but those of dense_field() (curlidar/dense.hpp).
  float confidence = std::numeric_limits<float>::quiet_NaN();
  Seen seen = Seen::unknown;

  bool valid() const { return seen == Seen::surface; }
};

/// The coded returns that an estimate stands on; weights are >= 0 and add up to 1, or are all 0.
struct Sources {
  std::array<std::size_t, 4> cell{};  ///< row * columns + column
  std::array<double, 4> weight{};
};

/// The lines of sight of a row in the sensor's own frame: they meet its spin axis, the z axis, at
/// a height.
struct RowLine {
  double elevation = 0;      ///< radians
  double height_m = 0;       ///< above the origin
  bool from_origin = false;  ///< ranges of the row are distances from the origin, not from there

  /// The range of a point of the own frame.
  double range_of(double axis_distance_m, double z_m) const {
    return std::hypot(axis_distance_m, from_origin ? z_m : z_m - height_m);
  }
};

/// A continuous range function on the viewing sphere with the lattice its returns were coded on.
/// Immutable; all members may be called from many threads.
class Field {
 public:
  virtual ~Field() = default;

  virtual const Lattice& lattice() const = 0;

  /// Ranges along one line of constant (fractional) lattice row, metres. Element i looks at
  /// fractional column `columns[i]` (any real number; wraps; NaN and infinite ones have NaN
  /// ranges). ranges[i] is NaN where nothing is represented, or, with `masked`, where no surface is
  /// to be believed. It is what range_along says along the same line (see row_line), of surfaces as
  /// the sensor would have seen them without the offsets of its rings (see ring_offset_m): coded
  /// ranges as they are come from decode, not from here. Columns of a lattice of rays are not its
  /// cells: these look where cell_points lie. columns and ranges have the same size.
  virtual void evaluate_row(double row, std::span<const double> columns, bool masked,
                            std::span<double> ranges) const = 0;

  /// The points of such a line in the frame of the coded cloud: element i lies ranges[i] along
  /// columns[i], and is NaN where the range is. All three have the same size.
  virtual void place_row(double row, std::span<const double> columns,
                         std::span<const double> ranges, std::span<Vec3> points) const;

  /// Whether the cell holds a coded return.
  virtual bool occupied(std::uint32_t row, std::uint32_t column) const = 0;

  /// Ranges along any lines of sight, in any order; estimates[i] is of lines[i], both have the same
  /// size. Where lines start elsewhere than the coded beams the surface is looked for along them.
  /// Threads never change the result; 0 = all cores. O(lines).
  virtual void range_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                           std::size_t threads = 1) const;
  /// The same without confidence, which is told or not: quicker where nobody asks for it.
  virtual void surfaces_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                              std::size_t threads = 1) const {
    range_along(lines, estimates, threads);
  }
  /// As range_along from the origin of the cloud's frame; directions of any length above 0.
  void range_at(std::span<const Vec3> directions, std::span<RangeEstimate> estimates,
                std::size_t threads = 1) const;

  /// The coded returns on the surface that is seen at a point of the cloud's frame: what attributes
  /// there are interpolated from.
  virtual Sources sources_at(const Vec3& point) const;

  /// The cell, row * columns + column, whose return is nearest to a direction; a cell without one
  /// if the direction is nobody's.
  virtual std::size_t nearest_cell(double row, double column) const;

  /// The coded returns where the sensor itself saw them: motion of the scan undone, what its rings
  /// measure too far or too near taken away. One for each cell, row-major; NaN in empty ones.
  virtual std::vector<Vec3> cell_points() const;
  /// The patch that each cell's range was coded with, row-major; empty where there are none. Ranges
  /// of one patch err together.
  virtual std::vector<std::int32_t> cell_patches() const { return {}; }
  /// What the coded ranges of a row have added to those of cell_points, metres: what the ring
  /// measures too far. It is in no surface that the field tells.
  virtual double ring_offset_m(std::uint32_t row) const;
  /// What coded ranges are rounded to, metres; 0: nothing is known of that.
  virtual double step_m() const { return 0; }
  /// How a fractional row looks in that frame.
  virtual RowLine row_line(double row) const;
  /// Whether motion_at() is anything but no motion.
  virtual bool moves() const { return false; }
  /// From the sensor's own frame to the cloud's, for points at an azimuth of the own frame.
  virtual RigidMotion motion_at(double azimuth) const;
};

}  // namespace curlidar
