// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_models.hpp"

#include <algorithm>

#include "entropy/embedded_priors.hpp"
#include "entropy/priors.hpp"

namespace curlidar::tile {
namespace {

TileModels read_priors() {
  TileModels out = TileModels::blank();
  apply_priors(embedded_priors("surface"), out.models);
  std::vector<std::int32_t> weights;
  for (const auto& mix : out.weights) {
    weights.insert(weights.end(), mix.weight.begin(), mix.weight.end());
  }
  apply_weight_priors(embedded_priors("surface_mix"), weights);
  auto from = weights.begin();
  for (auto& mix : out.weights) {
    std::copy_n(from, kTileInputs, mix.weight.begin());
    from += kTileInputs;
  }
  return out;
}

}  // namespace

TileModels TileModels::blank() {
  return {std::vector<BitModel>(kTileModels), std::vector<MixWeights<kTileInputs>>(kTileMixers)};
}

TileModels::TileModels() {
  static const TileModels trained = read_priors();
  *this = trained;
}

}  // namespace curlidar::tile
