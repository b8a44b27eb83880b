// SPDX-License-Identifier: BSD-3-Clause
#include "records/level_coder.hpp"

namespace curlidar {
namespace {

constexpr std::int32_t kStartWeight = (1 << 20) / 14;
constexpr std::int32_t kStartError = 10 << 12;
constexpr int kFewestTableBits = 4, kMostTableBits = 15;

std::uint32_t scatter(std::uint32_t x) {
  x *= 0x9e3779b1u;
  x ^= x >> 15;
  x *= 0x85ebca6bu;
  return x ^ x >> 13;
}

}  // namespace

LevelCoder::LevelCoder(int bits, std::size_t records)
    : bits_(bits),
      table_bits_(std::clamp(static_cast<int>(std::bit_width(records)) - 1, kFewestTableBits,
                             kMostTableBits)) {
  if (bits == 0) return;
  lines_.resize(kContexts << table_bits_);
  WeightSet<kInputs> start;
  for (std::size_t k = 0; k < kContexts + kShapes; ++k) start.set(k, kStartWeight);
  weights_.assign(kWeightSets[0] + kWeightSets[1] + kWeightSets[2], start);
  for (auto& errors : errors_) errors.fill(kStartError);
}

void LevelCoder::set_contexts(const LevelWindow& window) {
  const auto u = [](std::int32_t value) { return static_cast<std::uint32_t>(value); };
  const std::uint32_t left = u(window.left), above = u(window.above), row = u(window.row);
  const std::uint32_t mean = u(window.mean16) / 16, spread = u(window.spread);
  const std::uint32_t range = u(window.range), shape = u(window.shape);
  const std::uint32_t near_left = u(window.near_left), near_above = u(window.near_above);
  const std::uint32_t gradient =
      u(std::clamp(window.left + window.above - window.above_left, 0, 255));
  const std::array<std::uint32_t, kContexts> contexts = {0,
                                                         left | near_left << 8,
                                                         above | near_above << 8,
                                                         left | u(window.left2) << 8,
                                                         gradient | spread << 8,
                                                         row << 10 | mean / 2,
                                                         row << 10 | range | left / 8 << 6,
                                                         row << 16 | range << 8 | left,
                                                         row << 10 | shape,
                                                         mean / 2 | range << 7 | spread << 13,
                                                         shape | mean / 4 << 10};
  for (std::size_t k = 0; k < kContexts; ++k) hash_[k] = scatter(contexts[k] + 1);
  set_ = {spread, (u(window.misses) * 4 + near_left) * 4 + near_above, range};
  set_shapes(window);
}

void LevelCoder::set_shapes(const LevelWindow& window) {
  const auto of = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::size_t>(8 * a + b);
  };
  shapes_[0].aim(window.mean16, errors_[0][of(window.spread, window.misses)]);
  shapes_[1].aim(16 * window.left, errors_[1][of(window.near_left, window.misses)]);
  shapes_[2].aim(16 * window.above, errors_[2][of(window.near_above, window.spread)]);
  shapes_[3].aim(window.mean16, errors_[3][of(0, window.row & 63)]);
}

void LevelCoder::aim(std::uint32_t node) {
  line_root_ = node;
  for (std::size_t k = 0; k < kContexts; ++k) {
    const std::uint32_t hash = scatter(hash_[k] + node * 0x2545f491u) >> (32 - table_bits_);
    line_[k] = lines_[(k << table_bits_) + hash].data();
  }
}

}  // namespace curlidar
