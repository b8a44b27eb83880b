// SPDX-License-Identifier: BSD-3-Clause
// Every cloud in every mode comes back slot by slot as promised: seen by comparing the decoded
// cloud with the given one here, not by what `verify` says of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "curlidar/verify.hpp"
#include "support/promised_clouds.hpp"

namespace curlidar {
namespace {

struct Mode {
  const char* name;
  CompactTarget target;
  double value;
};

constexpr std::array<Mode, 7> kModes{{
    {"error", CompactTarget::error, 0.02},
    {"error_nn", CompactTarget::error_nn, 0.02},
    {"max_2_mm", CompactTarget::max_error, 0.002},
    {"max_2_cm", CompactTarget::max_error, 0.02},
    {"lossless", CompactTarget::lossless, 0},
    {"bits", CompactTarget::bits_per_point, 30},
    {"step", CompactTarget::step, 0.05},
}};

EncodeSettings settings_for(const test::NamedCloud& named, const Mode& mode) {
  EncodeSettings settings;
  settings.sensor = named.sensor;
  settings.compact.target = mode.target;
  settings.compact.target_value = mode.value;
  settings.compact.effort = 1;
  return settings;
}

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// Mean distance from the returns of one cloud to the nearest of the other.
double mean_to_nearest(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double sum = 0;
  for (const Vec3& p : from) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& q : to) nearest = std::min(nearest, norm(p - q));
    sum += nearest;
  }
  return sum / static_cast<double>(std::max<std::size_t>(from.size(), 1));
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Slots without a return: all bits but those of NaN.
bool same_hole(double a, double b) {
  return std::isnan(b) ? std::isnan(a) : std::memcmp(&a, &b, sizeof a) == 0;
}

bool fits_float32(const Vec3& p) {
  const auto fits = [](double v) { return std::isnan(v) || round_to_float32(v) == v; };
  return fits(p.x) && fits(p.y) && fits(p.z);
}

/// Returns of both clouds and their mean and largest distance, after checks of every slot.
struct Compared {
  std::vector<Vec3> back, given;
  double mean = 0, most = 0;
  bool exact = true;
};

Compared compare_slots(const Cloud& back, const Cloud& given) {
  Compared out;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Vec3 &a = back.positions[i], &b = given.positions[i];
    if (!is_return(b)) {
      EXPECT_TRUE(same_hole(a.x, b.x) && same_hole(a.y, b.y) && same_hole(a.z, b.z)) << i;
      continue;
    }
    EXPECT_TRUE(is_return(a)) << i;
    EXPECT_TRUE(back.position_type != ScalarType::float32 || fits_float32(a)) << i;
    out.back.push_back(a);
    out.given.push_back(b);
    out.exact = out.exact && same_bits(a, b);
    const double off = same_bits(a, b) ? 0 : distance(a, b);
    out.mean += off;
    out.most = std::max(out.most, off);
  }
  out.mean /= static_cast<double>(std::max<std::size_t>(out.given.size(), 1));
  return out;
}

void expect_within(const Compared& compared, const Mode& mode) {
  switch (mode.target) {
    case CompactTarget::max_error:
      EXPECT_LE(compared.most, mode.value);
      break;
    case CompactTarget::lossless:
      EXPECT_TRUE(compared.exact);
      break;
    case CompactTarget::error:
      EXPECT_LE(compared.mean, mode.value * 1.0001);
      break;
    case CompactTarget::error_nn:
      EXPECT_LE(mean_to_nearest(compared.back, compared.given), mode.value * 1.0001);
      EXPECT_LE(mean_to_nearest(compared.given, compared.back), mode.value * 1.0001);
      break;
    default:
      break;
  }
}

void expect_same_attributes(const Cloud& back, const Cloud& given) {
  ASSERT_EQ(back.attributes.size(), given.attributes.size());
  for (std::size_t i = 0; i < given.attributes.size(); ++i) {
    EXPECT_EQ(back.attributes[i].name, given.attributes[i].name);
    EXPECT_EQ(back.attributes[i].components, given.attributes[i].components);
    test::expect_same_bits(back.attributes[i].values, given.attributes[i].values,
                           given.attributes[i].name);
  }
}

