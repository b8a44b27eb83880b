// SPDX-License-Identifier: BSD-3-Clause
// Adaptive codes of whole numbers, the same for encoder and decoder.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "entropy/model.hpp"

namespace curlidar {

/// Numbers of up to 64 bits by their size: how many bits, in unary, then those below the highest;
/// the first two of them are learnt, the others are plain.
class SizeModels {
 public:
  static constexpr std::size_t kMaxBits = 64;

  template <class Coder>
  std::uint64_t code(Coder& coder, std::uint64_t value) {
    const auto wanted = static_cast<std::size_t>(std::bit_width(value));
    std::size_t size = 0;
    while (size < kMaxBits && code_bit(coder, longer_[size], kLimit, wanted > size)) ++size;
    if (size < 2) return size;
    std::uint64_t found = 1;
    for (std::size_t place = size - 1; place-- > 0;) {
      const bool bit = (value >> place & 1) != 0;
      const std::size_t known = size - 1 - place;  // bits found so far
      const bool coded = known == 1   ? code_bit(coder, second_[size], kLimit, bit)
                         : known == 2 ? code_bit(coder, third_[size][found & 1], kLimit, bit)
                                      : coder.code(32768, bit);
      found = found << 1 | (coded ? 1u : 0u);
    }
    return found;
  }

 private:
  static constexpr std::uint32_t kLimit = 60;

  std::array<BitModel, kMaxBits> longer_;
  std::array<BitModel, kMaxBits + 1> second_;
  std::array<std::array<BitModel, 2>, kMaxBits + 1> third_;
};

/// Numbers with a sign: magnitude, then the sign of those that are not 0.
class SignedModels {
 public:
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    const std::uint64_t size = size_.code(coder, value < 0 ? 0 - bits : bits);
    if (size == 0) return 0;
    const bool negative = code_bit(coder, sign_, 60, value < 0);
    return static_cast<std::int64_t>(negative ? 0 - size : size);
  }

 private:
  SizeModels size_;
  BitModel sign_;
};

}  // namespace curlidar
