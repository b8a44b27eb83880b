// SPDX-License-Identifier: BSD-3-Clause
// Codes one level, 0 to 255, for each record: bit by bit, highest first, each from a mix of
// adaptive contexts and of logistic distributions about guesses.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "entropy/averaged_mix.hpp"
#include "entropy/model.hpp"
#include "records/level_window.hpp"

namespace curlidar {

/// A logistic distribution about a guess, as wide as such guesses were wrong before.
class LevelShape {
 public:
  /// `error`: the mean error of such guesses, in 1/4096 level; moves with learn().
  void aim(std::int32_t guess16, std::int32_t& error) {
    guess16_ = guess16;
    error_ = &error;
    slope_ = kSlope / (error + kLeastError);
  }
  /// Probability, in 1/65536, of middle or more among the levels in [low, high).
  std::uint32_t upper(std::int32_t low, std::int32_t middle, std::int32_t high) const {
    const std::uint32_t a = low == 0 ? 0 : below(low), b = below(middle), c = below(high);
    return (((c - b + 4) << 15) / (c - a + 8)) << 1;
  }
  void learn(std::int32_t level) {
    const std::int32_t error = std::abs(16 * level - guess16_) * 256;
    *error_ += (error - *error_) >> 6;
  }

 private:
  // A mean error e goes with a scale of e / 1.386; 355 / 256 is 1.386.
  static constexpr std::int32_t kSlope = 256 * 256 * 355, kLeastError = 1024;

  /// Probability of less than a level, in 1/65536.
  std::uint32_t below(std::int32_t level) const {
    const std::int64_t x = (std::int64_t{16 * level - 8 - guess16_} * slope_) >> 8;
    return squash(static_cast<int>(std::clamp<std::int64_t>(x, -kStretchLimit, kStretchLimit)));
  }

  std::int32_t guess16_ = 0;
  std::int32_t* error_ = nullptr;
  std::int32_t slope_ = 0;
};

/// Adaptive models of levels of up to `bits` bits (at most 8).
class LevelCoder {
 public:
  /// `records` to be coded: decides how much memory the models take (23 MB at most).
  LevelCoder(int bits, std::size_t records);

  /// Codes a level (ignored by a decoder) and learns.
  template <class Coder>
  std::int32_t code(Coder& coder, const LevelWindow& window, std::int32_t level) {
    set_contexts(window);
    std::uint32_t node = 1;
    for (int place = bits_; place-- > 0;) {
      if (place == bits_ - 1 || place == kLineBits - 1) aim(node);
      node = node << 1 | (code_bit(coder, node, place, (level >> place & 1) != 0) ? 1u : 0u);
    }
    const auto found = static_cast<std::int32_t>(node - (1u << bits_));
    for (LevelShape& shape : shapes_) shape.learn(found);
    return found;
  }

 private:
  static constexpr std::size_t kContexts = 11, kShapes = 4, kInputs = kContexts + kShapes + 1;
  static constexpr std::size_t kSets = 3;
  static constexpr std::uint32_t kLimit = 60;
  static constexpr std::int32_t kRate = 12;
  static constexpr std::int16_t kConstant = 128;
  /// How much a model counts by how often it learnt, in 1/256.
  static constexpr std::array<std::int32_t, 4> kTrust = {0, 120, 205, 256};
  /// Sets of weights: of spread and node; of misses and distances; of the range.
  static constexpr std::array<std::size_t, kSets> kWeightSets = {8 * 256, 128 * 8, 64 * 8};

  /// Models of the nodes of four bits; those of one context lie together.
  static constexpr int kLineBits = 4;
  using Line = std::array<BitModel, 1 << kLineBits>;

  void set_contexts(const LevelWindow& window);
  void set_shapes(const LevelWindow& window);
  void aim(std::uint32_t node);

  template <class Coder>
  bool code_bit(Coder& coder, std::uint32_t node, int place, bool bit);

  int bits_;
  int table_bits_;           ///< log2 of the lines of a context
  std::vector<Line> lines_;  ///< [context][hash]
  std::vector<WeightSet<kInputs>> weights_;
  std::array<std::array<std::int32_t, 64>, kShapes> errors_{};

  std::array<std::uint32_t, kContexts> hash_{};
  std::array<BitModel*, kContexts> line_{};
  std::uint32_t line_root_ = 1;  ///< the node that the lines begin with
  std::array<std::size_t, kSets> set_{};
  std::array<LevelShape, kShapes> shapes_{};
};

template <class Coder>
bool LevelCoder::code_bit(Coder& coder, std::uint32_t node, int place, bool bit) {
  const auto depth = static_cast<int>(std::bit_width(node) - std::bit_width(line_root_));
  const std::uint32_t in_line = 1u << depth | (node & ((1u << depth) - 1));
  std::array<BitModel*, kContexts> models;
  alignas(16) std::array<std::int16_t, kInputs> inputs;
  for (std::size_t k = 0; k < kContexts; ++k) {
    models[k] = line_[k] + in_line;
    const std::int32_t trust = kTrust[std::min<std::size_t>(models[k]->visits, 3)];
    inputs[k] = static_cast<std::int16_t>((stretch(models[k]->probability) * trust) >> 8);
  }
  const std::int32_t low = static_cast<std::int32_t>(node << (place + 1)) - (1 << bits_);
  for (std::size_t k = 0; k < kShapes; ++k) {
    const std::uint32_t upper = shapes_[k].upper(low, low + (1 << place), low + (2 << place));
    inputs[kContexts + k] = static_cast<std::int16_t>(stretch(upper));
  }
  inputs[kInputs - 1] = kConstant;

  const auto at = static_cast<std::size_t>(place);
  const std::array<WeightSet<kInputs>*, kSets> sets = {
      &weights_[set_[0] * 256 + node], &weights_[kWeightSets[0] + set_[1] * 8 + at],
      &weights_[kWeightSets[0] + kWeightSets[1] + set_[2] * 8 + at]};
  AveragedMix<kInputs, kSets> mix(inputs, sets);
  bit = coder.code(mix.probability(), bit);
  mix.update(bit, kRate);
  for (BitModel* model : models) model->update(bit, kLimit);
  return bit;
}

}  // namespace curlidar
