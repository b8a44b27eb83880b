// SPDX-License-Identifier: BSD-3-Clause
// Small clouds of every kind that a file with every return must give back: scans on rays, on rings
// and on nothing, and what drivers, maps and mishaps put in them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/float32.hpp"
#include "support/clouds.hpp"
#include "support/scans.hpp"

namespace curlidar::test {

struct NamedCloud {
  std::string name;
  Cloud cloud;
  std::optional<SensorProfile> sensor{};
};

inline double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random.next() >> 11) * 0x1p-53;
}

inline Cloud cloud_of(std::vector<Vec3> points, ScalarType type = ScalarType::float32) {
  Cloud cloud;
  cloud.position_type = type;
  cloud.width = static_cast<std::uint32_t>(points.size());
  if (type == ScalarType::float32) {
    for (Vec3& p : points) {
      p = {round_to_float32(p.x), round_to_float32(p.y), round_to_float32(p.z)};
    }
  }
  cloud.positions = std::move(points);
  return cloud;
}

/// A sensor with encoder positions: scans of it lie on its rays.
inline SensorProfile exact_sensor(std::size_t rings = 8, std::uint32_t slots = 180) {
  SensorProfile sensor = small_sensor(rings, slots);
  sensor.slots = slots;
  sensor.range_unit_m = 0.002;
  return sensor;
}

inline Cloud exact_scan(const SensorProfile& sensor) {
  SimulateSettings settings;
  settings.range_unit_m = sensor.range_unit_m;
  return simulate(**make_scene("street"), sensor, settings).value();
}

/// A scan whose points lie beside the middles of even columns.
inline Cloud unsteady_scan(std::size_t rings = 8, std::uint32_t columns = 180) {
  Cloud cloud = small_scan("street", small_sensor(rings, columns));
  Random random(5);
  for (Vec3& p : cloud.positions) {
    const double a = uniform(random, -0.015, 0.015);
    p = {p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
    p = {round_to_float32(p.x), round_to_float32(p.y), round_to_float32(p.z)};
  }
  return cloud;
}

inline Cloud shuffled(const Cloud& cloud, std::uint64_t seed = 3) {
  Random random(seed);
  std::vector<std::uint32_t> order(cloud.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  Cloud out = select(cloud, order);
  out.position_type = cloud.position_type;
  return out;
}

/// The cloud and then those of its points that `moved` gives back, with an attribute `return`.
template <class Function>
Cloud with_second_returns(const Cloud& cloud, const Function& moved) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) slots.push_back(i);
  std::vector<std::uint8_t> number(cloud.size(), 0);
  std::vector<Vec3> added;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const Vec3 p = moved(i, cloud.positions[i]);
    if (!is_return(p)) continue;
    slots.push_back(i);
    number.push_back(1);
    added.push_back(p);
  }
  Cloud out = select(cloud, slots);
  out.position_type = cloud.position_type;
  const std::size_t first = cloud.size();
  for (std::size_t i = 0; i < added.size(); ++i) {
    out.positions[first + i] = {round_to_float32(added[i].x), round_to_float32(added[i].y),
                                round_to_float32(added[i].z)};
  }
  out.attributes.push_back({"return", 1, std::move(number)});
  return out;
}

/// Every n-th slot becomes `value`.
inline Cloud with_holes(Cloud cloud, std::size_t n, const Vec3& value) {
  for (std::size_t i = n / 2; i < cloud.size(); i += n) cloud.positions[i] = value;
  return cloud;
}

/// Rings x columns, NaN where there is no return; rows turned against each other.
inline Cloud organised_scan(std::size_t rings = 8, std::uint32_t columns = 128) {
  const Cloud points = small_scan("room", small_sensor(rings, columns));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Cloud cloud;
  cloud.width = columns;
  cloud.height = static_cast<std::uint32_t>(rings);
  cloud.positions.assign(rings * columns, {nan, nan, nan});
  const auto& ring = std::get<std::vector<std::uint16_t>>(points.find("ring")->values);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double azimuth = std::atan2(points.positions[i].y, points.positions[i].x);
    const auto column = static_cast<std::uint32_t>(
        std::lround((azimuth / std::numbers::pi + 1) * columns / 2) + 3 * ring[i] + columns);
    cloud.positions[ring[i] * columns + column % columns] = points.positions[i];
  }
  return cloud;
}

