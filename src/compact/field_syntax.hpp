// SPDX-License-Identifier: BSD-3-Clause
// The syntax of the field, once for reading, writing and counting: partition, layers, coefficients,
// labels. A sink has `bit(contexts, value)` and `plain(part, value)`; a reading one ignores the
// value and returns what it read.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "compact/field_models.hpp"
#include "compact/field_state.hpp"

namespace curlidar::compact {

/// One layer of a leaf as it is written.
struct LayerCode {
  std::uint32_t parent = 0;      ///< 1 + place among the parents; 0 = a new surface
  std::uint32_t functions = 0;   ///< place in kFunctions
  std::int32_t range_steps = 0;  ///< of a new surface: its range against the expected one
  Quantised q{};                 ///< q[0] stays 0 for a new surface
};

struct LeafCode {
  std::uint32_t layers = 1;
  std::array<LayerCode, kMaxLayers> layer;
};

enum class Split : std::uint8_t { none, quad, rows, columns };

/// What the contexts of a block are made of.
struct BlockContext {
  Block block;
  Direction middle;  ///< of the block's middle cell
  Parents parents;
  std::uint32_t size = 0;    ///< class of its cells, 0..5
  std::uint32_t shape = 0;   ///< class of shorter side and aspect, 0..11
  std::uint32_t filled = 0;  ///< class of the share of cells with a return, 0..2
  std::uint32_t few = 0;     ///< class of the number of returns, 0..3
  std::uint32_t spread = 0;  ///< class of the parents' disagreement at the middle, 0..4
  std::uint32_t left_size = 0, above_size = 0;    ///< 0 none, 1 smaller, 2 equal, 3 larger block
  std::uint32_t left_depth = 0, above_depth = 0;  ///< 0 none, 1 one layer, 2 two, 3 more
  std::array<std::uint32_t, Parents::kMost> parent_functions{};  ///< places in kFunctions
  std::array<Plane, Parents::kMost> parent_plane{};
  bool guided = false;      ///< the scan is predicted: what follows counts
  std::uint32_t warp = 0;   ///< class of what the guide knows of the block, below kWarpClasses
  std::uint32_t trust = 0;  ///< class of how the guide was right beside the block

