// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_syntax.hpp"

namespace curlidar::compact {
namespace {

std::uint32_t size_class(std::uint32_t cells) {
  return cells <= 4 ? 0 : cells <= 8 ? 1 : cells <= 16 ? 2 : cells <= 64 ? 3 : cells <= 256 ? 4 : 5;
}

std::uint32_t shape_class(const Block& block) {
  const std::uint32_t side = std::min(block.height, block.width);
  const std::uint32_t aspect = block.width > block.height ? 1 : block.width < block.height ? 2 : 0;
  return (side >= 32 ? 0 : side >= 16 ? 1 : side >= 8 ? 2 : 3) * 3 + aspect;
}

/// Class of |a - b| in steps: below 1/4, 1, 4, 16, more.
std::uint32_t distance_class(std::int64_t a, std::int64_t b, std::int32_t step) {
  const std::int64_t distance = 4 * (a > b ? a - b : b - a);
  std::uint32_t out = 0;
  for (std::int64_t bound = step; out < 4 && distance >= bound; bound *= 4) ++out;
  return out;
}

/// Distances of the guide from the decoded ranges of a cell, if both are known.
void add_miss(const FieldState& state, std::int64_t row, std::int64_t column, std::int64_t& sum,
              std::int64_t& known) {
  if (state.surface_at(row, column) == kNoSurface) return;
  const auto cell = state.cell(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column));
  if (state.guide->source[cell] < 0) return;
  sum += std::abs(std::int64_t{state.range[cell]} - state.guide->range[cell]);
  ++known;
}

/// How true the guide was beside the block: 0 not known, else 1 + the class of its distance.
std::uint32_t trust_of(const FieldState& state, const Block& b) {
  std::int64_t sum = 0, known = 0;
  for (const std::uint32_t part : {1u, 3u}) {
    add_miss(state, b.row + part * b.height / 4, std::int64_t{b.column} - 1, sum, known);
    add_miss(state, std::int64_t{b.row} - 1, b.column + part * b.width / 4, sum, known);
  }
  if (known == 0) return 0;
  return 1 + std::min(distance_class(sum / known, 0, state.settings.step), 3u);
}

/// The cell whose plane stands for a block: its middle, else its first return with a plane.
std::int64_t guiding_cell(const FieldState& state, const Block& b, std::size_t middle) {
  if (state.guide->source[middle] >= 0) return static_cast<std::int64_t>(middle);
  for (std::uint32_t i = 0; i < b.height; ++i) {
    const std::size_t begin = state.cell(b.row + i, b.column);
    for (std::size_t cell = begin; cell < begin + b.width; ++cell) {
      if (state.occupied[cell] && state.guide->source[cell] >= 0) {
        return static_cast<std::int64_t>(cell);
      }
    }
  }
  return -1;
}

/// What the guide knows of a block: how many of its returns, and how flat that is.
std::uint32_t warp_of(const FieldState& state, const Block& b, std::uint32_t returns,
                      const Plane& plane, std::uint32_t trust) {
  std::int64_t sum = 0, known = 0;
  std::uint32_t sure = 0;
  for (std::uint32_t i = 0; i < b.height; ++i) {
    const std::size_t begin = state.cell(b.row + i, b.column);
    for (std::size_t cell = begin; cell < begin + b.width; ++cell) {
      if (!state.occupied[cell] || state.guide->source[cell] < 0) continue;
      const Sight sight = state.geometry.sight(cell);
      const std::int64_t flat =
          range_of(plane.at(sight.direction), (std::int64_t{1} << 30) - plane.beside(sight.origin));
      sum += std::abs(flat - state.guide->range[cell]);
      sure += state.guide->level[cell] < 2;
      ++known;
    }
  }
  const std::uint32_t flat =
      known == 0 ? 2 : std::min(distance_class(sum / known, 0, state.settings.step), 2u);
  return 1 + ((4 * sure >= 3 * returns ? 1 : 0) * 3 + flat) * kTrustClasses + trust;
}

/// Puts the guide's parents before the others.
void add_guide(const FieldState& state, std::size_t middle, std::uint32_t returns,
               BlockContext& c) {
  c.guided = true;
  c.trust = trust_of(state, c.block);
  const std::int64_t cell = guiding_cell(state, c.block, middle);
  if (cell < 0) return;
  const Plane& plane = state.guide->plane(state.guide->source[static_cast<std::size_t>(cell)]);
  c.warp = warp_of(state, c.block, returns, plane, c.trust);
  Parents& parents = c.parents;
  const auto make_room = [&](auto& list) {
    std::copy_backward(list.begin(), list.begin() + parents.count,
                       list.begin() + parents.count + 2);
  };
  make_room(parents.surface);
  make_room(c.parent_functions);
  make_room(c.parent_plane);
  parents.surface[0] = kWarpedField;
  parents.surface[1] = kWarpedPlane;
  c.parent_functions[0] = c.parent_functions[1] = 0;
  c.parent_plane[0] = c.parent_plane[1] = plane;
  parents.count += 2;
}

}  // namespace

