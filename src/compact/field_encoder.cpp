// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_encoder.hpp"

#include "entropy/range_coder.hpp"

namespace curlidar::compact {
namespace {

/// Counts what a MixSink would write, by part.
class PartSink {
 public:
  static constexpr bool kDecodes = false;

  PartSink(FieldModels& models, std::array<std::uint64_t, kFieldParts>& costs)
      : mix_(counter_, models), costs_(costs) {}

  bool bit(const Contexts& c, bool value) {
    const std::uint64_t before = counter_.cost();
    mix_.bit(c, value);
    costs_[static_cast<std::size_t>(c.part)] += counter_.cost() - before;
    return value;
  }
  bool plain(FieldPart part, bool value) {
    costs_[static_cast<std::size_t>(part)] += 256;
    return value;
  }

 private:
  CostCounter counter_;
  MixSink<CostCounter> mix_;
  std::array<std::uint64_t, kFieldParts>& costs_;
};

}  // namespace

EncodedField encode_field(FieldState& state, const std::vector<std::int32_t>& truth,
                          const SearchSettings& settings, std::uint32_t passes) {
  EncodedField out;
  CostTable costs;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    state.clear();
    FieldModels models;
    if (pass == 0) costs = CostTable(models.models);
    out.roots.clear();
    out.part_cost = {};
    PartSink counter(models, out.part_cost);
    for (const Block& block : roots_of(state.geometry, state.settings)) {
      const std::size_t surfaces = state.surfaces.size();
      Node node{block, {}, {}, {}, {}};
      PartitionSearch search(state, truth, settings, costs);
      search.search(node);
      // Count it as it will be written, which also teaches the costs of what follows.
      state.surfaces.erase(state.surfaces.begin() + static_cast<std::ptrdiff_t>(surfaces),
                           state.surfaces.end());
      for (std::uint32_t i = 0; i < block.height; ++i) {
        std::fill_n(state.surface.begin() +
                        static_cast<std::ptrdiff_t>(state.cell(block.row + i, block.column)),
                    block.width, kNoSurface);
      }
      code_node(counter, state, node);
      if (pass == 0) costs = CostTable(models.models);
      out.roots.push_back(std::move(node));
    }
    costs = CostTable(models.models);
  }
  out.part_cost = {};
  {
    state.clear();
    FieldModels models;
    PartSink counter(models, out.part_cost);
    for (Node& node : out.roots) code_node(counter, state, node);
  }
  state.clear();
  RangeEncoder encoder;
  FieldModels models;
  MixSink<RangeEncoder> sink(encoder, models);
  for (Node& node : out.roots) code_node(sink, state, node);
  out.bytes = std::move(encoder).finish();
  return out;
}

DecodedField decode_field(FieldState& state, ByteSpan bytes, bool whole) {
  DecodedField out;
  RangeDecoder decoder(bytes);
  FieldModels models;
  MixSink<RangeDecoder> sink(decoder, models);
  for (const Block& block : roots_of(state.geometry, state.settings)) {
    Node node{block, {}, {}, {}, {}};
    code_node(sink, state, node);
    if (whole ? decoder.exhausted() : decoder.past_end()) break;
    ++out.complete_roots;
    out.roots.push_back(std::move(node));
  }
  return out;
}

}  // namespace curlidar::compact
