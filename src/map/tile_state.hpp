// SPDX-License-Identifier: BSD-3-Clause
// What is known of a tile while it is coded: which cube lies on which plane, and where surface was
// seen. Encoder and decoder build the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/fine_cubes.hpp"
#include "map/tile_geometry.hpp"

namespace curlidar::tile {

/// Parents that a leaf may inherit from.
inline constexpr std::uint32_t kCandidates = 3;

/// What of a leaf is in the bits.
struct TileLeafCode {
  std::uint32_t candidate = 0;  ///< 0: a plane of its own; k: the k-th candidate's
  std::uint32_t axis = 2;       ///< of a plane of its own
  std::uint32_t terms = 0;      ///< 0: nothing, 1: the height, 3: the slopes, too, are corrected
  bool curved = false;
  std::array<std::int32_t, 3> q{};      ///< in steps
  std::array<std::int32_t, 3> curve{};  ///< in steps
  std::int32_t intensity = 0;           ///< in steps
  std::vector<std::uint8_t> footprint;
};

/// A leaf where it lies.
struct PlacedLeaf {
  TileCube cube;
  std::uint32_t plane = 0;
  std::array<std::int32_t, 3> curve{};  ///< Q16 a metre
  std::int32_t intensity = 0;           ///< in steps
  std::size_t first_cell = 0;
};

/// What tells about a cube before it is coded.
struct CubeContext {
  TileCube cube;
  Ticks3 centre{};
  std::int32_t half = 0;  ///< of its edge
  std::uint32_t count = 0;
  std::array<std::uint32_t, kCandidates> plane{};  ///< candidates
  std::array<std::uint32_t, kCandidates>
      crossing{};             ///< 0 misses the cube, 1 partly, 2 all over it
  std::uint32_t contact = 0;  ///< class of how much of the first candidate touches the cube, 0..3
  std::uint32_t finer = 0;    ///< share of what touches in smaller cubes: 0 none, 1 some, 2 most
  std::uint32_t around = 0;   ///< bits: cubes of this size beside hold anything
  std::int32_t intensity = 0;

  /// The three crossings as one number below 27; `count` is in it, as what is not there misses.
  std::uint32_t crossings() const { return crossing[0] * 9 + crossing[1] * 3 + crossing[2]; }
};

class TileState {
 public:
  explicit TileState(const TileLayout& layout) : layout_(layout), now_(layout), before_(layout) {}

  /// Begins another walk over all roots. What was coded before stays, and is known from the start.
  void begin_pass();

  const TileLayout& layout() const { return layout_; }
  const std::vector<PlacedLeaf>& leaves() const { return leaves_; }
  const std::vector<TilePlane>& planes() const { return planes_; }
  const std::vector<std::uint8_t>& cells() const { return cells_; }

  CubeContext context(const TileCube& cube) const;
  /// The plane that a leaf stands for.
  TilePlane plane_of(const CubeContext& c, const TileLeafCode& leaf) const;
  /// Its curvature, Q16 a metre.
  std::array<std::int32_t, 3> curve_of(const CubeContext& c, const TileLeafCode& leaf) const;
  /// Which cells of a leaf on such a plane come near its cube, cells x cells; in later passes
  /// without those where an earlier leaf of the same axis has surface.
  std::vector<std::uint8_t> open_cells(const CubeContext& c, const TilePlane& plane) const;

  /// States of the cells around a leaf, (cells + 2)^2 with the leaf's own in the middle as 0:
  /// 0 nothing there, 1 surface, 2 not known yet, 3 another axis' surface. In later passes cells in
  /// the middle are 1 where an earlier leaf has surface.
  std::vector<std::uint8_t> surroundings(const CubeContext& c, const TilePlane& plane) const;

  /// Takes a leaf as coded.
  void place(const CubeContext& c, const TileLeafCode& leaf);
  /// Takes a cube as coded and empty, or anything below it as not coded.
  void set_empty(const TileCube& cube) { now_.fill(cube, kEmpty); }

  /// Where an encoder can come back to.
  struct Mark {
    std::size_t leaves = 0, planes = 0, cells = 0;
  };
  Mark mark() const { return {leaves_.size(), planes_.size(), cells_.size()}; }
  /// Undoes what was placed in a cube since.
  void forget(const TileCube& cube, const Mark& mark);

  /// Memory for finest cubes taken so far, in cubes.
  std::size_t fine_cubes() const { return now_.size() + before_.size(); }

 private:
  /// What this pass knows, or else those before it.
  std::int32_t fine_at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::int32_t now = now_.at(x, y, z);
    if (now >= 0 || !later_) return now;
    const std::int32_t before = before_.at(x, y, z);
    return before >= 0 ? before : now;
  }
  std::uint32_t crossing_of(const CubeContext& c, const TilePlane& plane) const;
  bool any_in(const TileCube& cube, int dx, int dy, int dz) const;
  /// Whether neither a root nor those around it hold anything: what is known at once.
  bool alone(const TileCube& root) const;
  void gather_planes(CubeContext& c, bool touching_any) const;
  std::uint8_t cell_at(std::uint32_t axis, const Ticks3& p) const;
  /// The middle of a cell of a leaf on a plane, limited to the cube along its axis; i and j from
  /// -1.
  Ticks3 cell_middle(const CubeContext& c, const TilePlane& plane, std::int32_t i,
                     std::int32_t j) const;

  TileLayout layout_;
  bool later_ = false;      ///< than the first pass
  FineCubes now_, before_;  ///< of this pass, of all before it
  std::vector<PlacedLeaf> leaves_;
  std::vector<TilePlane> planes_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace curlidar::tile