void check_file(const Encoded& encoded, const Cloud& given, const Mode& mode) {
  const auto proof = verify(encoded.bytes, given);
  ASSERT_TRUE(proof) << proof.error().message;
  EXPECT_TRUE(proof->ok) << (proof->failures.empty() ? "" : proof->failures.front());
  const auto scan = decode(encoded.bytes);
  ASSERT_TRUE(scan) << scan.error().message;
  ASSERT_TRUE(scan->cloud);
  const Cloud& back = *scan->cloud;
  ASSERT_EQ(back.size(), given.size());
  EXPECT_EQ(back.width, given.width);
  EXPECT_EQ(back.height, given.height);
  EXPECT_EQ(back.position_type, given.position_type);
  const Compared compared = compare_slots(back, given);
  expect_within(compared, mode);
  expect_same_attributes(back, given);
  if (mode.target == CompactTarget::bits_per_point && !compared.given.empty()) {
    EXPECT_LE(encoded.report.compact->bits_per_point_coded, mode.value);
  }
  EXPECT_EQ(proof->points, compared.given.size());
  EXPECT_EQ(encoded.report.points_coded, compared.given.size());
  const double rounding = 1e-12 + 1e-12 * compared.most;
  if (proof->promise.any_order) {
    // Each is measured to the nearest, in numbers made small where some are beyond 1e150.
    EXPECT_LE(proof->max_error_m, 1.0001 * compared.most);
  } else {
    EXPECT_NEAR(proof->max_error_m, compared.most, rounding);
  }
}

/// Bits that a few points, or points without any pattern, cannot do with: they need as many at 5
/// cm.
void expect_out_of_reach(const test::NamedCloud& named, const Error& error) {
  EXPECT_NE(error.message.find("out of reach"), std::string::npos) << error.message;
  const auto coarse = encode(named.cloud, settings_for(named, {"", CompactTarget::step, 0.05}));
  ASSERT_TRUE(coarse);
  EXPECT_GT(coarse->report.compact->bits_per_point_coded, 20) << error.message;
}

void check_every_mode(const test::NamedCloud& named) {
  for (const Mode& mode : kModes) {
    SCOPED_TRACE(mode.name);
    const auto encoded = encode(named.cloud, settings_for(named, mode));
    if (mode.target == CompactTarget::bits_per_point && !encoded) {
      expect_out_of_reach(named, encoded.error());
      continue;
    }
    ASSERT_TRUE(encoded) << encoded.error().message;
    check_file(*encoded, named.cloud, mode);
  }
}

void check_threads(const test::NamedCloud& named) {
  for (const Mode& mode : {kModes[1], kModes[3], kModes[4]}) {
    EncodeSettings settings = settings_for(named, mode);
    const auto one = encode(named.cloud, settings);
    settings.threads = 4;
    const auto four = encode(named.cloud, settings);
    ASSERT_TRUE(one && four);
    EXPECT_TRUE(one->bytes == four->bytes) << mode.name;
  }
}

/// With the order given up, the number of its slot tells which point a slot of the file is.
void check_any_order(const test::NamedCloud& named) {
  Cloud given = named.cloud;
  std::vector<std::uint32_t> numbers(given.size());
  for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  given.attributes.push_back({"number", 1, std::move(numbers)});
  for (const Mode& mode : {kModes[3], kModes[4]}) {
    SCOPED_TRACE(mode.name);
    EncodeSettings settings = settings_for(named, mode);
    settings.compact.keep_order = false;
    const auto encoded = encode(given, settings);
    ASSERT_TRUE(encoded) << encoded.error().message;
    const auto scan = decode(encoded->bytes);
    ASSERT_TRUE(scan && scan->cloud);
    const Attribute* found = scan->cloud->find("number");
    ASSERT_NE(found, nullptr);
    const auto& order = std::get<std::vector<std::uint32_t>>(found->values);
    Cloud expected = select(given, order);
    expected.position_type = given.position_type;
    EXPECT_EQ(expected.size(), count_returns(given));
    std::vector<std::uint32_t> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end()) << "a point twice";
    check_file(*encoded, expected, mode);
  }
}

class Promised : public testing::TestWithParam<test::CloudGroup> {
 protected:
  template <class Check>
  void each(const Check& check) {
    for (const test::NamedCloud& named : GetParam().clouds()) {
      SCOPED_TRACE(named.name);
      check(named);
    }
  }
};

TEST_P(Promised, ComesBackInEveryMode) {
  each(check_every_mode);
}
TEST_P(Promised, ThreadsDoNotChangeTheBytes) {
  each(check_threads);
}
TEST_P(Promised, ComesBackInAnyOrder) {
  each(check_any_order);
}

INSTANTIATE_TEST_SUITE_P(Clouds, Promised, testing::ValuesIn(test::kPromisedClouds),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace curlidar
