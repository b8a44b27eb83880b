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

/// Every decision is a mix of this many models; of single scans the first is the one
/// that a search trusts alone.
inline constexpr std::size_t kFieldInputs = 4;

/// Decisions of predicted scans have two more.
inline constexpr std::size_t kGuidedInputs = 6;
/// Classes of what is known of a block from the scan before, and of how true that was beside it.
inline constexpr std::uint32_t kWarpClasses = 31, kTrustClasses = 5;

/// Parts of a file that sizes are reported for.
enum class FieldPart : std::uint8_t { partition, modes, coefficients, labels };
inline constexpr std::size_t kFieldParts = 4;

/// The models of one decision.
struct Contexts {
  std::array<std::uint32_t, kGuidedInputs> model{};  ///< the last two of predicted scans only
  std::uint32_t search = 0;                          ///< the one that a search trusts alone
  std::uint32_t mixer = 0;
  FieldPart part = FieldPart::partition;
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

/// What predicted scans change: two inputs more, and one parent more than the five beside a block.
struct GuidedKind {
  std::array<std::uint32_t, kGuidedInputs> contexts;
};
inline constexpr std::array<GuidedKind, kDecisions> kGuidedKinds = [] {
  constexpr std::uint32_t w = kWarpClasses, t = kTrustClasses;
  constexpr std::array<std::array<std::uint32_t, 2>, kDecisions> more = {{
      {12 * w, 12 * 3 * t},       // kSplit
      {24 * w, 24 * t},           // kSplitKind
      {18 * w, 18 * t},           // kLayerCount
      {12 * w, 12 * 4 * t},       // kNewSurface
      {84 * w, 4 * 16 * 2 * t},   // kParent
      {72 * 4 * t, 3 * 4 * w},    // kFunctionCount
      {12 * t, 2 * w},            // kRangeZero
      {2 * t, 2},                 // kRangeSign
      {24 * t, 24 * 6},           // kRangeClass
      {24 * t, 24},               // kRangeBits
      {48 * 4 * t, 12 * 4 * w},   // kCoefficientZero
      {12 * 4, 12 * t},           // kCoefficientSign
      {12 * 24 * 4, 6 * 24 * t},  // kCoefficientClass
      {24 * 4, 24 * t},           // kCoefficientBits
      {162 * 5, 18 * 5},          // kLabelFirst
      {81 * 5, 8 * 5},            // kLabelSecond
      {24 * 5, 5},                // kLabelRest
  }};
  std::array<GuidedKind, kDecisions> kinds{};
  for (std::size_t d = 0; d < kDecisions; ++d) {
    const auto& plain = kDecisionKinds[d].contexts;
    kinds[d].contexts = {plain[0], plain[1], plain[2], plain[3], more[d][0], more[d][1]};
  }
  kinds[kParent].contexts = {84, 84 * 2, 84 * 5, 24, more[kParent][0], more[kParent][1]};
  return kinds;
}();

/// Where the models of each input of every kind of decision begin, and its first mixer.
template <std::size_t Inputs>
struct FieldLayout {
  struct Place {
    std::array<std::uint32_t, Inputs> begin{};
    std::uint32_t mixer = 0;
  };
  std::array<Place, kDecisions> kind{};
  std::uint32_t models = 0, mixers = 0;
};

/// Of single scans.
inline constexpr FieldLayout<kFieldInputs> kFieldLayout = [] {
  FieldLayout<kFieldInputs> layout;
  for (std::size_t d = 0; d < kDecisions; ++d) {
    for (std::size_t i = 0; i < kFieldInputs; ++i) {
      layout.kind[d].begin[i] = layout.models;
      layout.models += kDecisionKinds[d].contexts[i];
    }
    layout.kind[d].mixer = layout.mixers;
    layout.mixers += kDecisionKinds[d].mixers;
  }
  return layout;
}();
inline constexpr std::uint32_t kFieldModels = kFieldLayout.models;
inline constexpr std::uint32_t kFieldMixers = kFieldLayout.mixers;

/// The input of predicted scans that a search trusts alone. Its models come first.
inline constexpr std::size_t kSearchInput = 4;
/// Of predicted scans: input by input, that of the search first.
inline constexpr FieldLayout<kGuidedInputs> kGuidedLayout = [] {
  FieldLayout<kGuidedInputs> layout;
  for (const std::size_t i : {kSearchInput, std::size_t{0}, std::size_t{1}, std::size_t{2},
                              std::size_t{3}, std::size_t{5}}) {
    for (std::size_t d = 0; d < kDecisions; ++d) {
      layout.kind[d].begin[i] = layout.models;
      layout.models += kGuidedKinds[d].contexts[i];
    }
  }
  for (std::size_t d = 0; d < kDecisions; ++d) {
    layout.kind[d].mixer = layout.mixers;
    layout.mixers += kDecisionKinds[d].mixers;
  }
  return layout;
}();
/// Models of the search's input.
inline constexpr std::uint32_t kSearchModels = kGuidedLayout.kind[0].begin[0];

/// Contexts given relative to their kind of decision. Every one must lie below its count. The last
/// two are those of predicted scans.
inline Contexts contexts_of(Decision decision, const std::array<std::uint32_t, kFieldInputs>& at,
                            std::uint32_t mixer, bool guided, std::uint32_t fifth,
                            std::uint32_t sixth) {
  Contexts out;
  out.part = kDecisionKinds[decision].part;
  if (!guided) {
    const auto& place = kFieldLayout.kind[decision];
    for (std::size_t i = 0; i < kFieldInputs; ++i) out.model[i] = place.begin[i] + at[i];
    out.search = out.model[0];
    out.mixer = place.mixer + mixer;
    return out;
  }
  const auto& place = kGuidedLayout.kind[decision];
  for (std::size_t i = 0; i < kFieldInputs; ++i) out.model[i] = place.begin[i] + at[i];
  out.model[4] = place.begin[4] + fifth;
  out.model[5] = place.begin[5] + sixth;
  out.search = out.model[kSearchInput];
  out.mixer = place.mixer + mixer;
  return out;
}

/// What adapts while a segment is coded.
struct FieldModels {
  std::vector<BitModel> models;
  std::vector<MixWeights<kFieldInputs>> weights;
  std::vector<MixWeights<kGuidedInputs>> guided_weights;  ///< in place of `weights`

