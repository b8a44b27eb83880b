// SPDX-License-Identifier: BSD-3-Clause
// Random clouds, bit-exact comparison and bytes for tests of file formats.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar::test {

/// splitmix64: the same numbers everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t below(std::uint64_t count) { return next() % count; }

 private:
  std::uint64_t state_;
};

inline constexpr std::array<ScalarType, 10> kAllTypes{
    ScalarType::int8,    ScalarType::uint8,  ScalarType::int16, ScalarType::uint16,
    ScalarType::int32,   ScalarType::uint32, ScalarType::int64, ScalarType::uint64,
    ScalarType::float32, ScalarType::float64};

/// Any bits, so all of a type's special values come up; every NaN is the usual quiet one, the only
/// one that text can hold.
template <class T>
T random_value(Random& random) {
  const std::uint64_t bits = random.next();
  T value;
  std::memcpy(&value, &bits, sizeof value);
  if constexpr (std::is_floating_point_v<T>) {
    switch (random.below(16)) {
      case 0:
        value = std::numeric_limits<T>::infinity();
        break;
      case 1:
        value = -T{0};
        break;
      case 2:
        value = std::numeric_limits<T>::quiet_NaN();
        break;
      case 3:
        value = std::numeric_limits<T>::denorm_min();
        break;
      default:
        break;
    }
    if (std::isnan(value)) value = std::numeric_limits<T>::quiet_NaN();
  }
  return value;
}

inline Attribute random_attribute(Random& random, std::string name, ScalarType type,
                                  std::uint32_t components, std::size_t points) {
  Attribute out{std::move(name), components, make_column(type, points * components)};
  std::visit(
      [&](auto& values) {
        for (auto& value : values) value = random_value<std::decay_t<decltype(value)>>(random);
      },
      out.values);
  return out;
}

/// Unorganised, without attributes; coordinates of the type, NaN and infinities among them.
inline Cloud random_positions(Random& random, std::size_t points, ScalarType type) {
  Cloud cloud;
  cloud.position_type = type;
  cloud.width = static_cast<std::uint32_t>(points);
  cloud.positions.resize(points);
  for (Vec3& p : cloud.positions) {
    for (double* v : {&p.x, &p.y, &p.z}) {
      *v = type == ScalarType::float32 ? static_cast<double>(random_value<float>(random))
                                       : random_value<double>(random);
    }
  }
  return cloud;
}

inline void expect_same_bits(const Column& a, const Column& b, const std::string& what) {
  ASSERT_EQ(to_string(type_of(a)), std::string(to_string(type_of(b)))) << what;
  ASSERT_EQ(size_of(a), size_of(b)) << what;
  std::visit(
      [&](const auto& x) {
        const auto& y = std::get<std::decay_t<decltype(x)>>(b);
        EXPECT_EQ(x.empty() ? 0 : std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])), 0)
            << what;
      },
      a);
}

/// Equal in every bit: positions, layout, attributes in order, metadata.
inline void expect_same_cloud(const Cloud& a, const Cloud& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.position_type, b.position_type);
  EXPECT_EQ(a.metadata, b.metadata);
  EXPECT_EQ(a.positions.empty()
                ? 0
                : std::memcmp(a.positions.data(), b.positions.data(), a.size() * sizeof(Vec3)),
            0);
  ASSERT_EQ(a.attributes.size(), b.attributes.size());
  for (std::size_t i = 0; i < a.attributes.size(); ++i) {
    EXPECT_EQ(a.attributes[i].name, b.attributes[i].name);
    EXPECT_EQ(a.attributes[i].components, b.attributes[i].components);
    expect_same_bits(a.attributes[i].values, b.attributes[i].values, a.attributes[i].name);
  }
}

inline std::vector<std::byte> to_bytes(std::string_view text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

/// Appends the value's bytes, little or big endian.
template <class T>
void put(std::vector<std::byte>& out, T value, bool big_endian = false) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  const bool reverse = big_endian == (std::endian::native == std::endian::little);
  for (std::size_t i = 0; i < sizeof(T); ++i) out.push_back(bytes[reverse ? sizeof(T) - 1 - i : i]);
}

}  // namespace curlidar::test
