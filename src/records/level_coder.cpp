// SPDX-License-Identifier: BSD-3-Clause
#include "records/level_coder.hpp"

#include <bit>
#include <cstdlib>

namespace curlidar {
namespace {

constexpr std::int32_t kStartWeight = (1 << 20) / 14;

std::uint32_t scatter(std::uint32_t x) {
  x *= 0x9e3779b1u;
  x ^= x >> 15;
  x *= 0x85ebca6bu;
  return x ^ x >> 13;
}

}  // namespace

LevelCoder::LevelCoder(int bits, std::size_t records)
    : bits_(bits), line_bits_(std::clamp(static_cast<int>(std::bit_width(records)) - 1, 4, 15)) {
  lines_.resize(kContexts << line_bits_);
  WeightSet<kInputs> start;
  for (std::size_t k = 0; k < kContexts; ++k) start.set(k, kStartWeight);
  for (std::size_t k = kContexts; k < kContexts + kShapes; ++k) start.set(k, kStartWeight);
  for (auto& errors : errors_) errors.fill(256 * 16 * 10);
  weights_.assign(8 * 256 + 1024 * 8 + 64 * 8, start);
}

void LevelCoder::set_contexts(const LevelWindow& w) {
  const auto u = [](std::int32_t value) { return static_cast<std::uint32_t>(value); };
  const std::uint32_t mean = u(w.mean16) >> 4, half = mean >> 1;
  const std::uint32_t spread = u(w.spread), misses = u(w.misses);
  const std::uint32_t left = u(w.left), above = u(w.above), near_left = u(w.near_left),
                      near_above = u(w.near_above), row = u(w.row), range = u(w.range);
  const std::uint32_t gradient = u(std::clamp(w.left + w.above - w.above_left, 0, 255));
  const std::uint32_t apart = u(std::min(std::abs(w.left - w.above), 15));
  const std::array<std::uint32_t, kContexts> contexts = {
      left | near_left << 8,
      above | near_above << 8,
      left | above << 8,
      mean | spread << 8,
      row | half << 10,
      range | half << 6 | spread << 14,
      left | u(w.left2) << 8,
      gradient | spread << 8,
      (left + above + 1) / 2 | apart << 8 | misses << 12,
      mean | misses << 8,
      left / 2 | above / 2 << 7 | u(w.above_right) / 2 << 14 | u(w.above_left) / 4 << 21,
      row | range << 10 | left / 8 << 16,
      near_left | near_above << 2 | spread << 4 | half << 8,
      left / 4 | above / 4 << 6 | range << 12 | row / 4 << 18,
      u(w.shape) | mean / 4 << 10};
  for (std::size_t k = 0; k < kContexts; ++k) hash_[k] = scatter(contexts[k] + 1);
  set_ = {spread, (misses * 4 + near_left) * 4 + near_above, range};
}

void LevelCoder::set_shapes(const LevelWindow& w) {
  const auto pick = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::size_t>(a * 8 + b);
  };
  shapes_[0].aim(w.mean16, errors_[0][pick(w.spread, w.misses)]);
  shapes_[1].aim(16 * w.left, errors_[1][pick(w.near_left, w.misses)]);
  shapes_[2].aim(16 * w.above, errors_[2][pick(w.near_above, w.spread)]);
}

void LevelCoder::aim(std::uint32_t node) {
  line_root_ = node;
  for (std::size_t k = 0; k < kContexts; ++k) {
    const std::uint32_t hash = scatter(hash_[k] + node * 0x2545f491u) >> (32 - line_bits_);
    line_[k] = lines_[(k << line_bits_) + hash].data();
  }
}

}  // namespace curlidar