/// Attributes of all ten types, one of them of three components, floats with any bits.
inline void add_all_types(Cloud& cloud) {
  Random random(9);
  for (const ScalarType type : kAllTypes) {
    const std::uint32_t components = type == ScalarType::int16 ? 3 : 1;
    Attribute attribute = random_attribute(random, to_string(type), type, components, cloud.size());
    std::visit(
        [&](auto& values) {
          using Value = std::decay_t<decltype(values[0])>;
          for (Value& value : values) {
            if (std::is_floating_point_v<Value> && random.below(4) == 0) {
              // A NaN with a payload and either sign.
              using Bits = std::conditional_t<sizeof(Value) == 4, std::uint32_t, std::uint64_t>;
              if constexpr (std::is_floating_point_v<Value>) {
                constexpr Bits kQuiet = sizeof(Value) == 4 ? static_cast<Bits>(0x7fc00000u)
                                                           : static_cast<Bits>(0x7ff8000000000000u);
                value = std::bit_cast<Value>(static_cast<Bits>(kQuiet | random.below(1000) |
                                                               static_cast<Bits>(random.below(2))
                                                                   << (8 * sizeof(Value) - 1)));
              }
            }
          }
        },
        attribute.values);
    cloud.attributes.push_back(std::move(attribute));
  }
}

template <class Function>
Cloud points_by(std::size_t count, ScalarType type, const Function& at) {
  Random random(17);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(at(i, random));
  return cloud_of(std::move(points), type);
}

inline Cloud moved(Cloud cloud, const Vec3& by, ScalarType type) {
  for (Vec3& p : cloud.positions) p = p + by;
  cloud.position_type = type;
  if (type == ScalarType::float32) {
    cloud.positions = cloud_of(std::move(cloud.positions)).positions;
  }
  return cloud;
}

inline std::vector<NamedCloud> scans_on_rays() {
  const SensorProfile sensor = exact_sensor();
  const Cloud scan = exact_scan(sensor);
  std::vector<NamedCloud> out;
  out.push_back({"rays", scan, sensor});
  out.push_back({"rays_shuffled", shuffled(scan), sensor});
  out.push_back(
      {"rays_two_returns",
       with_second_returns(
           scan, [](std::size_t i, const Vec3& p) { return i % 5 == 0 ? p * 1.25 : Vec3{}; }),
       sensor});
  out.push_back({"rays_over_a_turn",
                 with_second_returns(scan,
                                     [](std::size_t, const Vec3& p) {
                                       return std::abs(std::atan2(p.y, p.x)) > 3 ? p * 1.001
                                                                                 : Vec3{};
                                     }),
                 sensor});
  out.push_back({"rays_with_zeros", with_holes(scan, 6, {0, 0, 0}), sensor});
  Cloud doubles = scan;
  doubles.position_type = ScalarType::float64;
  for (Vec3& p : doubles.positions) p = p * (1 + 1e-7 / 3);
  out.push_back({"rays_float64", doubles, sensor});
  return out;
}

inline std::vector<NamedCloud> scans_on_rings() {
  const Cloud scan = unsteady_scan();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<NamedCloud> out;
  out.push_back({"rings", scan});
  out.push_back({"rings_shuffled", shuffled(scan)});
  out.push_back({"rings_nan", with_holes(scan, 7, {nan, nan, nan})});
  out.push_back({"rings_duplicates", with_second_returns(scan, [](std::size_t i, const Vec3& p) {
                   return i % 9 == 0 ? p : Vec3{};
                 })});
  out.push_back({"rings_far", with_second_returns(scan, [](std::size_t i, const Vec3& p) {
                   return i % 11 == 0 ? p * (2500 / norm(p)) : Vec3{};
                 })});
  out.push_back({"organised", organised_scan()});
  out.push_back({"one_ring", small_scan("room", small_sensor(1, 200))});
  return out;
}

