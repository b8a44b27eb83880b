// SPDX-License-Identifier: BSD-3-Clause
// Finds the state in which a model should start, from what it saw in training scans.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "entropy/model.hpp"

namespace curlidar::training {

/// Zeros and ones that each model of a table was shown while one scan was coded.
using BitCounts = std::vector<std::array<std::uint32_t, 2>>;

/// A coder for training: codes nothing, counts cost and, for each model, bits.
class CountingCoder {
 public:
  static constexpr bool kDecodes = false;

  explicit CountingCoder(std::span<const BitModel> table)
      : table_(table), counts_(table.size(), {0, 0}) {}

  bool code(std::uint32_t probability_of_one, bool bit) {
    bits_ -= std::log2((bit ? probability_of_one : 65536 - probability_of_one) / 65536.0);
    return bit;
  }
  void observe(const BitModel& model, bool bit) { ++counts_[&model - table_.data()][bit ? 1 : 0]; }

  double bits() const { return bits_; }
  const BitCounts& counts() const { return counts_; }

 private:
  double bits_ = 0;
  std::span<const BitModel> table_;
  BitCounts counts_;
};

/// A model's first state, as priors.hpp reads it.
struct FirstState {
  std::int8_t stretched = 0;  ///< in 24/256
  std::uint8_t visits = 0;
};

/// What one scan showed one model, and how much the scan counts.
struct Observation {
  double zeros, ones, weight;
};

/// The start that makes the observations cheapest: a scan with n0 zeros and n1 ones costs an
/// adaptive model that starts from Beta(a, b) the beta-binomial -log2 B(a + n1, b + n0) / B(a, b),
/// and BitModel with `visits` v behaves as a + b = v + 1/2. Costs are added to hold back confidence
/// that rests on few scans. Nothing observed gives FirstState{}.
FirstState fit_first_state(std::span<const Observation> observations);

/// fit_first_state for every model; `counts[s]` belongs to `weights[s]`, 0 leaves the scan out.
std::vector<FirstState> fit_first_states(std::span<const BitCounts> counts,
                                         std::span<const double> weights);

void apply_states(std::span<const FirstState> states, std::span<BitModel> models);

/// Texts for apply_priors() and apply_weight_priors(); `weights` in 1/4096.
std::string format_states(std::span<const FirstState> states, const std::string& comment);
std::string format_weights(std::span<const std::int32_t> weights, const std::string& comment);
/// False if the file cannot be written.
bool write_text(const std::string& path, const std::string& text);

}  // namespace curlidar::training
