// SPDX-License-Identifier: BSD-3-Clause
// Whole numbers in bits: for the small tables of a scan.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "entropy/model.hpp"

namespace curlidar::compact {

/// A number of up to 32 bits and its sign: zero flag, sign, class of the magnitude less one, its
/// bits from the top.
class NumberModels {
 public:
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t value) {
    const bool zero = code_bit(coder, zero_[last_zero_], kLimit, value == 0);
    last_zero_ = zero ? 1 : 0;
    if (zero) return 0;
    const bool negative = code_bit(coder, sign_, kLimit, value < 0);
    const auto target = static_cast<std::uint64_t>(std::abs(value)) - (value != 0);
    const auto target_size = static_cast<std::size_t>(std::bit_width(target));
    std::size_t size = 0;
    while (size + 1 < kClasses && code_bit(coder, size_[size], kLimit, target_size > size)) ++size;
    std::uint64_t magnitude = size > 0 ? 1 : 0;
    for (std::size_t place = size > 0 ? size - 1 : 0; place-- > 0;) {
      const bool bit = (target >> place & 1) != 0;
      const bool coded =
          place + 2 == size ? code_bit(coder, top_[size], kLimit, bit) : coder.code(32768, bit);
      magnitude = magnitude << 1 | (coded ? 1 : 0);
    }
    const auto found = static_cast<std::int64_t>(magnitude + 1);
    return negative ? -found : found;
  }

 private:
  static constexpr std::uint32_t kLimit = 30;
  static constexpr std::uint32_t kClasses = 33;

  std::array<BitModel, 2> zero_;
  BitModel sign_;
  std::array<BitModel, kClasses> size_, top_;
  std::size_t last_zero_ = 0;
};

}  // namespace curlidar::compact
