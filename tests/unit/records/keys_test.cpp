// SPDX-License-Identifier: BSD-3-Clause
#include "records/keys.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "hostile/targets/records.hpp"

namespace curlidar {
namespace {

/// The scale found, and whether keys give the bits back.
KeyScale check(const Column& values) {
  const KeyScale scale = scale_of(values);
  EXPECT_TRUE(is_scale_of(scale, type_of(values)));
  const auto keys = keys_of(values, scale, 0, 1);
  Column back = make_column(type_of(values), size_of(values));
  for (std::size_t i = 0; i < keys.size(); ++i) set_value(back, i, scale, keys[i]);
  EXPECT_EQ(test::bits_of(back), test::bits_of(values));
  return scale;
}

std::vector<float> quotients(float divisor) {
  std::vector<float> values;
  for (int i = -300; i < 700; i += 7) values.push_back(static_cast<float>(i) / divisor);
  return values;
}

TEST(Keys, FindTheCoarsestScale) {
  EXPECT_EQ(check(quotients(1)), KeyScale::whole);
  EXPECT_EQ(check(quotients(10)), KeyScale::tenths);
  EXPECT_EQ(check(quotients(100)), KeyScale::hundredths);
  EXPECT_EQ(check(quotients(1000)), KeyScale::thousandths);
  EXPECT_EQ(check(quotients(255)), KeyScale::of_255);
  EXPECT_EQ(check(quotients(65535)), KeyScale::of_65535);
  EXPECT_EQ(check(std::vector<double>{.25, 1e-6}), KeyScale::millionths);
  EXPECT_EQ(check(std::vector<double>{1. / 7}), KeyScale::bits);
  EXPECT_EQ(check(std::vector<float>{}), KeyScale::whole);
}

TEST(Keys, KeepEveryBitOfFloats) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double odd :
       {-0., inf, -inf, 1e300, -1e-310, std::bit_cast<double>(std::uint64_t{0xfff8000000000123})}) {
    EXPECT_EQ(check(std::vector<double>{1, odd, 2}), KeyScale::bits) << odd;
  }
  const auto quiet = std::bit_cast<float>(std::uint32_t{0x7fc00000});
  EXPECT_EQ(check(std::vector<float>{1, quiet, -0.f}), KeyScale::bits);
}

TEST(Keys, QuotientsAreRoundedAsDivisionIs) {
  std::mt19937_64 random(3);
  const double divisors[] = {1, 10, 100, 1000, 1e4, 1e5, 1e6, 255, 65535};
  Column value = std::vector<double>(1);
  for (int i = 0; i < 90000; ++i) {
    const auto key = static_cast<std::int64_t>(random()) >> (11 + random() % 50);
    const std::size_t scale = random() % 9;
    set_value(value, 0, static_cast<KeyScale>(scale), key);
    ASSERT_EQ(std::get<std::vector<double>>(value)[0], static_cast<double>(key) / divisors[scale]);
  }
}

TEST(Keys, KeepWholeTypes) {
  check(std::vector<std::int8_t>{-128, 0, 127});
  check(std::vector<std::uint64_t>{0, 1, std::uint64_t{1} << 63, ~std::uint64_t{0}});
  check(std::vector<std::int64_t>{std::numeric_limits<std::int64_t>::min(), -1,
                                  std::numeric_limits<std::int64_t>::max()});
}

TEST(Keys, RiseAsFloatsDo) {
  const std::vector<double> rising{-1e300, -2, -1e-300, -0., 0, 1e-300, 2, 1e300};
  const auto keys = keys_of(rising, KeyScale::bits, 0, 1);
  for (std::size_t i = 1; i < keys.size(); ++i) EXPECT_LT(keys[i - 1], keys[i]);
}

TEST(Keys, AnyKeyIsSomeValue) {
  for (const std::int64_t key : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-5},
                                 std::numeric_limits<std::int64_t>::max()}) {
    Column floats = std::vector<float>(1), bytes = std::vector<std::uint8_t>(1);
    for (std::uint8_t scale = 0; scale < kKeyScales; ++scale) {
      set_value(floats, 0, static_cast<KeyScale>(scale), key);
    }
    set_value(bytes, 0, KeyScale::whole, key);
    EXPECT_EQ(std::get<std::vector<std::uint8_t>>(bytes)[0], static_cast<std::uint8_t>(key));
  }
  EXPECT_FALSE(is_scale_of(KeyScale::tenths, ScalarType::int32));
  EXPECT_FALSE(is_scale_of(static_cast<KeyScale>(10), ScalarType::float32));
}

}  // namespace
}  // namespace curlidar
