// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_encoder.hpp"

#include <utility>

#include "compact/learnt_models.hpp"
#include "entropy/range_coder.hpp"

namespace curlidar::compact {
namespace {

/// Writes, and adds up what it costs.
class MeteredEncoder {
 public:
  bool code(std::uint32_t probability_of_one, bool bit) {
    counter_.code(probability_of_one, bit);
    return encoder_.code(probability_of_one, bit);
  }
  std::uint64_t cost() const { return counter_.cost(); }
  std::vector<std::byte> finish() && { return std::move(encoder_).finish(); }

 private:
  RangeEncoder encoder_;
  CostCounter counter_;
};

/// A MixSink that keeps the costs of the parts of a field apart.
class PartSink {
 public:
  static constexpr bool kDecodes = false;

  PartSink(MeteredEncoder& encoder, FieldModels& models,
           std::array<std::uint64_t, kFieldParts>& costs)
      : encoder_(encoder), mix_(encoder, models), costs_(costs) {}

  bool bit(const Contexts& c, bool value) {
    const std::uint64_t before = encoder_.cost();
    mix_.bit(c, value);
    costs_[static_cast<std::size_t>(c.part)] += encoder_.cost() - before;
    return value;
  }
  bool plain(FieldPart part, bool value) {
    const std::uint64_t before = encoder_.cost();
    mix_.plain(part, value);
    costs_[static_cast<std::size_t>(part)] += encoder_.cost() - before;
    return value;
  }

 private:
  MeteredEncoder& encoder_;
  MixSink<MeteredEncoder> mix_;
  std::array<std::uint64_t, kFieldParts>& costs_;
};

/// What the models know before the first root.
FieldModels first_models(const Guide* guide) {
  const bool learnt = guide != nullptr && guide->learnt != nullptr && guide->learnt->field;
  return learnt ? *guide->learnt->field : FieldModels(guide != nullptr);
}

}  // namespace

EncodedField encode_field(FieldState& state, const std::vector<std::int32_t>& truth,
                          const SearchSettings& settings) {
  EncodedField out;
  state.clear();
  MeteredEncoder encoder;
  FieldModels models = first_models(state.guide);
  PartSink sink(encoder, models, out.part_cost);
  for (const Block& block : roots_of(state.geometry, state.settings)) {
    const std::size_t surfaces = state.surfaces.size();
    Node node{block, {}, {}, {}, {}};
    // What a root will cost is what the models have learnt from the roots before it.
    const CostTable costs(models);
    PartitionSearch(state, truth, settings, costs).search(node);
    state.forget(block, surfaces);
    code_node(sink, state, node);
    out.roots.push_back(std::move(node));
  }
  out.bytes = std::move(encoder).finish();
  return out;
}

DecodedField decode_field(FieldState& state, ByteSpan bytes, bool whole, bool keep_nodes,
                          LearntModels* learnt) {
  DecodedField out;
  RangeDecoder decoder(bytes);
  FieldModels models = first_models(state.guide);
  MixSink<RangeDecoder> sink(decoder, models);
  for (const Block& block : roots_of(state.geometry, state.settings)) {
    Node node{block, {}, {}, {}, {}};
    code_node(sink, state, node);
    if (whole ? decoder.exhausted() : decoder.past_end()) break;
    ++out.complete_roots;
    if (keep_nodes) out.roots.push_back(std::move(node));
  }
  if (learnt != nullptr && models.guided()) learnt->field = std::move(models);
  return out;
}

}  // namespace curlidar::compact