BlockContext block_context(FieldState& state, const Block& block, std::uint32_t returns) {
  BlockContext c;
  c.block = block;
  c.parents = state.parents(block);
  c.size = size_class(block.cells());
  c.shape = shape_class(block);
  c.filled = returns * 4 >= block.cells() * 3 ? 2 : returns * 4 >= block.cells() ? 1 : 0;
  c.few = returns <= 2 ? 0 : returns <= 6 ? 1 : returns <= 16 ? 2 : 3;

  const auto neighbour = [&](std::int64_t row, std::int64_t column, std::uint32_t& size,
                             std::uint32_t& depth) {
    const std::int32_t surface = state.surface_at(row, column);
    if (surface == kNoSurface) return;
    const std::uint32_t cells = state.surfaces[static_cast<std::size_t>(surface)].block.cells();
    size = cells < block.cells() ? 1 : cells == block.cells() ? 2 : 3;
    const auto at = state.cell(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column));
    depth = std::min<std::uint32_t>(state.depth_class[at], 2) + 1;
  };
  neighbour(block.row + block.height / 2, std::int64_t{block.column} - 1, c.left_size,
            c.left_depth);
  neighbour(std::int64_t{block.row} - 1, block.column + block.width / 2, c.above_size,
            c.above_depth);

  const std::size_t middle =
      state.cell(block.row + block.height / 2, block.column + block.width / 2);
  c.middle = state.geometry.directions()[middle];
  for (std::uint32_t k = 0; k < c.parents.count; ++k) {
    const PlacedSurface& parent = state.surfaces[static_cast<std::size_t>(c.parents.surface[k])];
    c.parent_functions[k] = parent.functions;
    c.parent_plane[k] = parent.surface.plane;
  }
  std::int64_t low = 0, high = 0;
  for (std::uint32_t k = 0; k < c.parents.count; ++k) {
    const std::int64_t range = range_of(c.parent_plane[k].at(c.middle));
    low = k == 0 ? range : std::min(low, range);
    high = k == 0 ? range : std::max(high, range);
  }
  c.spread = c.parents.count < 2 ? 0 : distance_class(low, high, state.settings.step);
  if (state.guide != nullptr) add_guide(state, middle, returns, c);
  return c;
}

std::int64_t range_step(const FieldState& state, const PatchFrame& frame) {
  return std::max<std::int64_t>(mul_shift(state.settings.step, frame.shape.norm, 30), 1);
}

LayerBase base_of(const FieldState& state, const BlockContext& c, const PatchFrame& frame,
                  const LayerCode& layer) {
  LayerBase base;
  std::int64_t range = 0;
  if (layer.parent == 0) {
    range = std::clamp(c.parents.range + layer.range_steps * range_step(state, frame), kMinRange,
                       kMaxRange);
    base.plane = facing_plane(frame, range);
  } else {
    base.plane = c.parent_plane[layer.parent - 1];
    range = range_of(base.plane.at(c.middle));
  }
  base.step_q40 = coefficient_step((std::int64_t{1} << 46) / range, state.settings.step);
  return base;
}

Surface surface_of(const FieldState& state, const BlockContext& c, const PatchFrame& frame,
                   const LayerCode& layer) {
  const LayerBase base = base_of(state, c, frame, layer);
  const std::uint32_t functions = kFunctions[layer.functions];
  if (c.kind_of(layer.parent) != 2) {
    return add_functions(base.plane, frame, base.step_q40, layer.q, functions);
  }
  Surface warped = add_functions({}, frame, base.step_q40, layer.q, functions);
  warped.warped = true;
  warped.added = warped.plane;
  warped.plane = on_plane_of(warped, base.plane).plane;
  return warped;
}

LabelContexts::LabelContexts(const FieldState& state, const Block& block, std::uint32_t layers)
    : state_(state), block_(block), layers_(layers) {
  labels_.fill(kMaxLayers);
}

