// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_decoder.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/try.hpp"
#include "entropy/range_coder.hpp"
#include "map/tile_header.hpp"

namespace curlidar::tile {
namespace {

double metres(std::int32_t ticks) {
  return static_cast<double>(ticks) / kTicks;
}

MapLeaf map_leaf(const TileState& state, const PlacedLeaf& placed) {
  const TileLayout& layout = state.layout();
  const Ticks3 centre = centre_of(layout, placed.cube);
  const TilePlane& plane = state.planes()[placed.plane];
  MapLeaf leaf;
  leaf.centre = {metres(centre[0]), metres(centre[1]), metres(centre[2])};
  leaf.size_m = metres(layout.edge(placed.cube.level));
  leaf.axis = static_cast<std::uint8_t>(plane.axis);
  leaf.level = static_cast<std::uint8_t>(placed.cube.level);
  leaf.height_m = metres(plane.at(centre[u_axis(plane.axis)], centre[v_axis(plane.axis)]));
  for (std::size_t k = 0; k < 2; ++k) leaf.slope[k] = plane.slope[k] / 65536.0;
  for (std::size_t k = 0; k < 3; ++k) leaf.curve[k] = placed.curve[k] / 65536.0;
  leaf.cells = layout.cells(placed.cube.level);
  leaf.first_cell = placed.first_cell;
  if (layout.intensity) {
    leaf.intensity = static_cast<float>(placed.intensity) * layout.intensity_step;
  }
  return leaf;
}

MapTile map_tile(const TileState& state) {
  MapTile tile;
  tile.side_m = metres(state.layout().edge(0)) * state.layout().side_roots;
  tile.leaves.reserve(state.leaves().size());
  for (const PlacedLeaf& placed : state.leaves()) tile.leaves.push_back(map_leaf(state, placed));
  tile.footprint = state.cells();
  return tile;
}

}  // namespace

Result<DecodedTile> decode_tile(ByteSpan bytes, const TileLimits& limits, bool keep_trees) {
  ByteReader in(bytes);
  CURLIDAR_TRY_ASSIGN(layout, read_header(in));
  DecodedTile out;
  out.layout = layout;
  TileState state(layout);
  TileModels models;
  RangeDecoder decoder(in.take(in.remaining()));
  TileSink<RangeDecoder> sink(decoder, models);
  bool full = false, whole = true, more = true;
  const auto go_on = [&] {
    full = state.leaves().size() >= limits.max_leaves ||
           std::max(state.cells().size(), state.fine_cubes()) > limits.max_cells;
    return !full && !decoder.exhausted();
  };
  while (more && whole) {
    out.first_leaf.push_back(state.leaves().size());
    TilePass pass;
    whole = for_each_root(layout, [&](const TileCube& cube) {
      if (keep_trees) pass.emplace_back();
      return !decoder.exhausted() && code_root(sink, state, state.context(cube), nullptr, -1, go_on,
                                               keep_trees ? &pass.back() : nullptr);
    });
    if (keep_trees) out.passes.push_back(std::move(pass));
    more = whole && sink.plain(false);
    if (more && out.first_leaf.size() == kMostPasses) whole = false;
    if (!more || !whole) break;
    state.begin_pass();
    models.begin_pass();
  }
  if (full) {
    return Error{
        ErrorCode::limit_exceeded,
        fmt::format("a tile has more than {} leaves or {} cells: raise the limits if it can "
                    "be trusted",
                    limits.max_leaves, limits.max_cells)};
  }
  if (!whole || decoder.exhausted() || !decoder.finished()) {
    return Error{ErrorCode::corrupt, "the bits of a tile do not end where its surface does"};
  }
  out.tile = map_tile(state);
  return out;
}

}  // namespace curlidar::tile
