// SPDX-License-Identifier: BSD-3-Clause
// Codes one level, 0 to 255, for each record, from those around it and the geometry.
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

/// Adaptive models of levels of up to `bits` bits.
class LevelCoder {
 public:
  /// `records` to be coded: decides how much memory the models take (at most 28 MB).
  LevelCoder(int bits, std::size_t records);

  /// Codes a level (ignored by a decoder) and learns.
  template <class Coder>
  std::int32_t code(Coder& coder, const LevelWindow& window, std::int32_t level) {
    set_contexts(window);
    set_shapes(window);
    std::uint32_t node = 1;
    for (int place = bits_; place-- > 0;) {
      if (place == bits_ - 1 || place == 3) aim(node);
      node = node << 1 | (code_bit(coder, node, place, (level >> place & 1) != 0) ? 1u : 0u);
    }
    const auto found = static_cast<std::int32_t>(node - (1u << bits_));
    for (Shape& shape : shapes_) shape.learn(found);
    return found;
  }

 private:
  static constexpr std::size_t kContexts = 15, kShapes = 3, kInputs = 19, kSets = 3;
  static constexpr std::uint32_t kLimit = 80;
  static constexpr std::int32_t kRate = 10;
  /// Models of up to four bits: those of one context lie together.
  using Line = std::array<BitModel, 16>;

  /// A logistic distribution about a guess, as wide as such guesses were wrong before.
  struct Shape {
    std::int32_t centre16 = 0;
    std::int32_t* error16 = nullptr;  ///< mean, in 1/256 of 1/16 level
    std::int32_t slope = 0;

    void aim(std::int32_t centre, std::int32_t& error) {
      centre16 = centre;
      error16 = &error;
      slope = (256 * 256 * 355) / (error + 64 * 16);
    }
    /// Probability of less than a level, in 1/65536.
    std::int32_t below(std::int32_t level) const {
      const std::int64_t x = (std::int64_t{16 * level - 8 - centre16} * slope) >> 8;
      return static_cast<std::int32_t>(
          squash(static_cast<int>(std::clamp<std::int64_t>(x, -4000, 4000))));
    }
    void learn(std::int32_t level) {
      const std::int32_t miss = std::abs(16 * level - centre16);
      *error16 += (miss * 256 - *error16) >> 6;
    }
    /// Of a one, when levels lie in [low, high) and a one means middle or more.
    std::uint32_t one(std::int32_t low, std::int32_t middle, std::int32_t high) const {
      const std::int32_t a = low == 0 ? 0 : below(low), b = below(middle), c = below(high);
      return static_cast<std::uint32_t>(((std::int64_t{c - b} + 4) << 16) / (c - a + 8));
    }
  };

  void set_contexts(const LevelWindow& window);
  void set_shapes(const LevelWindow& window);
  void aim(std::uint32_t node);

  template <class Coder>
  bool code_bit(Coder& coder, std::uint32_t node, int place, bool bit);

  int bits_;
  int line_bits_;
  std::vector<Line> lines_;  ///< [context][hash]
  std::vector<WeightSet<kInputs>> weights_;
  std::array<std::uint32_t, kContexts> hash_{};
  std::array<BitModel*, kContexts> line_{};
  std::array<std::uint32_t, kSets> set_{};
  std::uint32_t line_root_ = 1;
  std::array<Shape, kShapes> shapes_{};
  std::array<std::array<std::int32_t, 64>, kShapes> errors_{};
};

template <class Coder>
bool LevelCoder::code_bit(Coder& coder, std::uint32_t node, int place, bool bit) {
  // How much evidence counts by how often it was seen, in 1/256.
  static constexpr std::array<std::int32_t, 4> kTrust = {0, 120, 205, 256};
  const std::uint32_t depth =
      static_cast<std::uint32_t>(std::bit_width(node) - std::bit_width(line_root_));
  const std::uint32_t in_line = (1u << depth) | (node & ((1u << depth) - 1));
  std::array<BitModel*, kContexts> models;
  alignas(16) std::array<std::int16_t, kInputs> inputs;
  for (std::size_t k = 0; k < kContexts; ++k) {
    models[k] = line_[k] + in_line;
    const std::int32_t trust = kTrust[std::min<std::size_t>(models[k]->visits, 3)];
    inputs[k] = static_cast<std::int16_t>((stretch(models[k]->probability) * trust) >> 8);
  }
  const std::int32_t low = static_cast<std::int32_t>(node << (place + 1)) - (1 << bits_);
  for (std::size_t k = 0; k < kShapes; ++k) {
    inputs[kContexts + k] = static_cast<std::int16_t>(
        stretch(shapes_[k].one(low, low + (1 << place), low + (2 << place))));
  }
  inputs[kContexts + kShapes] = 128;
  const auto number = static_cast<std::uint32_t>(place);
  const std::array<WeightSet<kInputs>*, kSets> sets = {
      &weights_[set_[0] * 256 + std::min(node, 255u)], &weights_[8 * 256 + set_[1] * 8 + number],
      &weights_[8 * 256 + 1024 * 8 + set_[2] * 8 + number]};
  AveragedMix<kInputs, kSets> mix(inputs, sets);
  bit = coder.code(mix.probability(), bit);
  mix.update(bit, kRate);
  for (BitModel* model : models) model->update(bit, kLimit);
  return bit;
}

}  // namespace curlidar
