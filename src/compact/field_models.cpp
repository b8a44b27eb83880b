// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_models.hpp"

#include <algorithm>
#include <utility>

#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::compact {
namespace {

template <std::size_t Inputs>
void read_weights(std::string_view text, std::vector<MixWeights<Inputs>>& mixes) {
  std::vector<std::int32_t> weights;
  for (const auto& mix : mixes) {
    weights.insert(weights.end(), mix.weight.begin(), mix.weight.end());
  }
  apply_weight_priors(text, weights);
  auto from = weights.begin();
  for (auto& mix : mixes) {
    std::copy_n(from, Inputs, mix.weight.begin());
    from += Inputs;
  }
}

FieldModels read_priors(bool guided) {
  FieldModels out = FieldModels::blank(guided);
  apply_priors(embedded_priors(guided ? "predicted_field" : "field"), out.models);
  if (guided) {
    read_weights(embedded_priors("predicted_field_mix"), out.guided_weights);
  } else {
    read_weights(embedded_priors("field_mix"), out.weights);
  }
  return out;
}

}  // namespace

FieldModels FieldModels::blank(bool guided) {
  if (guided) {
    return {std::vector<BitModel>(kGuidedLayout.models),
            {},
            std::vector<MixWeights<kGuidedInputs>>(kGuidedLayout.mixers)};
  }
  return {
      std::vector<BitModel>(kFieldModels), std::vector<MixWeights<kFieldInputs>>(kFieldMixers), {}};
}

FieldModels::FieldModels(bool guided) {
  static const FieldModels trained = read_priors(false), predicted = read_priors(true);
  *this = guided ? predicted : trained;
}

}  // namespace curlidar::compact