void LabelContexts::set(std::uint32_t cell, std::uint32_t label) {
  const std::uint32_t row = cell / state_.geometry.columns() - block_.row;
  const std::uint32_t column = cell % state_.geometry.columns() - block_.column;
  labels_[row * 32 + column] = static_cast<std::uint8_t>(label);
}

std::uint32_t LabelContexts::layer_at(std::int64_t row, std::int64_t column,
                                      const LayerRanges& ranges) const {
  const std::int64_t i = row - block_.row, j = column - block_.column;
  if (i >= 0 && j >= 0 && i < block_.height && j < block_.width) {
    return labels_[static_cast<std::size_t>(i * 32 + j)];
  }
  if (state_.surface_at(row, column) == kNoSurface) return kMaxLayers;
  const std::int32_t range =
      state_.range[static_cast<std::size_t>(row * state_.geometry.columns() + column)];
  std::uint32_t best = 0;
  for (std::uint32_t k = 1; k < layers_; ++k) {
    if (std::abs(range - ranges[k]) < std::abs(range - ranges[best])) best = k;
  }
  return best;
}

LabelContext LabelContexts::at(std::uint32_t cell, const LayerRanges& ranges) const {
  const std::int64_t row = cell / state_.geometry.columns();
  const std::int64_t column = cell % state_.geometry.columns();
  const std::uint32_t w = layer_at(row, column - 1, ranges), n = layer_at(row - 1, column, ranges),
                      nw = layer_at(row - 1, column - 1, ranges),
                      ne = layer_at(row - 1, column + 1, ranges);
  LabelContext c;
  for (const std::uint32_t known : {w, n, nw, ne}) {
    if (known == kMaxLayers) continue;
    c.first = known;
    break;
  }
  for (const std::uint32_t known : {n, ne, nw}) {
    if (known == kMaxLayers || known == c.first) continue;
    c.second = static_cast<std::int32_t>(known);
    break;
  }
  const auto on = [](std::uint32_t layer, std::uint32_t wanted) {
    return layer == kMaxLayers ? 2u : layer == wanted ? 1u : 0u;
  };
  c.pattern = (on(nw, c.first) * 3 + on(ne, c.first)) * 3 + on(n, c.first);
  if (c.second >= 0) {
    const auto second = static_cast<std::uint32_t>(c.second);
    c.second_pattern = (on(nw, second) * 3 + on(ne, second)) * 3 + on(n, second);
  }
  const std::uint32_t ww = layer_at(row, column - 2, ranges),
                      nn = layer_at(row - 2, column, ranges);
  c.wide_pattern = (on(ww, c.first) * 3 + on(nn, c.first)) * 3 + on(w, c.first);
  while (c.run < 3 &&
         layer_at(row, column - 1 - (std::int64_t{2} << c.run) + 1, ranges) == c.first) {
    ++c.run;
  }
  while (c.rise < 3 && layer_at(row - (std::int64_t{2} << c.rise) + 1, column, ranges) == c.first) {
    ++c.rise;
  }
  std::int64_t nearest = std::int64_t{1} << 40;
  std::uint32_t below = 0;
  for (std::uint32_t k = 0; k < layers_; ++k) {
    if (k == c.first) continue;
    nearest = std::min<std::int64_t>(nearest, std::abs(ranges[k] - ranges[c.first]));
    below += ranges[k] < ranges[c.first] ? 1 : 0;
  }
  c.nearer = below == 0 ? 2 : below == layers_ - 1 ? 0 : 1;
  std::int64_t bound = state_.settings.step / 8;
  while (c.gap < 7 && nearest > bound) {
    bound = bound * 2 + 1;
    ++c.gap;
  }
  if (state_.guide != nullptr) add_guess(cell, ranges, c);
  return c;
}

void LabelContexts::add_guess(std::uint32_t cell, const LayerRanges& ranges,
                              LabelContext& c) const {
  c.guided = true;
  if (state_.guide->source[cell] < 0) return;
  constexpr std::int64_t far = std::int64_t{1} << 40;
  std::int64_t nearest = far, next = far;
  for (std::uint32_t k = 0; k < layers_; ++k) {
    const std::int64_t distance = std::abs(std::int64_t{ranges[k]} - state_.guide->range[cell]);
    if (distance < nearest) {
      next = nearest;
      nearest = distance;
      c.warped = k;
    } else {
      next = std::min(next, distance);
    }
  }
  c.clear = 4 * nearest <= next;
}

}  // namespace curlidar::compact
