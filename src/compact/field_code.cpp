// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_code.hpp"

namespace curlidar::compact {

std::vector<Block> roots_of(const Geometry& geometry, const FieldSettings& settings) {
  const std::uint32_t side = 1u << settings.root_log2;
  std::vector<Block> roots;
  for (std::uint32_t row = 0; row < geometry.rows(); row += side) {
    for (std::uint32_t column = 0; column < geometry.columns(); column += side) {
      roots.push_back({row, column, std::min(side, geometry.rows() - row),
                       std::min(side, geometry.columns() - column)});
    }
  }
  return roots;
}

LeafSurfaces surfaces_of(FieldState& state, const BlockContext& context, const LeafCode& leaf,
                         const std::vector<std::uint32_t>& cells) {
  const PatchFrame frame(state.geometry, state.shape(context.block), context.block);
  LeafSurfaces out;
  for (std::uint32_t k = 0; k < leaf.layers; ++k) {
    out.layers.push_back({surface_of(state, context, frame, leaf.layer[k]), frame, context.block,
                          leaf.layer[k].functions});
  }
  out.ranges.resize(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (std::uint32_t k = 0; k < leaf.layers; ++k) {
      out.ranges[i][k] =
          static_cast<std::int32_t>(state.range_in(out.layers[k].surface, frame, cells[i]));
    }
  }
  return out;
}

void place_leaf(FieldState& state, LeafSurfaces&& surfaces, const std::vector<std::uint32_t>& cells,
                const std::vector<std::uint8_t>& labels) {
  const auto first = static_cast<std::int32_t>(state.surfaces.size());
  const auto depth = static_cast<std::uint8_t>(surfaces.layers.size() - 1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t label = labels.empty() ? 0 : labels[i];
    state.range[cells[i]] = surfaces.ranges[i][label];
    state.surface[cells[i]] = first + static_cast<std::int32_t>(label);
    state.depth_class[cells[i]] = depth;
  }
  for (PlacedSurface& surface : surfaces.layers) state.surfaces.push_back(std::move(surface));
}

}  // namespace curlidar::compact
