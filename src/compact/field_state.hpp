// SPDX-License-Identifier: BSD-3-Clause
// What is known of a segment's field while it is coded: the part that contexts and parents look at.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "compact/geometry.hpp"
#include "compact/prediction_guide.hpp"
#include "compact/surface.hpp"

namespace curlidar::compact {

/// Settings of the field that decoder and encoder share.
struct FieldSettings {
  std::int32_t step = 0;            ///< D, Q16 metres
  std::uint32_t root_log2 = 4;      ///< roots of 2^root_log2 cells a side
  std::uint32_t smallest_leaf = 8;  ///< cells of the smallest block that a split may make
};

inline constexpr std::uint32_t kMaxLayers = 4;
inline constexpr std::int32_t kNoSurface = -1;

/// A surface with the patch that it was coded in.
struct PlacedSurface {
  Surface surface;
  PatchFrame frame;
  Block block;
  std::uint32_t functions = 0;  ///< place in kFunctions
};

/// What a layer may inherit from besides surfaces of the scan itself, in place of their numbers.
inline constexpr std::int32_t kWarpedField = -2;  ///< of every cell the plane that its guide has
inline constexpr std::int32_t kWarpedPlane = -3;  ///< the plane of the guide at the block's middle

/// Surfaces that a layer may inherit its plane from, without repetition.
struct Parents {
  static constexpr std::uint32_t kMost = 7;
  std::array<std::int32_t, kMost> surface{};
  std::uint32_t count = 0;
  std::int64_t range = 0;  ///< what the neighbours make expect, for a layer without a parent
};

class FieldState {
 public:
  /// `guide`, if any, outlives this.
  FieldState(const Geometry& geometry, const std::vector<std::uint8_t>& occupied,
             const FieldSettings& settings, const Guide* guide = nullptr);

  const Geometry& geometry;
  const std::vector<std::uint8_t>& occupied;
  const FieldSettings settings;
  const Guide* const guide;
  std::vector<std::int32_t> range;        ///< of each cell as the field gives it
  std::vector<std::int32_t> surface;      ///< of each cell, kNoSurface where not coded or empty
  std::vector<std::uint8_t> depth_class;  ///< of the leaf of each cell: layers - 1
  std::vector<PlacedSurface> surfaces;

  std::size_t cell(std::uint32_t row, std::uint32_t column) const {
    return static_cast<std::size_t>(row) * geometry.columns() + column;
  }
  /// The surface at a cell that may lie outside the segment.
  std::int32_t surface_at(std::int64_t row, std::int64_t column) const {
    if (row < 0 || column < 0 || row >= geometry.rows() || column >= geometry.columns()) {
      return kNoSurface;
    }
    return surface[static_cast<std::size_t>(row) * geometry.columns() +
                   static_cast<std::size_t>(column)];
  }

  /// Range of a surface in a cell of its block.
  std::int64_t range_in(const Surface& of, const PatchFrame& frame, std::size_t at) const {
    const Sight sight = geometry.sight(at);
    if (!of.warped || guide->source[at] < 0) return of.range_at(frame, sight);
    return on_plane_of(of, guide->plane(guide->source[at])).range_at(frame, sight);
  }

  const PatchShape& shape(const Block& block);
  Parents parents(const Block& block) const;
  /// Cells of the block that hold a return, in raster order.
  std::vector<std::uint32_t> cells_of(const Block& block) const;
  /// Forgets everything coded.
  void clear();
  /// Forgets what was coded of a block, and all surfaces but the first `kept`.
  void forget(const Block& block, std::size_t kept);

 private:
  std::map<std::array<std::uint32_t, 3>, PatchShape> shapes_;
};

}  // namespace curlidar::compact
