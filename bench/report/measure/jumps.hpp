// SPDX-License-Identifier: BSD-3-Clause
// Jumps of a range function between neighbouring cells of its lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "curlidar/field.hpp"

namespace curlidar::bench {

/// Two cells, row * columns + column, beside each other in a row or a column of the lattice. Both
/// hold a return and look almost the same way.
struct CellPair {
  std::size_t from = 0, to = 0;
  bool border = false;  ///< they belong to different blocks
};

inline constexpr std::size_t kStops = 17;  ///< from one cell to the other
/// Lines of sight from that of one cell to that of the other.
using Way = std::array<Sightline, kStops>;
/// Ranges along them, metres; NaN where no surface is believed.
using WayRanges = std::array<double, kStops>;

/// The cells of a field where they look: those of rays do not lie on the columns of their lattice.
class Cells {
 public:
  explicit Cells(std::shared_ptr<const Field> field);

  /// Pairs, `most` of each kind (on a border, within a block) at most, evenly taken. `block` tells
  /// the block of each cell.
  std::vector<CellPair> pairs(std::span<const std::uint32_t> block, std::size_t most) const;
  /// Lines of the cloud's frame. They start on the spin axis where the beams of the cells do, turn
  /// evenly from the return of one cell to that of the other, and move as the scan does.
  Way way(const CellPair& pair) const;
  /// The cells of the pair's rows between whose returns its way passes: those on it, and from row
  /// to row the next ones beside it.
  std::vector<std::size_t> around(const CellPair& pair) const;
  /// The return of a cell in the cloud's frame, without what its ring measures too far.
  Vec3 coded(std::size_t cell) const;

 private:
  /// How the return of a cell is seen in the sensor's own frame.
  struct View {
    double azimuth = 0, elevation = 0, height_m = 0;
  };
  View view(std::size_t cell) const;
  bool look_alike(std::size_t a, std::size_t b) const;
  double row_step(std::size_t cell) const;

  std::shared_ptr<const Field> field_;
  std::vector<Vec3> points_;
};

WayRanges ranges_along(const Field& field, const Way& way);

/// The jump on a way, metres: what its largest step is more than the other steps. Inverse ranges,
/// so that planes have none however they are seen. NaN if a range on the way is.
double jump_of(const WayRanges& ranges_m);

}  // namespace curlidar::bench