inline std::vector<NamedCloud> odd_clouds() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<NamedCloud> out;
  out.push_back({"empty", cloud_of({})});
  out.push_back({"one_point", cloud_of({{3, -4, 0.5}})});
  out.push_back({"one_point_float64", cloud_of({{1e-3 / 7, 0, 0}}, ScalarType::float64)});
  out.push_back({"two_points", cloud_of({{3, -4, 0.5}, {-3, 4, -0.5}})});
  out.push_back({"all_nan", cloud_of(std::vector<Vec3>(20, {nan, nan, nan}))});
  out.push_back({"nan_and_zeros",
                 with_holes(cloud_of(std::vector<Vec3>(50, {nan, nan, nan})), 3, {0, 0, 0})});
  out.push_back({"same_point", cloud_of(std::vector<Vec3>(40, {1.5, 2.25, -0.125}))});
  out.push_back(
      {"signs_of_zero",
       cloud_of({{-0.0, 1, -0.0}, {0, -0.0, 0}, {-0.0, -0.0, -0.0}, {5, -0.0, 0}, {0, 0, 0}})});
  out.push_back(
      {"infinities", cloud_of({{inf, 0, 0}, {1, -inf, nan}, {2, 3, 4}, {nan, 1, 2}, {0, 0, nan}})});
  out.push_back({"z_axis", points_by(60, ScalarType::float32, [](std::size_t i, Random&) {
                   return Vec3{0, 0, static_cast<double>(i) - 30};
                 })});
  out.push_back({"denormals", cloud_of({{1e-44, 0, 0}, {-1e-45, 3e-42, 0}, {0, 0, 1e-40}})});
  out.push_back(
      {"denormals_float64", cloud_of({{5e-324, 0, 0}, {0, -1e-310, 3e-320}}, ScalarType::float64)});
  return out;
}

inline std::vector<NamedCloud> clouds_without_rings() {
  const auto box = [](std::size_t, Random& random) {
    return Vec3{uniform(random, -40, 40), uniform(random, -40, 40), uniform(random, -3, 8)};
  };
  const auto plane = [](std::size_t i, Random& random) {
    return Vec3{static_cast<double>(i % 30) * 0.1, 10 + static_cast<double>(i / 30) * 0.1,
                uniform(random, 0, 0.002)};
  };
  const auto rosette = [](std::size_t i, Random& random) {
    const double t = 0.013 * static_cast<double>(i);
    const double radius = 0.3 * std::cos(3.7 * t);
    const double range = 12 + 4 * std::sin(t) + uniform(random, -0.01, 0.01);
    return Vec3{range, range * radius * std::cos(t), range * radius * std::sin(t)};
  };
  const auto far = [](std::size_t, Random& random) {
    return Vec3{uniform(random, -9000, 9000), uniform(random, -9000, 9000),
                uniform(random, 2000, 3000)};
  };
  const auto wild = [](std::size_t, Random& random) {
    return Vec3{std::ldexp(uniform(random, -1, 1), static_cast<int>(random.below(200)) - 100), 1,
                std::ldexp(uniform(random, -1, 1), static_cast<int>(random.below(200)) - 100)};
  };
  Random random(21);
  std::vector<NamedCloud> out;
  const Cloud random_box = points_by(500, ScalarType::float32, box);
  out.push_back({"random", random_box});
  out.push_back({"random_float64", points_by(300, ScalarType::float64, box)});
  out.push_back({"plane", points_by(600, ScalarType::float32, plane)});
  out.push_back({"rosette", points_by(800, ScalarType::float32, rosette)});
  out.push_back({"far", points_by(300, ScalarType::float32, far)});
  out.push_back({"wild", points_by(200, ScalarType::float32, wild)});
  out.push_back({"wild_float64", points_by(200, ScalarType::float64, wild)});
  const Vec3 utm{452837.25, 5411932.5, 117.125};
  out.push_back({"utm_float64", moved(random_box, utm, ScalarType::float64)});
  out.push_back({"utm_float32", moved(random_box, utm, ScalarType::float32)});
  out.push_back({"far_away", moved(random_box, {1e7, -1e7, 1e7}, ScalarType::float64)});
  out.push_back({"scan_in_a_map", moved(unsteady_scan(), utm, ScalarType::float64)});
  out.push_back({"any_bits_float32", random_positions(random, 150, ScalarType::float32)});
  out.push_back({"any_bits_float64", random_positions(random, 150, ScalarType::float64)});
  return out;
}

inline std::vector<NamedCloud> clouds_with_attributes() {
  NamedCloud typed{"attributes", unsteady_scan(6, 120)};
  typed.cloud.attributes.clear();
  add_all_types(typed.cloud);
  return {std::move(typed)};
}

/// All of the above.
struct CloudGroup {
  const char* name;
  std::vector<NamedCloud> (*clouds)();
};
inline constexpr std::array<CloudGroup, 5> kPromisedClouds{
    {{"scans_on_rays", scans_on_rays},
     {"scans_on_rings", scans_on_rings},
     {"odd_clouds", odd_clouds},
     {"clouds_without_rings", clouds_without_rings},
     {"clouds_with_attributes", clouds_with_attributes}}};

}  // namespace curlidar::test
