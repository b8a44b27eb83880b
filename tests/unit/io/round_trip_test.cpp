// SPDX-License-Identifier: BSD-3-Clause
// What is written comes back, bit by bit, in every format, encoding and type.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

using test::Random;

/// Writes and parses again; `name` tells the format.
Cloud round_trip(const Cloud& cloud, const std::string& name, Encoding encoding) {
  WriteOptions options;
  options.encoding = encoding;
  const auto bytes = format_cloud(cloud, name, options);
  if (!bytes) {
    ADD_FAILURE() << bytes.error().message;
    return {};
  }
  auto back = parse_cloud(*bytes, name);
  if (!back) {
    ADD_FAILURE() << back.error().message;
    return {};
  }
  return std::move(*back);
}

Cloud random_cloud(std::uint64_t seed, bool with_64_bit_integers) {
  Random random(seed);
  const std::size_t width = seed % 7 == 0 ? 0 : 1 + random.below(40);
  const std::size_t height = width > 0 && seed % 3 == 0 ? 2 + random.below(5) : 1;
  Cloud cloud = test::random_positions(random, width * height,
                                       seed % 2 == 0 ? ScalarType::float32 : ScalarType::float64);
  cloud.width = static_cast<std::uint32_t>(width);
  cloud.height = static_cast<std::uint32_t>(height);
  for (const ScalarType type : test::kAllTypes) {
    const bool is_64_bit = type == ScalarType::int64 || type == ScalarType::uint64;
    if (random.below(3) == 0 || (is_64_bit && !with_64_bit_integers)) continue;
    const auto components =
        static_cast<std::uint32_t>(random.below(2) == 0 ? 1 : 1 + random.below(4));
    cloud.attributes.push_back(test::random_attribute(random, std::string("a_") + to_string(type),
                                                      type, components, cloud.size()));
  }
  return cloud;
}

void add_metadata(Cloud& cloud) {
  cloud.metadata = {{"frame_id", "os sensor\n100%"},
                    {"stamp_ns", "1732848128093928016"},
                    {"empty", ""},
                    {"gr\xc3\xb6\xc3\x9f"
                     "e",
                     "\xe2\x82\xac"}};
}

constexpr std::uint64_t kClouds = 42;

TEST(RoundTrip, PcdKeepsEverything) {
  for (std::uint64_t seed = 0; seed < kClouds; ++seed) {
    SCOPED_TRACE(seed);
    Cloud cloud = random_cloud(seed, true);
    add_metadata(cloud);
    cloud.metadata["viewpoint"] = "1 2 3 0.5 0.5 0.5 0.5";
    for (const Encoding encoding :
         {Encoding::ascii, Encoding::binary, Encoding::binary_compressed}) {
      test::expect_same_cloud(cloud, round_trip(cloud, "a.pcd", encoding));
    }
  }
}

TEST(RoundTrip, PlyKeepsEverythingButWideIntegers) {
  for (std::uint64_t seed = 0; seed < kClouds; ++seed) {
    SCOPED_TRACE(seed);
    Cloud cloud = random_cloud(seed, false);
    add_metadata(cloud);
    for (const Encoding encoding :
         {Encoding::ascii, Encoding::binary, Encoding::binary_big_endian}) {
      test::expect_same_cloud(cloud, round_trip(cloud, "a.ply", encoding));
    }
  }
}

TEST(RoundTrip, NpyKeepsLayoutAndAttributes) {
  for (std::uint64_t seed = 0; seed < kClouds; ++seed) {
    SCOPED_TRACE(seed);
    const Cloud cloud = random_cloud(seed, true);
    for (const Encoding encoding : {Encoding::binary, Encoding::binary_big_endian}) {
      test::expect_same_cloud(cloud, round_trip(cloud, "a.npy", encoding));
    }
  }
}

TEST(RoundTrip, KittiAndNuscenesKeepTheirFields) {
  for (std::uint64_t seed = 0; seed < kClouds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Cloud cloud = test::random_positions(random, random.below(50), ScalarType::float32);
    cloud.attributes.push_back(
        test::random_attribute(random, "intensity", ScalarType::float32, 1, cloud.size()));
    test::expect_same_cloud(cloud, round_trip(cloud, "a.bin", Encoding::binary));
    cloud.attributes.push_back(
        test::random_attribute(random, "ring", ScalarType::float32, 1, cloud.size()));
    test::expect_same_cloud(cloud, round_trip(cloud, "a.pcd.bin", Encoding::binary));
  }
}

TEST(RoundTrip, CsvKeepsValues) {
  for (std::uint64_t seed = 0; seed < kClouds; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    // Text has no types: float64 and int64 are what comes back.
    Cloud cloud = test::random_positions(random, 1 + random.below(50), ScalarType::float64);
    cloud.attributes.push_back(
        test::random_attribute(random, "intensity", ScalarType::float64, 1, cloud.size()));
    cloud.attributes.push_back(
        test::random_attribute(random, "stamp", ScalarType::int64, 1, cloud.size()));
    std::get<std::vector<double>>(cloud.attributes[0].values)[0] = 0.5;  // surely no whole number
    for (const char* name : {"a.csv", "a.xyz", "a.txt"}) {
      test::expect_same_cloud(cloud, round_trip(cloud, name, Encoding::binary));
    }
  }
}