  /// As every segment starts: the tables field and field_mix of docs/format/priors, or, of
  /// predicted scans, predicted_field and predicted_field_mix.
  explicit FieldModels(bool guided = false);
  /// Without any knowledge, for training.
  static FieldModels blank(bool guided = false);

  bool guided() const { return weights.empty(); }

 private:
  FieldModels(std::vector<BitModel> m, std::vector<MixWeights<kFieldInputs>> w,
              std::vector<MixWeights<kGuidedInputs>> g)
      : models(std::move(m)), weights(std::move(w)), guided_weights(std::move(g)) {}
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
    return models_.guided() ? mixed(models_.guided_weights[c.mixer], c, value)
                            : mixed(models_.weights[c.mixer], c, value);
  }
  /// A bit that nothing tells about.
  bool plain(FieldPart, bool value) { return coder_.code(32768, value); }

 private:
  template <std::size_t Inputs>
  bool mixed(MixWeights<Inputs>& weights, const Contexts& c, bool value) {
    std::array<BitModel*, Inputs> inputs;
    for (std::size_t i = 0; i < Inputs; ++i) inputs[i] = &models_.models[c.model[i]];
    return code_bit(coder_, inputs, weights, rate_, kFieldLimit, value);
  }

  Coder& coder_;
  FieldModels& models_;
  std::int32_t rate_;
};

}  // namespace curlidar::compact
