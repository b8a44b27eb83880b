// SPDX-License-Identifier: BSD-3-Clause
// Values of any type as whole numbers, and exactly back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar {

/// How a value becomes its key.
enum class KeyScale : std::uint8_t {
  whole,   ///< the value itself
  tenths,  ///< value = key / 10, as a double, rounded to the type
  hundredths,
  thousandths,
  ten_thousandths,
  hundred_thousandths,
  millionths,
  of_255,  ///< value = key / 255
  of_65535,
  /// Floats only: the bits of the value as a whole number if its sign is clear, else -1 less the
  /// bits without the sign: keys rise as values do.
  bits,
};
inline constexpr std::uint8_t kKeyScales = 10;

/// The coarsest scale that gives back every one of the values, bit for bit.
KeyScale scale_of(const Column& values);

/// Keys of the values numbered first, first + stride, ... Unsigned 64-bit values count modulo 2^64.
std::vector<std::int64_t> keys_of(const Column& values, KeyScale scale, std::size_t first,
                                  std::size_t stride);
/// Sets value i to that of a key; one beyond the type's range counts modulo 2^bits.
void set_value(Column& values, std::size_t i, KeyScale scale, std::int64_t key);

/// Whether values of a type may have a scale.
bool is_scale_of(KeyScale scale, ScalarType type);

}  // namespace curlidar
