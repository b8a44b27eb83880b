// SPDX-License-Identifier: BSD-3-Clause
#include "records/keys.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <type_traits>

#include "base/bytes.hpp"

namespace curlidar {
namespace {

constexpr std::array<std::uint32_t, kKeyScales - 1> kDivisors = {1,      10,      100, 1000, 10000,
                                                                 100000, 1000000, 255, 65535};
/// Whole numbers that a double holds with all below them.
constexpr std::int64_t kMostExact = std::int64_t{1} << 53;

/// The double next to key / divisor, of two the even one. In integers, as not every processor
/// divides doubles to that precision.
double quotient(std::int64_t key, std::uint32_t divisor) {
  key = std::clamp(key, -kMostExact, kMostExact);
  if (key == 0) return 0;
  const auto magnitude = static_cast<std::uint64_t>(std::abs(key));
  std::uint64_t whole = magnitude / divisor, rest = magnitude % divisor;
  int exponent = 0;
  while (whole < std::uint64_t{1} << 54) {
    whole = whole << 8 | (rest << 8) / divisor;
    rest = (rest << 8) % divisor;
    exponent -= 8;
  }
  const int extra = static_cast<int>(std::bit_width(whole)) - 53;
  const std::uint64_t half = std::uint64_t{1} << (extra - 1), low = whole & (2 * half - 1);
  whole >>= extra;
  if (low > half || (low == half && (rest != 0 || (whole & 1) != 0))) ++whole;
  const double value = std::ldexp(static_cast<double>(whole), exponent + extra);
  return key < 0 ? -value : value;
}

/// The key of a float at a scale other than bits; nothing if it does not give the value back.
template <class Value>
std::optional<std::int64_t> decimal_key(Value value, std::uint32_t divisor) {
  const double scaled = static_cast<double>(value) * divisor;
  if (!(std::abs(scaled) < static_cast<double>(kMostExact))) return std::nullopt;
  const auto key = static_cast<std::int64_t>(std::round(scaled));
  const auto back = static_cast<Value>(quotient(key, divisor));
  using Bits = UnsignedOfSize<sizeof(Value)>;
  if (std::bit_cast<Bits>(back) != std::bit_cast<Bits>(value)) return std::nullopt;
  return key;
}

template <class Value>
std::int64_t bits_key(Value value) {
  using Bits = UnsignedOfSize<sizeof(Value)>;
  constexpr Bits sign = Bits{1} << (8 * sizeof(Value) - 1);
  const Bits bits = std::bit_cast<Bits>(value);
  const auto magnitude = static_cast<std::int64_t>(bits & ~sign);
  return (bits & sign) != 0 ? -1 - magnitude : magnitude;
}

template <class Value>
Value value_of_bits_key(std::int64_t key) {
  using Bits = UnsignedOfSize<sizeof(Value)>;
  constexpr Bits sign = Bits{1} << (8 * sizeof(Value) - 1);
  const auto magnitude =
      static_cast<Bits>(static_cast<Bits>(key < 0 ? -1 - key : key) & static_cast<Bits>(~sign));
  return std::bit_cast<Value>(key < 0 ? static_cast<Bits>(magnitude | sign) : magnitude);
}

template <class Value>
std::int64_t key_of(Value value, KeyScale scale) {
  if constexpr (std::is_floating_point_v<Value>) {
    if (scale == KeyScale::bits) return bits_key(value);
    return *decimal_key(value, kDivisors[static_cast<std::size_t>(scale)]);
  } else {
    return static_cast<std::int64_t>(value);
  }
}

template <class Value>
Value value_of(std::int64_t key, KeyScale scale) {
  if constexpr (std::is_floating_point_v<Value>) {
    if (scale == KeyScale::bits) return value_of_bits_key<Value>(key);
    return static_cast<Value>(quotient(key, kDivisors[static_cast<std::size_t>(scale)]));
  } else {
    return static_cast<Value>(key);
  }
}

}  // namespace

KeyScale scale_of(const Column& values) {
  return std::visit(
      [](const auto& column) {
        using Value = typename std::decay_t<decltype(column)>::value_type;
        if constexpr (std::is_floating_point_v<Value>) {
          for (std::size_t scale = 0; scale < kDivisors.size(); ++scale) {
            std::size_t i = 0;
            while (i < column.size() && decimal_key(column[i], kDivisors[scale])) ++i;
            if (i == column.size()) return static_cast<KeyScale>(scale);
          }
          return KeyScale::bits;
        } else {
          return KeyScale::whole;
        }
      },
      values);
}

std::vector<std::int64_t> keys_of(const Column& values, KeyScale scale, std::size_t first,
                                  std::size_t stride) {
  std::vector<std::int64_t> keys;
  std::visit(
      [&](const auto& column) {
        keys.reserve(column.size() / stride + 1);
        for (std::size_t i = first; i < column.size(); i += stride) {
          keys.push_back(key_of(column[i], scale));
        }
      },
      values);
  return keys;
}

void set_value(Column& values, std::size_t i, KeyScale scale, std::int64_t key) {
  std::visit(
      [&](auto& column) {
        using Value = typename std::decay_t<decltype(column)>::value_type;
        column[i] = value_of<Value>(key, scale);
      },
      values);
}

bool is_scale_of(KeyScale scale, ScalarType type) {
  const bool is_float = type == ScalarType::float32 || type == ScalarType::float64;
  return scale == KeyScale::whole || (is_float && static_cast<std::uint8_t>(scale) < kKeyScales);
}

}  // namespace curlidar
