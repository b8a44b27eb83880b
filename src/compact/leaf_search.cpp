// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

#include "compact/field_search.hpp"
#include "compact/leaf_fit.hpp"

namespace curlidar::compact {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

/// 256 log2(x), linear between powers of two.
std::int32_t rough_log2(std::int64_t x) {
  const auto exponent = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(x))) - 1;
  const std::int64_t fraction = exponent >= 8 ? x >> (exponent - 8) : x << (8 - exponent);
  return exponent * 256 + static_cast<std::int32_t>(fraction) - 256;
}

/// A layer with the ranges it gives to every sample of the leaf.
struct FittedLayer {
  LayerCode code;
  std::vector<std::int32_t> ranges;
};

class LeafSearch {
 public:
  LeafSearch(FieldState& state, const std::vector<std::int32_t>& truth,
             const SearchSettings& settings, const CostTable& costs, const BlockContext& context)
      : state_(state),
        settings_(settings),
        context_(context),
        frame_(state.geometry, state.shape(context.block), context.block),
        samples_(state, context, frame_, truth, state.cells_of(context.block)),
        sink_(costs) {}

  std::int64_t run(Node& node) {
    try_one_layer();
    const auto n = static_cast<std::uint32_t>(samples_.size());
    if (settings_.max_layers > 1 && n >= 4 && best_ > 8 * 256 * settings_.lambda) {
      try_two_layers();
      for (std::uint32_t layers = 3; layers <= settings_.max_layers; ++layers) {
        if (best_leaf_.layers != layers - 1 || n < 2 * layers) break;
        try_another_layer(layers);
      }
    }
    node.leaf = best_leaf_;
    node.labels = best_labels_;
    return best_;
  }

 private:
  using Members = std::vector<std::uint32_t>;

  std::vector<std::int32_t> ranges_of(const LayerCode& code) const {
    const Surface surface = surface_of(state_, context_, frame_, code);
    std::vector<std::int32_t> ranges(samples_.size());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      ranges[i] = static_cast<std::int32_t>(state_.range_in(surface, frame_, samples_.cells[i]));
    }
    return ranges;
  }

  std::int64_t error(std::size_t i, std::int32_t range) const {
    return std::abs(samples_.ranges[i] - range);
  }
  /// Cost of a cell's error in J: plain, or with a residual layer on top.
  std::int64_t error_cost(std::int64_t e, bool residual) const {
    if (!residual) return e * 256;
    const std::int64_t at = e * 8 / settings_.residual_step;
    const auto last = static_cast<std::int64_t>(settings_.residual_costs.size()) - 1;
    return settings_.residual_costs[static_cast<std::size_t>(std::min(at, last))];
  }

  Members all_members() const {
    Members all(samples_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }

  /// Parents that corrections are fitted on; those of a guide come before the others.
  std::uint32_t fitted_parents() const {
    return settings_.fitted_parents + (context_.warp != 0 ? 2 : 0);
  }

  /// Most functions (place in kFunctions) worth trying on so many returns.
  std::uint32_t most_functions(std::size_t members) const {
    std::uint32_t most = settings_.max_functions;
    while (most > 1 && kFunctions[most] > members + 1) --most;
    if (most == 3 && (context_.block.cells() < 16 || members < 12)) most = 2;
    return most;
  }

  void consider(const LeafCode& leaf, const std::vector<FittedLayer>& layers);
  std::int64_t choose_labels(std::int64_t cost, bool residual,
                             const std::vector<FittedLayer>& layers,
                             std::vector<std::uint8_t>& labels);
  std::int64_t cost_of_one(const LayerCode& layer);
  void consider_one(const LayerCode& layer);
  void try_one_layer();
  void try_two_layers();
  void try_another_layer(std::uint32_t layers);
  void refine(std::uint32_t layers, std::vector<std::uint8_t> labels);
  std::optional<FittedLayer> best_layer(const Members& members, std::uint32_t layers,
                                        std::uint32_t index, std::uint32_t used) const;

  FieldState& state_;
  const SearchSettings& settings_;
  const BlockContext& context_;
  PatchFrame frame_;
  LeafSamples samples_;
  mutable SearchSink sink_;
  std::int64_t best_ = kNever;
  LeafCode best_leaf_;
  std::vector<std::uint8_t> best_labels_;
};

/// Takes the leaf of several layers if it is the best so far.
void LeafSearch::consider(const LeafCode& leaf, const std::vector<FittedLayer>& layers) {
  sink_.clear();
  LeafCode copy = leaf;
  code_leaf(sink_, context_, static_cast<std::uint32_t>(samples_.size()), copy);
  const std::int64_t header = sink_.cost() * settings_.lambda;
  const bool has_residual = !settings_.residual_costs.empty();
  for (const bool residual : {false, true}) {
    if (residual && !has_residual) break;
    std::vector<std::uint8_t> labels(samples_.size());
    const std::int64_t flag = has_residual ? (residual ? 384 : 192) * settings_.lambda : 0;
    const std::int64_t cost = choose_labels(header + flag, residual, layers, labels);
    if (cost >= best_) continue;
    best_ = cost;
    best_leaf_ = leaf;
    best_labels_ = std::move(labels);
  }
}

