// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_models.hpp"

#include <algorithm>
#include <utility>

#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::compact {
namespace {

FieldModels read_priors() {
  FieldModels out = FieldModels::blank();
  apply_priors(embedded_priors("field"), out.models);
  std::vector<std::int32_t> weights;
  for (const auto& mix : out.weights) {
    weights.insert(weights.end(), mix.weight.begin(), mix.weight.end());
  }
  apply_weight_priors(embedded_priors("field_mix"), weights);
  auto from = weights.begin();
  for (auto& mix : out.weights) {
    std::copy_n(from, kFieldInputs, mix.weight.begin());
    from += kFieldInputs;
  }
  return out;
}

}  // namespace

FieldModels FieldModels::blank() {
  return {std::vector<BitModel>(kFieldModels), std::vector<MixWeights<kFieldInputs>>(kFieldMixers)};
}

FieldModels::FieldModels() {
  static const FieldModels trained = read_priors();
  *this = trained;
}

}  // namespace curlidar::compact
