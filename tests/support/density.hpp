// SPDX-License-Identifier: BSD-3-Clause
// Density profiles of a small world, and what fields promise whatever a profile says.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "curlidar/dense.hpp"
#include "dense/density_profile.hpp"
#include "unit/dense/ring_field.hpp"

namespace curlidar::test {

/// Rings at 4, 0 and -4 degrees in a round tower that is open to one side; they measure `offset_m`
/// too far.
inline std::shared_ptr<const Field> tower_field(double offset_m = 0) {
  constexpr double kDegree = std::numbers::pi / 180, kWall_m = 10;
  const World tower = [](const Vec3&, const Vec3& direction) {
    const double flat = std::hypot(direction.x, direction.y);
    return direction.x < -0.9 * flat ? std::numeric_limits<double>::quiet_NaN() : kWall_m / flat;
  };
  return std::make_shared<const RingField>(
      std::vector<TestRing>{{4 * kDegree, 0, 0}, {0, 0, 0}, {-4 * kDegree, 0, 0}}, 360, tower,
      offset_m);
}

/// Rows at 4, 3, .. -4 degrees, of which 0, 4 and 8 are the field's rings, that always return.
inline DensityProfile tower_profile() {
  constexpr std::size_t kRows = 9;
  DensityProfile profile;
  profile.name = "tower";
  profile.rows = kRows;
  profile.given_every = 4;
  profile.elevation_mdeg = profile.return_permille = profile.given_return_permille =
      profile.bias_mm = RangeTable(kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    profile.elevation_mdeg.row(row).fill(
        static_cast<std::int16_t>(1000 * (4 - static_cast<int>(row))));
    profile.return_permille.row(row).fill(1000);
    profile.given_return_permille.row(row).fill(1000);
  }
  return profile;
}

/// One tree that asks whether a feature is above a cut.
inline ObliviousTrees one_question(std::size_t features, std::size_t feature, float cut,
                                   std::int16_t below, std::int16_t above, double unit = .01) {
  ObliviousTrees trees;
  trees.cuts.resize(features);
  trees.cuts[feature] = {cut};
  trees.depth = 1;
  trees.splits = {{static_cast<std::uint8_t>(feature), 0}};
  trees.leaves = {below, above};
  trees.unit = unit;
  return trees;
}

/// Lines of sight from the rows' elevations, between them and beyond, from three places.
inline std::vector<Sightline> lines_about() {
  constexpr double kDegree = std::numbers::pi / 180;
  std::vector<Sightline> lines;
  for (const Vec3& origin : {Vec3{}, Vec3{0, 0, .2}, Vec3{.3, -.1, 0}}) {
    for (double up = -5; up <= 5.01; up += 0.25) {
      for (double around = -179.6; around < 180; around += 17.3) {
        lines.push_back({origin, direction_of(up * kDegree, around * kDegree)});
      }
    }
  }
  return lines;
}

inline std::vector<RangeEstimate> told_along(const Field& field,
                                             const std::vector<Sightline>& lines) {
  std::vector<RangeEstimate> told(lines.size());
  field.range_along(lines, told);
  return told;
}

/// What is wrong with an estimate beside that of the rules alone; empty: nothing.
inline std::string fault_of(const RangeEstimate& told, const RangeEstimate& rules, bool ranges) {
  constexpr double kMostChange = 0.1001;
  if (!(told.confidence >= 0 && told.confidence <= 1)) return "a confidence that is none";
  if (told.valid() && !(std::isfinite(told.range_m) && told.range_m > 0)) return "valid nowhere";
  if (std::isnan(told.range_m) != std::isnan(rules.range_m)) return "a range out of nothing";
  if (std::isnan(told.range_m)) return "";
  const double change = std::abs(told.range_m - rules.range_m);
  if (change > (ranges ? kMostChange * rules.range_m : 0))
    return "a range beside that of the rules";
  return "";
}

/// What a valid profile makes the field of the tower say that no field may; empty: nothing.
inline std::string fault_with(const DensityProfile& profile) {
  static const std::shared_ptr<const Field> field = tower_field();
  static const std::vector<Sightline> lines = lines_about();
  static const std::vector<RangeEstimate> rules = told_along(*dense_field(field), lines);
  const bool fits = check_density_profile(profile, *field).has_value();
  for (const bool rows_of_profile : {false, true}) {
    const auto shared = std::make_shared<const DensityProfile>(profile);
    const auto with = dense_field(field, {DenseStrategy::best, shared, rows_of_profile});
    const std::vector<RangeEstimate> told = told_along(*with, lines);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string fault = fault_of(told[i], rules[i], rows_of_profile && fits);
      const bool aside =
          fits || (told[i].seen == rules[i].seen && told[i].confidence == rules[i].confidence);
      if (!fault.empty() || !aside) {
        return fmt::format("line {}{}: {}", i, rows_of_profile ? " of rows" : "",
                           aside ? fault : "a profile that does not fit has a say");
      }
    }
  }
  return "";
}

}  // namespace curlidar::test