/// Labels chosen one after the other; `cost` and what they cost, at least best_ if that is reached.
std::int64_t LeafSearch::choose_labels(std::int64_t cost, bool residual,
                                       const std::vector<FittedLayer>& layers,
                                       std::vector<std::uint8_t>& labels) {
  const auto count = static_cast<std::uint32_t>(layers.size());
  LabelContexts contexts(state_, context_.block, count);
  for (std::size_t i = 0; i < samples_.size() && cost < best_; ++i) {
    LayerRanges ranges{};
    for (std::uint32_t k = 0; k < count; ++k) ranges[k] = layers[k].ranges[i];
    const LabelContext context = contexts.at(samples_.cells[i], ranges);
    std::int64_t least = kNever;
    for (std::uint32_t k = 0; k < count; ++k) {
      sink_.clear();
      code_label(sink_, context, count, k);
      const std::int64_t j =
          error_cost(error(i, ranges[k]), residual) + sink_.cost() * settings_.lambda;
      if (j >= least) continue;
      least = j;
      labels[i] = static_cast<std::uint8_t>(k);
    }
    cost += least;
    contexts.set(samples_.cells[i], labels[i]);
  }
  return cost;
}

/// J of the leaf with this one layer; stops counting where the best so far is reached.
std::int64_t LeafSearch::cost_of_one(const LayerCode& layer) {
  LeafCode leaf;
  leaf.layer[0] = layer;
  sink_.clear();
  code_leaf(sink_, context_, static_cast<std::uint32_t>(samples_.size()), leaf);
  const std::int64_t header = sink_.cost() * settings_.lambda;
  const bool has_residual = !settings_.residual_costs.empty();
  std::int64_t plain = header + (has_residual ? 192 * settings_.lambda : 0);
  std::int64_t refined = has_residual ? header + 384 * settings_.lambda : kNever;
  const Surface surface = surface_of(state_, context_, frame_, layer);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (plain >= best_ && refined >= best_) return best_;
    const std::int64_t e =
        error(i, static_cast<std::int32_t>(state_.range_in(surface, frame_, samples_.cells[i])));
    plain += error_cost(e, false);
    if (has_residual) refined += error_cost(e, true);
  }
  return std::min(plain, refined);
}

void LeafSearch::consider_one(const LayerCode& layer) {
  const std::int64_t cost = cost_of_one(layer);
  if (cost >= best_) return;
  best_ = cost;
  best_leaf_ = {};
  best_leaf_.layer[0] = layer;
  best_labels_.clear();
}

void LeafSearch::try_one_layer() {
  const Members all = all_members();
  const std::uint32_t most = most_functions(all.size());
  LayerFit plain(state_, context_, frame_, samples_, all, {});
  for (std::uint32_t parent = 0; parent <= context_.parents.count; ++parent) {
    for (std::uint32_t functions = parent == 0 ? 1 : 0; functions <= most; ++functions) {
      if (parent > fitted_parents() && functions > 0) break;
      auto layer = plain.fit(parent, functions);
      if (!layer) continue;
      consider_one(*layer);
      if (functions < 2) continue;
      for (std::uint32_t pass = 0; pass < settings_.reweighted_passes; ++pass) {
        const std::vector<std::int32_t> ranges = ranges_of(*layer);
        std::vector<double> extra;
        extra.reserve(all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
          extra.push_back(1.0 / static_cast<double>(std::max<std::int64_t>(
                                    state_.settings.step / 2 + 1, error(i, ranges[i]))));
        }
        const auto next =
            LayerFit(state_, context_, frame_, samples_, all, extra).fit(parent, functions);
        if (!next || (next->q == layer->q && next->range_steps == layer->range_steps)) break;
        layer = next;
        consider_one(*layer);
      }
    }
  }
}

std::optional<FittedLayer> LeafSearch::best_layer(const Members& members, std::uint32_t layers,
                                                  std::uint32_t index, std::uint32_t used) const {
  std::int64_t least = kNever;
  std::optional<FittedLayer> best;
  const std::uint32_t most = most_functions(members.size());
  LayerFit fit(state_, context_, frame_, samples_, members, {});
  for (std::uint32_t parent = 0; parent <= context_.parents.count; ++parent) {
    for (std::uint32_t functions = parent == 0 ? 1 : 0; functions <= most; ++functions) {
      if (parent > fitted_parents() && functions > 0) break;
      const auto code = fit.fit(parent, functions);
      if (!code) continue;
      sink_.clear();
      LayerCode copy = *code;
      code_layer(sink_, context_, layers, index, used, copy);
      std::int64_t cost = sink_.cost() * settings_.lambda;
      if (cost >= least) continue;
      const Surface surface = surface_of(state_, context_, frame_, *code);
      for (const std::uint32_t i : members) {
        if (cost >= least) break;
        cost += 256 * error(i, static_cast<std::int32_t>(
                                   state_.range_in(surface, frame_, samples_.cells[i])));
      }
      if (cost >= least) continue;
      least = cost;
      best = FittedLayer{*code, {}};
    }
  }
  if (best) best->ranges = ranges_of(best->code);
  return best;
}