TEST(RoundTrip, Float32AsTextIsTheSameFloat32) {
  Random random(5);
  const Cloud cloud = test::random_positions(random, 2000, ScalarType::float32);
  const Cloud back = round_trip(cloud, "a.csv", Encoding::ascii);
  ASSERT_EQ(back.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto a = static_cast<float>(cloud.positions[i].x);
    const auto b = static_cast<float>(back.positions[i].x);
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << i << " " << a << " " << b;
  }
}

TEST(RoundTrip, WritingTwiceGivesTheSameBytes) {
  const Cloud cloud = random_cloud(3, false);
  for (const char* name : {"a.pcd", "a.ply", "a.npy"}) {
    EXPECT_EQ(*format_cloud(cloud, name),
              *format_cloud(round_trip(cloud, name, Encoding::binary), name));
  }
}

// ---- what a format cannot hold ----

Cloud with_attribute(const std::string& name, ScalarType type, std::uint32_t components = 1) {
  Random random(1);
  Cloud cloud = test::random_positions(random, 3, ScalarType::float32);
  cloud.attributes.push_back(test::random_attribute(random, name, type, components, 3));
  return cloud;
}

std::string refusal(const Cloud& cloud, const std::string& name, WriteOptions options = {}) {
  const auto bytes = format_cloud(cloud, name, options);
  EXPECT_FALSE(bytes) << name;
  return bytes ? "" : bytes.error().message;
}

TEST(Writers, RefuseAttributesThatTheFormatCannotHold) {
  using testing::AllOf;
  using testing::HasSubstr;
  Cloud cloud = with_attribute("ring", ScalarType::uint16);
  cloud.attributes.push_back(cloud.attributes[0]);
  cloud.attributes[1].name = "time";
  EXPECT_THAT(refusal(cloud, "a.bin"),
              AllOf(HasSubstr("a.bin"), HasSubstr("ring"), HasSubstr("time")));
  EXPECT_THAT(refusal(cloud, "a.pcd.bin"), HasSubstr("time"));
  EXPECT_THAT(refusal(with_attribute("stamp", ScalarType::int64), "a.ply"), HasSubstr("stamp"));
  EXPECT_THAT(refusal(with_attribute("two words", ScalarType::int8), "a.pcd"),
              HasSubstr("two words"));
  EXPECT_THAT(refusal(with_attribute("_", ScalarType::int8), "a.pcd"), HasSubstr("padding"));
  EXPECT_THAT(refusal(with_attribute("it's", ScalarType::int8), "a.npy"), HasSubstr("it's"));
  EXPECT_THAT(refusal(with_attribute("a,b", ScalarType::int8), "a.csv"), HasSubstr("a,b"));
}

TEST(Writers, RefuseInconsistentClouds) {
  Cloud cloud = with_attribute("ring", ScalarType::uint16);
  cloud.positions.pop_back();
  refusal(cloud, "a.pcd");
  refusal(with_attribute("x", ScalarType::uint16), "a.pcd");
  refusal(with_attribute("", ScalarType::uint16), "a.pcd");
  cloud = with_attribute("ring", ScalarType::uint16);
  cloud.attributes.push_back(cloud.attributes[0]);
  refusal(cloud, "a.pcd");
  cloud = with_attribute("ring", ScalarType::uint16);
  cloud.height = 2;
  refusal(cloud, "a.pcd");
  cloud = with_attribute("a_0", ScalarType::uint16);
  cloud.attributes.push_back({"a", 2, make_column(ScalarType::int8, 6)});
  refusal(cloud, "a.ply");
  cloud = with_attribute("ring", ScalarType::uint16);
  cloud.metadata["viewpoint"] = "here";
  refusal(cloud, "a.pcd");
}

TEST(Writers, RefuseEncodingsThatTheFormatDoesNotHave) {
  const Cloud cloud = with_attribute("intensity", ScalarType::float32);
  refusal(cloud, "a.bin", {std::nullopt, Encoding::ascii});
  refusal(cloud, "a.npy", {std::nullopt, Encoding::binary_compressed});
  refusal(cloud, "a.pcd", {std::nullopt, Encoding::binary_big_endian});
  refusal(cloud, "a.unknown");
  EXPECT_TRUE(format_cloud(cloud, "a.unknown", {CloudFormat::ply, Encoding::ascii}));
}

TEST(Writers, KittiConvertsIntensityAndFillsAMissingOne) {
  Cloud cloud = with_attribute("intensity", ScalarType::uint8);
  cloud.attributes[0].values = std::vector<std::uint8_t>{0, 7, 255};
  const Cloud back = round_trip(cloud, "a.bin", Encoding::binary);
  EXPECT_EQ(std::get<std::vector<float>>(back.find("intensity")->values),
            (std::vector<float>{0, 7, 255}));
  cloud.attributes.clear();
  const Cloud empty = round_trip(cloud, "a.bin", Encoding::binary);
  EXPECT_EQ(std::get<std::vector<float>>(empty.find("intensity")->values),
            (std::vector<float>{0, 0, 0}));
}

}  // namespace
}  // namespace curlidar
