// SPDX-License-Identifier: BSD-3-Clause
// The adaptive models of the field's syntax: which decision of which element learns where.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "entropy/model.hpp"

namespace curlidar::compact {

/// Every decision is a mix of this many models; the first is the one that a search trusts alone.
inline constexpr std::size_t kFieldInputs = 4;

/// Parts of a file that sizes are reported for.
enum class FieldPart : std::uint8_t { partition, modes, coefficients, labels };
inline constexpr std::size_t kFieldParts = 4;

/// The models of one decision.
struct Contexts {
  std::array<std::uint32_t, kFieldInputs> model{};
  std::uint32_t mixer = 0;
  FieldPart part = FieldPart::partition;
};

/// Where the models of each input of one kind of decision begin, and its first mixer.
struct ModelRange {
  std::array<std::uint32_t, kFieldInputs> begin{};
  std::uint32_t mixer = 0;
};

/// Counts of contexts of each input of each kind of decision; the layout of the table follows.
struct DecisionKind {
  std::array<std::uint32_t, kFieldInputs> contexts;
  std::uint32_t mixers;
  FieldPart part;
};

enum Decision : std::uint32_t {
  kSplit,
  kSplitKind,
  kLayerCount,
  kNewSurface,
  kParent,
  kFunctionCount,
  kRangeZero,
  kRangeSign,
  kRangeClass,
  kRangeBits,
  kCoefficientZero,
  kCoefficientSign,
  kCoefficientClass,
  kCoefficientBits,
  kLabelFirst,
  kLabelSecond,
  kLabelRest,
  kDecisions
};

inline constexpr std::array<DecisionKind, kDecisions> kDecisionKinds = {{
    {{12, 12 * 16, 12 * 12, 12 * 20}, 12, FieldPart::partition},    // kSplit
    {{24, 24 * 9, 24 * 3, 2}, 2, FieldPart::partition},             // kSplitKind
    {{18, 18 * 16, 18 * 15, 18 * 3}, 3, FieldPart::modes},          // kLayerCount
    {{12, 12 * 20, 12 * 6, 12 * 16}, 2, FieldPart::modes},          // kNewSurface
    {{72, 72 * 2, 72 * 5, 24}, 6, FieldPart::modes},                // kParent
    {{72, 72 * 4, 72 * 4, 72 * 3}, 6, FieldPart::modes},            // kFunctionCount
    {{12, 12 * 4, 4, 5}, 1, FieldPart::coefficients},               // kRangeZero
    {{2, 4, 2, 5}, 1, FieldPart::coefficients},                     // kRangeSign
    {{24, 24 * 4, 24 * 2, 24}, 1, FieldPart::coefficients},         // kRangeClass
    {{24, 48, 48, 24}, 1, FieldPart::coefficients},                 // kRangeBits
    {{48, 48 * 3, 48 * 6, 48 * 4}, 12, FieldPart::coefficients},    // kCoefficientZero
    {{12, 36, 24, 12}, 1, FieldPart::coefficients},                 // kCoefficientSign
    {{12 * 24, 24 * 18, 24 * 24, 24}, 2, FieldPart::coefficients},  // kCoefficientClass
    {{24, 48, 24 * 6, 24}, 1, FieldPart::coefficients},             // kCoefficientBits
    {{162, 486, 729, 48}, 9, FieldPart::labels},                    // kLabelFirst
    {{81, 54, 81, 96}, 3, FieldPart::labels},                       // kLabelSecond
    {{24, 24, 3, 24}, 1, FieldPart::labels},                        // kLabelRest
}};

/// Where the models of every decision lie in the table.
inline constexpr std::array<ModelRange, kDecisions> kModelRanges = [] {
  std::array<ModelRange, kDecisions> ranges{};
  std::uint32_t model = 0, mixer = 0;
  for (std::size_t d = 0; d < kDecisions; ++d) {
    for (std::size_t i = 0; i < kFieldInputs; ++i) {
      ranges[d].begin[i] = model;
      model += kDecisionKinds[d].contexts[i];
    }
    ranges[d].mixer = mixer;
    mixer += kDecisionKinds[d].mixers;
  }
  return ranges;
}();

inline constexpr std::uint32_t kFieldModels = [] {
  std::uint32_t total = 0;
  for (const DecisionKind& kind : kDecisionKinds) {
    for (const std::uint32_t contexts : kind.contexts) total += contexts;
  }
  return total;
}();
inline constexpr std::uint32_t kFieldMixers = [] {
  std::uint32_t total = 0;
  for (const DecisionKind& kind : kDecisionKinds) total += kind.mixers;
  return total;
}();

/// Contexts given relative to their kind of decision. Every one must lie below its count.
inline Contexts contexts_of(Decision decision, const std::array<std::uint32_t, kFieldInputs>& at,
                            std::uint32_t mixer) {
  const ModelRange& range = kModelRanges[decision];
  Contexts out;
  for (std::size_t i = 0; i < kFieldInputs; ++i) out.model[i] = range.begin[i] + at[i];
  out.mixer = range.mixer + mixer;
  out.part = kDecisionKinds[decision].part;
  return out;
}

/// What adapts while a segment is coded.
struct FieldModels {
  std::vector<BitModel> models;
  std::vector<MixWeights<kFieldInputs>> weights;

  /// As every segment starts: the tables field and field_mix of docs/format/priors.
  FieldModels();
  /// Without any knowledge, for training.
  static FieldModels blank();

 private:
  FieldModels(std::vector<BitModel> m, std::vector<MixWeights<kFieldInputs>> w)
      : models(std::move(m)), weights(std::move(w)) {}
};

inline constexpr std::int32_t kFieldMixRate = 10;
inline constexpr std::uint32_t kFieldLimit = 127;

/// Codes decisions with a range coder, or counts them exactly.
template <class Coder>
class MixSink {
 public:
  static constexpr bool kDecodes = Coder::kDecodes;

  MixSink(Coder& coder, FieldModels& models, std::int32_t rate = kFieldMixRate)
      : coder_(coder), models_(models), rate_(rate) {}

  bool bit(const Contexts& c, bool value) {
    std::array<BitModel*, kFieldInputs> inputs;
    for (std::size_t i = 0; i < kFieldInputs; ++i) inputs[i] = &models_.models[c.model[i]];
    return code_bit(coder_, inputs, models_.weights[c.mixer], rate_, kFieldLimit, value);
  }
  /// A bit that nothing tells about.
  bool plain(FieldPart, bool value) { return coder_.code(32768, value); }

 private:
  Coder& coder_;
  FieldModels& models_;
  std::int32_t rate_;
};

}  // namespace curlidar::compact
