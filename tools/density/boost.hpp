// SPDX-License-Identifier: BSD-3-Clause
// Gradient boosting of oblivious trees on histograms.
#pragma once

#include <cstddef>
#include <vector>

#include "dense/trees.hpp"

namespace curlidar::density {

/// What trees are taught: feature by feature, sample by sample.
struct Samples {
  std::vector<std::vector<float>> values;  ///< values[feature][sample]
  std::vector<float> wanted, weight;       ///< of each sample

  std::size_t size() const { return wanted.size(); }
  /// Those of another, which has the same features.
  void add(const Samples& other);
};

enum class Loss {
  logistic,  ///< wanted 0 or 1; trees tell log odds
  absolute,  ///< trees tell the median of what is wanted
};

struct BoostSettings {
  Loss loss = Loss::logistic;
  std::size_t trees = 60;
  std::size_t depth = 6;
  std::size_t levels = 64;  ///< of each feature, 2 .. 256
  double rate = .25;        ///< share of each tree's step that is taken
  double damping = 20;      ///< weight that a leaf must outweigh
};

/// Trees fitted to the samples. Deterministic, whatever the threads. There must be a sample of
/// weight above 0; for Loss::logistic of either kind.
ObliviousTrees boost(const Samples& samples, const BoostSettings& settings,
                     std::size_t threads = 1);

}  // namespace curlidar::density
