// SPDX-License-Identifier: BSD-3-Clause
#include "records/keys.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <type_traits>

#include "base/bytes.hpp"

namespace curlidar {
namespace {

constexpr std::array<double, kKeyScales - 1> kDivisors = {1,   10,  100,  1e3,   1e4,
                                                          1e5, 1e6, 255., 65535.};
/// Whole numbers that a double holds with all below them.
constexpr double kMostExact = 9007199254740992.;

/// The key of a float at a scale other than bits; nothing if it does not give the value back.
template <class Value>
std::optional<std::int64_t> decimal_key(Value value, double divisor) {
  const double scaled = static_cast<double>(value) * divisor;
  if (!(std::abs(scaled) < kMostExact)) return std::nullopt;
  const double key = std::round(scaled);
  const auto back = static_cast<Value>(key / divisor);
  using Bits = UnsignedOfSize<sizeof(Value)>;
  // A zero of either sign has key 0, which is the positive one.
  if (std::bit_cast<Bits>(back + Value{0}) != std::bit_cast<Bits>(value)) return std::nullopt;
  return static_cast<std::int64_t>(key);
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
    return static_cast<Value>(static_cast<double>(key) /
                              kDivisors[static_cast<std::size_t>(scale)]);
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