  /// What a layer starts from: 0 nothing, 1 a neighbour, 2 the warped field, 3 its plane.
  std::uint32_t kind_of(std::uint32_t parent) const {
    if (parent == 0) return 0;
    const std::int32_t surface = parents.surface[parent - 1];
    return surface == kWarpedField ? 2 : surface == kWarpedPlane ? 3 : 1;
  }
};

BlockContext block_context(FieldState& state, const Block& block, std::uint32_t returns);

/// Which splits a block may have.
inline bool may_split(const Block& block, Split split, const FieldSettings& settings) {
  const std::uint32_t cells = block.cells();
  const bool square = block.height == block.width;
  switch (split) {
    case Split::none:
      return true;
    case Split::quad:
      return square && cells / 4 >= settings.smallest_leaf;
    case Split::rows:
      return block.height >= block.width && block.height > 1 && block.height <= 16 &&
             cells / 2 >= settings.smallest_leaf;
    case Split::columns:
      return block.width >= block.height && block.width > 1 && block.width <= 16 &&
             cells / 2 >= settings.smallest_leaf;
  }
  return false;
}

template <class Sink>
Split code_split(Sink& sink, const BlockContext& c, const FieldSettings& settings, Split split) {
  const bool quad = may_split(c.block, Split::quad, settings);
  const bool rows = may_split(c.block, Split::rows, settings);
  const bool columns = may_split(c.block, Split::columns, settings);
  if (!quad && !rows && !columns) return Split::none;
  const std::uint32_t s = c.shape;
  if (!sink.bit(contexts_of(kSplit,
                            {s, s * 16 + c.left_size * 4 + c.above_size,
                             s * 12 + c.filled * 4 + c.few, s * 20 + c.spread * 4 + c.few},
                            s, c.guided, s * kWarpClasses + c.warp,
                            (s * kTrustClasses + c.trust) * 3 + c.filled),
                split != Split::none)) {
    return Split::none;
  }
  const auto kind = [&](std::uint32_t node, bool value) {
    const std::uint32_t n = node * 12 + s;
    return sink.bit(
        contexts_of(kSplitKind,
                    {n, n * 9 + std::min(c.left_depth, 2u) * 3 + std::min(c.above_depth, 2u),
                     n * 3 + c.filled, node},
                    node, c.guided, n * kWarpClasses + c.warp, n * kTrustClasses + c.trust),
        value);
  };
  if (quad && (rows || columns)) {
    if (kind(0, split == Split::quad)) return Split::quad;
  } else if (quad) {
    return Split::quad;
  }
  if (rows && columns) return kind(1, split == Split::rows) ? Split::rows : Split::columns;
  return rows ? Split::rows : Split::columns;
}

/// Exp-Golomb: the class in unary, its highest bit below the leading one modelled, the rest plain.
template <class Sink, class ClassBit, class TopBit>
std::uint32_t code_magnitude(Sink& sink, FieldPart part, std::uint32_t value, ClassBit class_bit,
                             TopBit top_bit) {
  constexpr std::uint32_t most = 21;
  const auto wanted = static_cast<std::uint32_t>(std::bit_width(value));
  std::uint32_t size = 0;
  while (size < most && class_bit(size, size < wanted)) ++size;
  if (size < 2) return size;
  std::uint32_t out = 1;
  for (std::uint32_t i = size - 1; i-- > 0;) {
    const bool bit = (value >> i & 1) != 0;
    out = out << 1 |
          static_cast<std::uint32_t>(i + 2 == size ? top_bit(size, bit) : sink.plain(part, bit));
  }
  return out;
}

template <class Sink>
std::int32_t code_range_steps(Sink& sink, const BlockContext& c, std::uint32_t layer,
                              std::int32_t value) {
  const std::uint32_t late = layer > 0 ? 1 : 0;
  const std::uint32_t known = std::min(c.parents.count, 3u);
  const std::uint32_t s = c.size * 2 + late;
  if (!sink.bit(contexts_of(kRangeZero, {s, s * 4 + known, known, c.spread}, 0, c.guided,
                            s * kTrustClasses + c.trust, late * kWarpClasses + c.warp),
                value != 0)) {
    return 0;
  }
  const bool negative = sink.bit(contexts_of(kRangeSign, {late, known, late, c.spread}, 0, c.guided,
                                             late * kTrustClasses + c.trust, late),
                                 value < 0);
  const std::uint32_t magnitude = code_magnitude(
      sink, FieldPart::coefficients, static_cast<std::uint32_t>(std::abs(value)) - (value != 0),
      [&](std::uint32_t at, bool bit) {
        return sink.bit(contexts_of(kRangeClass, {at, at * 4 + known, at * 2 + late, at}, 0,
                                    c.guided, at * kTrustClasses + c.trust, at * 6 + c.size),
                        bit);
      },
      [&](std::uint32_t size, bool bit) {
        return sink.bit(contexts_of(kRangeBits, {size, size * 2 + negative, size * 2 + late, size},
                                    0, c.guided, size * kTrustClasses + c.trust, size),
                        bit);
      });
  const auto steps = static_cast<std::int32_t>(std::min(magnitude + 1, std::uint32_t{1} << 24));
  return negative ? -steps : steps;
}

template <class Sink>
std::int32_t code_coefficient(Sink& sink, const BlockContext& c, std::uint32_t parent,
                              std::uint32_t layer, std::uint32_t functions, std::uint32_t k,
                              std::uint32_t energy, std::int32_t value) {
  const bool fresh = parent == 0;
  const std::uint32_t from = c.kind_of(parent);
  const std::uint32_t big = c.size > 2 ? 1 : 0;
  const std::uint32_t base = (fresh ? 6 : 0) + k;
  const std::uint32_t kind = base * 4 + big * 2 + (layer > 0 ? 1 : 0);
  const std::uint32_t e = std::min(energy, 3u);
  const std::uint32_t f = functions - 1;
  if (!sink.bit(contexts_of(kCoefficientZero, {kind, kind * 3 + f, kind * 6 + c.size, kind * 4 + e},
                            base, c.guided, (kind * 4 + from) * kTrustClasses + c.trust,
                            (base * 4 + from) * kWarpClasses + c.warp),
                value != 0)) {
    return 0;
  }
  const bool negative =
      sink.bit(contexts_of(kCoefficientSign, {base, base * 3 + f, base * 2 + big, base}, 0,
                           c.guided, base * 4 + from, base * kTrustClasses + c.trust),
               value < 0);
  const std::uint32_t magnitude = code_magnitude(
      sink, FieldPart::coefficients, static_cast<std::uint32_t>(std::abs(value)) - (value != 0),
      [&](std::uint32_t at, bool bit) {
        return sink.bit(
            contexts_of(kCoefficientClass,
                        {base * 24 + at, (f * 6 + c.size) * 24 + at, (k * 4 + e) * 24 + at, at},
                        fresh ? 1 : 0, c.guided, (base * 24 + at) * 4 + from,
                        (c.size * 24 + at) * kTrustClasses + c.trust),
            bit);
      },
      [&](std::uint32_t size, bool bit) {
        return sink.bit(contexts_of(kCoefficientBits, {size, size * 2 + fresh, size * 6 + k, size},
                                    0, c.guided, size * 4 + from, size * kTrustClasses + c.trust),
                        bit);
      });
  const auto steps =
      static_cast<std::int32_t>(std::min<std::uint32_t>(magnitude + 1, kMaxQuantised));
  return negative ? -steps : steps;
}

template <class Sink>
void code_layer(Sink& sink, const BlockContext& c, std::uint32_t layers, std::uint32_t index,
                std::uint32_t used_parents, LayerCode& layer) {
  const std::uint32_t late = index > 0 ? 1 : 0;
  const std::uint32_t count = c.parents.count;
  const std::uint32_t s = c.size * 2 + late;
  if (count == 0) {
    layer.parent = 0;
  } else {
    const std::uint32_t n = std::min(count, 4u) - 1;
    const bool fresh =
        sink.bit(contexts_of(kNewSurface,
                             {s, s * 20 + n * 5 + c.spread,
                              s * 6 + std::min(layers - 1, 2u) * 2 + (used_parents != 0 ? 1u : 0u),
                              s * 16 + c.left_depth * 4 + c.above_depth},
                             late, c.guided, s * kWarpClasses + c.warp,
                             (s * kTrustClasses + c.trust) * 4 + std::min(used_parents & 3, 3u)),
                 layer.parent == 0);
    if (fresh) {
      layer.parent = 0;
    } else {
      std::uint32_t k = 0;
      for (; k + 1 < count; ++k) {
        // Of predicted scans, whose first two parents may be the guide's, k + 1 is at most 6.
        const std::uint32_t at = (k * (c.guided ? 7 : 6) + count - 1) * 2 + late;
        const std::uint32_t used = used_parents >> k & 1;
        if (sink.bit(
                contexts_of(
                    kParent,
                    {at, at * 2 + used, at * 5 + c.spread,
                     (c.parent_functions[k] * 3 + std::min(k, 2u)) * 2 + used},
                    std::min(k, 2u) * 2 + late, c.guided, at * kWarpClasses + c.warp,
                    ((std::min(k, 3u) * kTrustClasses + c.trust) * 16 + (used_parents & 15)) * 2 +
                        late),
                layer.parent == k + 1)) {
          break;
        }
      }
      layer.parent = k + 1;
    }
  }
  const bool fresh = layer.parent == 0;
  const std::uint32_t from = c.kind_of(layer.parent);
  const std::uint32_t inherited = fresh ? 0 : c.parent_functions[layer.parent - 1];
  // A new surface has its constant already.
  std::uint32_t functions = fresh ? 1 : 0;
  for (; functions + 1 < kFunctions.size(); ++functions) {
    const std::uint32_t at = ((functions * 2 + (fresh ? 1u : 0u)) * 6 + c.size) * 2 + late;
    if (!sink.bit(
            contexts_of(kFunctionCount,
                        {at, at * 4 + inherited, at * 4 + c.few, at * 3 + std::min(layers - 1, 2u)},
                        functions * 2 + (fresh ? 1u : 0u), c.guided,
                        (at * 4 + from) * kTrustClasses + c.trust,
                        (functions * 4 + from) * kWarpClasses + c.warp),
            functions < layer.functions)) {
      break;
    }
  }
  layer.functions = functions;
  if (fresh) layer.range_steps = code_range_steps(sink, c, index, layer.range_steps);
  std::uint32_t energy = 0;
  for (std::uint32_t k = fresh ? 1 : 0; k < kFunctions[functions]; ++k) {
    layer.q[k] = code_coefficient(sink, c, layer.parent, index, functions, k, energy, layer.q[k]);
    energy += static_cast<std::uint32_t>(std::min(std::abs(layer.q[k]), 8));
  }
}

/// Everything of a leaf but its labels.
template <class Sink>
void code_leaf(Sink& sink, const BlockContext& c, std::uint32_t returns, LeafCode& leaf) {
  const std::uint32_t most = std::min(kMaxLayers, std::max(returns / 2, 1u));
  std::uint32_t layers = 1;
  for (; layers < most; ++layers) {
    const std::uint32_t at = (layers - 1) * 6 + c.size;
    if (!sink.bit(contexts_of(kLayerCount,
                              {at, at * 16 + c.left_depth * 4 + c.above_depth,
                               at * 15 + c.filled * 5 + c.spread, at * 3 + c.filled},
                              layers - 1, c.guided, at * kWarpClasses + c.warp,
                              at * kTrustClasses + c.trust),
                  layers < leaf.layers)) {
      break;
    }
  }
  leaf.layers = layers;
  std::uint32_t used_parents = 0;
  for (std::uint32_t i = 0; i < layers; ++i) {
    code_layer(sink, c, layers, i, used_parents, leaf.layer[i]);
    if (leaf.layer[i].parent > 0) used_parents |= 1u << (leaf.layer[i].parent - 1);
  }
}

/// What a layer's functions are added to, and their step in Q40.
struct LayerBase {
  Plane plane;
  std::int64_t step_q40 = 0;
};
LayerBase base_of(const FieldState& state, const BlockContext& c, const PatchFrame& frame,
                  const LayerCode& layer);
/// The step of a new surface's range, Q16 metres.
std::int64_t range_step(const FieldState& state, const PatchFrame& frame);

/// The surface that a layer stands for.
Surface surface_of(const FieldState& state, const BlockContext& c, const PatchFrame& frame,
                   const LayerCode& layer);

/// What the label of one cell is told by.
struct LabelContext {
  std::uint32_t first = 0;           ///< the layer that the nearest known neighbour lies on
  std::int32_t second = -1;          ///< another layer among the neighbours, -1 if none
  std::uint32_t pattern = 0;         ///< N, NW, NE on `first`: 0 no, 1 yes, 2 unknown; base 3
  std::uint32_t second_pattern = 0;  ///< the same for `second`
  std::uint32_t wide_pattern = 0;    ///< WW, NN, W on `first`; base 3
  std::uint32_t gap = 0;             ///< class of the distance to the next layer in depth, 0..7
  std::uint32_t nearer = 0;          ///< `first` is 0 the farthest, 1 between, 2 the nearest layer
  std::uint32_t run = 0;             ///< class of how long W-ward cells are on `first`, 0..3
  std::uint32_t rise = 0;            ///< class of how long N-ward cells are on `first`, 0..3
  bool guided = false;
  /// Of predicted scans: the layer nearest to the guide's range (kMaxLayers: it has none), and
  /// whether it is so by far.
  std::uint32_t warped = kMaxLayers;
  bool clear = false;

