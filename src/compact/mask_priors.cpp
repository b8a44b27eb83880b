// SPDX-License-Identifier: BSD-3-Clause
#include "compact/mask_priors.hpp"

#include <cstdint>
#include <vector>

#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::compact {

MaskModel::MaskModel() : models_(kModels), weights_(kWeightSets) {
  constexpr std::int32_t share = (5 << 20) / (4 * static_cast<std::int32_t>(kMaskModels));
  for (auto& set : weights_) {
    for (std::size_t m = 0; m < kMaskModels; ++m) set.set(m, share);
  }
}

GuidedMaskModel::GuidedMaskModel() : models_(kModels), weights_(kWeightSets) {
  constexpr std::int32_t share = (5 << 20) / (4 * static_cast<std::int32_t>(kGuidedMaskModels));
  for (auto& set : weights_) {
    for (std::size_t m = 0; m < kMaskModels; ++m) set.set(m, share);
    for (std::size_t m = kMaskInputs + kHintCells; m < kGuidedMaskInputs; ++m) set.set(m, share);
  }
}

namespace {

/// Weights are stored in 1/4096 and read in 1/65536; here they count in 1/2^20.
template <std::size_t Inputs>
void read_weights(std::string_view text, std::span<WeightSet<Inputs>> sets) {
  if (text.empty()) return;
  std::vector<std::int32_t> weights(sets.size() * Inputs);
  apply_weight_priors(text, weights);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sets[i / Inputs].set(i % Inputs, weights[i] * 16);
  }
}

}  // namespace

const MaskModel& mask_priors() {
  static const MaskModel priors = [] {
    MaskModel model;
    apply_priors(embedded_priors("mask"), model.models());
    read_weights(embedded_priors("mask_mix"), model.weights());
    return model;
  }();
  return priors;
}

const GuidedMaskModel& guided_mask_priors() {
  static const GuidedMaskModel priors = [] {
    GuidedMaskModel model;
    apply_priors(embedded_priors("predicted_mask"), model.models());
    read_weights(embedded_priors("predicted_mask_mix"), model.weights());
    return model;
  }();
  return priors;
}

}  // namespace curlidar::compact