/// Fits `layers` layers to the samples so labelled, relabels, and again; considers each.
void LeafSearch::refine(std::uint32_t layers, std::vector<std::uint8_t> labels) {
  for (std::uint32_t pass = 0; pass < settings_.layer_passes; ++pass) {
    LeafCode leaf;
    leaf.layers = layers;
    std::vector<FittedLayer> fitted;
    std::uint32_t used = 0;
    for (std::uint32_t k = 0; k < layers; ++k) {
      Members members;
      for (std::uint32_t i = 0; i < labels.size(); ++i) {
        if (labels[i] == k) members.push_back(i);
      }
      if (members.empty()) return;
      auto layer = best_layer(members, layers, k, used);
      if (!layer) return;
      leaf.layer[k] = layer->code;
      if (layer->code.parent > 0) used |= 1u << (layer->code.parent - 1);
      fitted.push_back(std::move(*layer));
    }
    consider(leaf, fitted);
    bool changed = false;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      std::uint8_t nearest = 0;
      for (std::uint32_t k = 1; k < layers; ++k) {
        if (error(i, fitted[k].ranges[i]) < error(i, fitted[nearest].ranges[i])) {
          nearest = static_cast<std::uint8_t>(k);
        }
      }
      changed |= nearest != labels[i];
      labels[i] = nearest;
    }
    if (!changed) break;
  }
}

/// Where sorted values fall apart best: at the widest gap, and where the variance between the two
/// sides is greatest (Otsu). Places in 1..n-1.
struct Cuts {
  std::size_t gap = 1, otsu = 1;
  std::int32_t width = 0;
};

Cuts cut(const std::vector<std::int32_t>& sorted) {
  Cuts cuts;
  const auto n = static_cast<std::int64_t>(sorted.size());
  std::int64_t total = 0, before = 0;
  for (const std::int32_t x : sorted) total += x;
  double greatest = -1;
  for (std::int64_t i = 1; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    before += sorted[at - 1];
    if (sorted[at] - sorted[at - 1] > cuts.width) {
      cuts.width = sorted[at] - sorted[at - 1];
      cuts.gap = at;
    }
    const double difference = static_cast<double>(before) / static_cast<double>(i) -
                              static_cast<double>(total - before) / static_cast<double>(n - i);
    const double between =
        static_cast<double>(i) * static_cast<double>(n - i) * difference * difference;
    if (between > greatest) {
      greatest = between;
      cuts.otsu = at;
    }
  }
  return cuts;
}

void LeafSearch::try_two_layers() {
  std::vector<std::int32_t> logs, sorted;
  for (const std::int64_t range : samples_.ranges) logs.push_back(rough_log2(range));
  sorted = logs;
  std::sort(sorted.begin(), sorted.end());
  const Cuts cuts = cut(sorted);
  std::vector<std::size_t> places = {cuts.gap};
  if (cuts.otsu != cuts.gap) places.push_back(cuts.otsu);
  for (const std::size_t place : places) {
    std::vector<std::uint8_t> labels(logs.size());
    for (std::size_t i = 0; i < logs.size(); ++i) labels[i] = logs[i] >= sorted[place] ? 1 : 0;
    refine(2, std::move(labels));
  }
}

void LeafSearch::try_another_layer(std::uint32_t layers) {
  std::vector<std::uint8_t> labels = best_labels_;
  std::vector<std::int64_t> errors(layers, 0);
  std::vector<std::vector<std::int32_t>> ranges;
  for (std::uint32_t k = 0; k + 1 < layers; ++k) ranges.push_back(ranges_of(best_leaf_.layer[k]));
  for (std::size_t i = 0; i < labels.size(); ++i)
    errors[labels[i]] += error(i, ranges[labels[i]][i]);
  const auto worst =
      static_cast<std::uint8_t>(std::max_element(errors.begin(), errors.end()) - errors.begin());
  std::vector<std::int32_t> sorted;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == worst) sorted.push_back(rough_log2(samples_.ranges[i]));
  }
  if (sorted.size() < 2) return;
  std::sort(sorted.begin(), sorted.end());
  const std::int32_t bound = sorted[cut(sorted).otsu];
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == worst && rough_log2(samples_.ranges[i]) >= bound) {
      labels[i] = static_cast<std::uint8_t>(layers - 1);
    }
  }
  refine(layers, std::move(labels));
}

}  // namespace

std::int64_t search_leaf(FieldState& state, const std::vector<std::int32_t>& truth,
                         const SearchSettings& settings, const CostTable& costs,
                         const BlockContext& context, Node& node) {
  return LeafSearch(state, truth, settings, costs, context).run(node);
}

}  // namespace curlidar::compact