  /// What the guide says of a layer: 0 nothing, 1 and 2 this one, 3 and 4 another; by far.
  std::uint32_t guess(std::uint32_t layer) const {
    if (warped == kMaxLayers) return 0;
    return (warped == layer ? 1 : 3) + (clear ? 1 : 0);
  }
};

/// Predicted ranges of a cell by layer.
using LayerRanges = std::array<std::int32_t, kMaxLayers>;

/// `labels` of the block's cells so far, by place in the block (kMaxLayers = none).
class LabelContexts {
 public:
  LabelContexts(const FieldState& state, const Block& block, std::uint32_t layers);

  LabelContext at(std::uint32_t cell, const LayerRanges& ranges) const;
  void set(std::uint32_t cell, std::uint32_t label);

 private:
  std::uint32_t layer_at(std::int64_t row, std::int64_t column, const LayerRanges& ranges) const;
  void add_guess(std::uint32_t cell, const LayerRanges& ranges, LabelContext& context) const;

  const FieldState& state_;
  Block block_;
  std::uint32_t layers_;
  std::array<std::uint8_t, 32 * 32> labels_;
};

template <class Sink>
std::uint32_t code_label(Sink& sink, const LabelContext& c, std::uint32_t layers,
                         std::uint32_t label) {
  const std::uint32_t n = layers - 2;
  const std::uint32_t w = c.wide_pattern % 3;  // W
  const std::uint32_t known = w != 2 ? 1 : 0;
  if (sink.bit(
          contexts_of(kLabelFirst,
                      {(c.pattern * 2 + known) * 3 + n,
                       ((c.gap > 5 ? 5 : c.gap) * 3 + c.nearer) * 27 + c.pattern,
                       c.pattern * 27 + c.wide_pattern, (c.run * 4 + c.rise) * 3 + c.nearer},
                      n * 3 + w, c.guided, ((c.pattern * 2 + known) * 3 + n) * 5 + c.guess(c.first),
                      (std::min(c.gap, 5u) * 3 + c.nearer) * 5 + c.guess(c.first)),
          label == c.first)) {
    return c.first;
  }
  if (layers == 2) return 1 - c.first;
  std::uint32_t left = layers - 1;
  if (c.second >= 0) {
    const auto second = static_cast<std::uint32_t>(c.second);
    const std::uint32_t m = n - 1;
    if (sink.bit(contexts_of(kLabelSecond,
                             {c.second_pattern * 3 + n, c.second_pattern * 2 + m,
                              c.pattern * 3 + c.nearer, (c.gap * 3 + c.nearer) * 4 + c.run},
                             n, c.guided, (c.second_pattern * 3 + n) * 5 + c.guess(second),
                             c.gap * 5 + c.guess(second)),
                 label == second)) {
      return second;
    }
    --left;
  }
  for (std::uint32_t k = 0; k < layers; ++k) {
    if (k == c.first || static_cast<std::int32_t>(k) == c.second) continue;
    if (left == 1) return k;
    const std::uint32_t at = (n * 2 + (left - 2)) * 4 + k;
    if (sink.bit(contexts_of(kLabelRest, {at, at, c.nearer, at}, 0, c.guided, at * 5 + c.guess(k),
                             c.guess(k)),
                 label == k))
      return k;
    --left;
  }
  return c.first;
}

}  // namespace curlidar::compact
