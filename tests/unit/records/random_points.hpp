// SPDX-License-Identifier: BSD-3-Clause
// Clouds of every kind that the chunks of points must bring back.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/float32.hpp"
#include "curlidar/cloud.hpp"

namespace curlidar::test {

/// The same numbers everywhere (Steele, Lea, Flood: SplitMix).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }
  /// In [-1, 1).
  double uniform() { return static_cast<double>(static_cast<std::int64_t>(next())) * 0x1p-63; }

 private:
  std::uint64_t state_;
};

inline double of_type(ScalarType type, double value) {
  return type == ScalarType::float32 ? round_to_float32(value) : value;
}
inline Vec3 of_type(ScalarType type, const Vec3& p) {
  return {of_type(type, p.x), of_type(type, p.y), of_type(type, p.z)};
}
inline bool is_of(ScalarType type, const Vec3& p) {
  return of_type(type, p) == p;
}

inline bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    using Bits = std::array<std::uint64_t, 3>;
    if (std::bit_cast<Bits>(a[i]) != std::bit_cast<Bits>(b[i])) return false;
  }
  return true;
}

inline std::vector<Vec3> random_walk(ScalarType type, Vec3 at = {}, double stride = 0.1,
                                     std::size_t count = 400) {
  Random random(1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    at = at + Vec3{random.uniform(), random.uniform(), random.uniform()} * stride;
    points.push_back(of_type(type, at));
  }
  return points;
}

inline std::vector<Vec3> scattered(ScalarType type, double size) {
  Random random(2);
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) {
    points.push_back(
        of_type(type, Vec3{random.uniform(), random.uniform(), random.uniform()} * size));
  }
  return points;
}

/// Of all magnitudes and signs, denormals and both zeros among them.
inline std::vector<Vec3> any_bits(ScalarType type) {
  Random random(3);
  const auto any = [&] {
    for (;;) {
      const double value =
          type == ScalarType::float32
              ? double{std::bit_cast<float>(static_cast<std::uint32_t>(random.next()))}
              : std::bit_cast<double>(random.next());
      if (std::isfinite(value)) return value;
    }
  };
  std::vector<Vec3> points{{0.0, -0.0, 0.0}, {-0.0, -0.0, -0.0}};
  for (int i = 0; i < 200; ++i) points.push_back({any(), any(), any()});
  const double most = type == ScalarType::float32 ? double{std::numeric_limits<float>::max()}
                                                  : std::numeric_limits<double>::max();
  const double least = type == ScalarType::float32
                           ? double{std::numeric_limits<float>::denorm_min()}
                           : std::numeric_limits<double>::denorm_min();
  for (const double x : {most, -most, least, -least}) points.push_back({x, -x, 0});
  return points;
}

inline std::vector<Vec3> denormals(ScalarType type) {
  const double least = type == ScalarType::float32
                           ? double{std::numeric_limits<float>::denorm_min()}
                           : std::numeric_limits<double>::denorm_min();
  std::vector<Vec3> points;
  for (int i = 1; i < 100; ++i) points.push_back({least * i, -least * (i * i), least});
  return points;
}

/// Millimetres, but for a few points and some negative zeros.
inline std::vector<Vec3> millimetres(ScalarType type) {
  Random random(4);
  std::vector<Vec3> points;
  for (int i = 0; i < 600; ++i) {
    const auto any = [&] { return std::floor(random.uniform() * 50000) / 1000; };
    points.push_back(of_type(type, Vec3{any(), any(), any()}));
    if (i % 97 == 5) points.back().y = -0.0;
    if (i % 101 == 5) points.back().z += 0.25e-3;
    points.back() = of_type(type, points.back());
  }
  return points;
}

struct CloudCase {
  const char* name;
  std::vector<Vec3> (*make)(ScalarType type);
};

inline constexpr CloudCase kCloudCases[] = {
    {"None", [](ScalarType) { return std::vector<Vec3>{}; }},
    {"One",
     [](ScalarType type) {
       return random_walk(type, {1, 2, 3}, 1, 1);
     }},
    {"Origins", [](ScalarType) { return std::vector<Vec3>(20); }},
    {"Duplicates",
     [](ScalarType) {
       return std::vector<Vec3>(50, {1.5, -2.25, 1024});
     }},
    {"Walk", [](ScalarType type) { return random_walk(type); }},
    {"Utm",
     [](ScalarType type) {
       return random_walk(type, {431000, 1e7, 300});
     }},
    {"Scattered", [](ScalarType type) { return scattered(type, 100); }},
    {"Enormous", [](ScalarType type) { return scattered(type, 1e30); }},
    {"Tiny", [](ScalarType type) { return scattered(type, 1e-30); }},
    {"AnyBits", any_bits},
    {"Denormals", denormals},
    {"Millimetres", millimetres},
};

}  // namespace curlidar::test
