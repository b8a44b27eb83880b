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

const MaskModel& mask_priors() {
  static const MaskModel priors = [] {
    MaskModel model;
    apply_priors(embedded_priors("mask"), model.models());
    // Weights are stored in 1/4096 and read in 1/65536; here they count in 1/2^20.
    std::vector<std::int32_t> weights(MaskModel::kWeightSets * kMaskInputs);
    const auto text = embedded_priors("mask_mix");
    if (!text.empty()) apply_weight_priors(text, weights);
    for (std::size_t i = 0; !text.empty() && i < weights.size(); ++i) {
      model.weights()[i / kMaskInputs].set(i % kMaskInputs, weights[i] * 16);
    }
    return model;
  }();
  return priors;
}

}  // namespace curlidar::compact
