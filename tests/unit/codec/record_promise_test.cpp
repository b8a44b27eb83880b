// SPDX-License-Identifier: BSD-3-Clause
// What a file promises is what `verify` holds it to: broken promises and other clouds are noticed.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "codec/record_file.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/verify.hpp"
#include "support/promised_clouds.hpp"

namespace curlidar {
namespace {

Encoded encoded(const test::NamedCloud& named, CompactTarget target, double value) {
  EncodeSettings settings;
  settings.sensor = named.sensor;
  settings.compact.target = target;
  settings.compact.target_value = value;
  settings.compact.effort = 1;
  return encode(named.cloud, settings).value();
}

/// The file with another promise, or none.
std::vector<std::byte> promising(const std::vector<std::byte>& file,
                                 const std::optional<std::vector<std::byte>>& promise) {
  ContainerWriter writer;
  const std::vector<Chunk> chunks = read_container(file).value();
  for (const Chunk& chunk : chunks) {
    if (chunk.type != ChunkType::promise) writer.add(chunk.type, chunk.payload);
  }
  if (promise) writer.add(ChunkType::promise, *promise);
  return std::move(writer).finish();
}

test::NamedCloud rays() {
  return {"rays", test::exact_scan(test::exact_sensor()), test::exact_sensor()};
}

std::vector<test::NamedCloud> one_of_each_kind() {
  return {rays(), {"rings", test::organised_scan()}, test::clouds_without_rings().front()};
}

TEST(RecordPromise, TheCloudsOfTheTestsCoverEveryWay) {
  const auto of_rays = encoded(rays(), CompactTarget::max_error, 0.02).report.records;
  EXPECT_EQ(of_rays->lattice, RecordLattice::rays);
  const auto of_rings = encoded({"rings", test::unsteady_scan()}, CompactTarget::error, 0.02);
  EXPECT_EQ(of_rings.report.records->lattice, RecordLattice::rings);
  EXPECT_GT(of_rings.report.records->bytes.directions, 0u);
  const auto two = test::scans_on_rays()[2];
  EXPECT_GT(encoded(two, CompactTarget::max_error, 0.02).report.records->loose, 50u);
  const auto none = encoded(test::clouds_without_rings().front(), CompactTarget::lossless, 0);
  EXPECT_EQ(none.report.records->lattice, RecordLattice::none);
}

TEST(RecordPromise, ASmallerBoundThanIsKeptFails) {
  for (const test::NamedCloud& named : one_of_each_kind()) {
    SCOPED_TRACE(named.name);
    const auto file = encoded(named, CompactTarget::max_error, 0.02).bytes;
    const auto proof = verify(file, named.cloud);
    ASSERT_TRUE(proof && proof->ok);
    EXPECT_EQ(proof->promise, (RecordPromise{false, 0.02}));
    EXPECT_GT(proof->max_error_m, 0.002);
    const auto broken = promising(file, write_promise({false, 0.9 * proof->max_error_m}));
    const auto refused = verify(broken, named.cloud);
    ASSERT_TRUE(refused);
    EXPECT_FALSE(refused->ok);
    ASSERT_EQ(refused->failures.size(), 1u);
    EXPECT_NE(refused->failures.front().find("the bound is"), std::string::npos);
    const auto barely =
        verify(promising(file, write_promise({false, proof->max_error_m})), named.cloud);
    EXPECT_TRUE(barely->ok);
  }
}

TEST(RecordPromise, BitsThatAreNotKeptFail) {
  for (const test::NamedCloud& named : one_of_each_kind()) {
    const auto file = encoded(named, CompactTarget::max_error, 0.02).bytes;
    const auto refused = verify(promising(file, write_promise({true, 0})), named.cloud);
    ASSERT_TRUE(refused);
    EXPECT_FALSE(refused->ok);
    EXPECT_FALSE(refused->bit_exact);
    EXPECT_TRUE(verify(promising(file, std::nullopt), named.cloud)->ok);
  }
}

/// `change` is done to the cloud behind the file's back.
void expect_noticed(CompactTarget target, double value, const std::function<void(Cloud&)>& change) {
  const test::NamedCloud named{"", test::organised_scan()};
  Cloud given = named.cloud;
  std::vector<std::uint16_t> level;
  for (std::uint32_t i = 0; i < given.size(); ++i) level.push_back(static_cast<std::uint16_t>(i));
  given.attributes.push_back({"level", 1, std::move(level)});
  const auto file = encoded({"", given}, target, value).bytes;
  ASSERT_TRUE(verify(file, given)->ok);
  change(given);
  const auto proof = verify(file, given);
  ASSERT_TRUE(proof);
  EXPECT_FALSE(proof->ok);
  EXPECT_FALSE(proof->failures.empty());
}

std::size_t first_return(const Cloud& cloud, std::size_t from = 0) {
  while (!is_return(cloud.positions[from])) ++from;
  return from;
}

TEST(RecordPromise, OtherCloudsAreNoticed) {
  const auto bound = CompactTarget::max_error;
  expect_noticed(bound, 0.02,
                 [](Cloud& cloud) { cloud.positions[first_return(cloud, 100)].z += 0.05; });
  expect_noticed(bound, 0.02, [](Cloud& cloud) {
    const std::size_t a = first_return(cloud), b = first_return(cloud, a + 30);
    std::swap(cloud.positions[a], cloud.positions[b]);
  });
  expect_noticed(bound, 0.02, [](Cloud& cloud) {
    cloud.positions[first_return(cloud)].x = std::numeric_limits<double>::quiet_NaN();
  });
  expect_noticed(bound, 0.02, [](Cloud& cloud) { cloud.positions.back() = {0, 0, 0}; });
  expect_noticed(bound, 0.02, [](Cloud& cloud) { std::swap(cloud.width, cloud.height); });
  expect_noticed(bound, 0.02, [](Cloud& cloud) {
    std::get<std::vector<std::uint16_t>>(cloud.attributes[0].values)[7] ^= 1;
  });
  expect_noticed(bound, 0.02, [](Cloud& cloud) { cloud.attributes[0].name = "other"; });
  expect_noticed(bound, 0.02, [](Cloud& cloud) {
    cloud.positions.push_back({1, 2, 3});
    std::get<std::vector<std::uint16_t>>(cloud.attributes[0].values).push_back(0);
  });
  expect_noticed(CompactTarget::lossless, 0, [](Cloud& cloud) {
    double& x = cloud.positions[first_return(cloud)].x;
    x = std::nextafter(x, 1e9);
  });
}

TEST(RecordPromise, FilesOfAnImageAreRefused) {
  EncodeSettings settings;
  settings.compact.columns = 64;
  settings.compact.effort = 1;
  const Cloud cloud = test::organised_scan();
  const auto file = encode(cloud, settings);
  ASSERT_TRUE(file);
  const auto proof = verify(file->bytes, cloud);
  ASSERT_FALSE(proof);
  EXPECT_EQ(proof.error().code, ErrorCode::unsupported);
}

TEST(RecordPromise, CloudsThatAreNoneAreRefused) {
  const Cloud good = test::organised_scan();
  const auto refused = [](const Cloud& cloud) {
    const auto file = encode(cloud);
    return !file && file.error().code == ErrorCode::invalid_argument;
  };
  Cloud cloud = good;
  cloud.height += 1;
  EXPECT_TRUE(refused(cloud)) << "shape";
  cloud = good;
  cloud.attributes.push_back({"short", 1, std::vector<float>(good.size() - 1)});
  EXPECT_TRUE(refused(cloud)) << "attribute";
}

TEST(RecordPromise, CoordinatesBecomeDoublesWhereFloatsDoNotHoldThem) {
  Cloud cloud = test::organised_scan();
  cloud.positions[first_return(cloud)].x += 1e-9;
  const auto file = encoded({"", cloud}, CompactTarget::lossless, 0).bytes;
  EXPECT_TRUE(verify(file, cloud)->ok);
  EXPECT_EQ(decode(file)->cloud->position_type, ScalarType::float64);
}

/// Offsets of directions are coded in terms of the exact ranges: without those they cannot be read.
TEST(RecordPromise, WithoutResidualsPointsLieInTheMiddlesOfTheirCells) {
  const test::NamedCloud named{"", test::unsteady_scan()};
  const auto file = encoded(named, CompactTarget::error, 0.02);
  ASSERT_GT(file.report.records->bytes.directions, 0u);
  DecodeOptions options;
  options.field_only = true;
  const auto scan = decode(file.bytes, options);
  ASSERT_TRUE(scan && scan->cloud) << scan.error().message;
  ASSERT_EQ(scan->cloud->size(), named.cloud.size());
  EXPECT_EQ(scan->records->promise, RecordPromise{});
  // A return whose column is taken lies in the next.
  const double two_columns = 4.01 * std::numbers::pi / file.report.compact->columns;
  for (std::size_t i = 0; i < named.cloud.size(); ++i) {
    const Vec3 &a = scan->cloud->positions[i], &b = named.cloud.positions[i];
    const double turn =
        std::remainder(std::atan2(a.y, a.x) - std::atan2(b.y, b.x), 2 * std::numbers::pi);
    EXPECT_LE(std::abs(turn), two_columns) << i;
  }
}

TEST(RecordPromise, PointsWithoutAnOrderAreCorrupt) {
  const test::NamedCloud named{"", test::unsteady_scan()};
  const auto file = encoded(named, CompactTarget::max_error, 0.02).bytes;
  ContainerWriter writer;
  const std::vector<Chunk> chunks = read_container(file).value();
  for (const Chunk& chunk : chunks) {
    if (chunk.type != ChunkType::order) writer.add(chunk.type, chunk.payload);
  }
  const auto scan = decode(std::move(writer).finish());
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().code, ErrorCode::corrupt);
}

TEST(RecordPromise, OnlyLengthsAreBounds) {
  const test::NamedCloud named = test::clouds_without_rings().front();
  const auto file = encoded(named, CompactTarget::max_error, 0.02).bytes;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bound : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    const auto proof = verify(promising(file, write_promise({false, bound})), named.cloud);
    ASSERT_FALSE(proof);
    EXPECT_EQ(proof.error().code, ErrorCode::corrupt);
  }
  for (const auto& payload :
       {std::vector<std::byte>{}, std::vector<std::byte>{std::byte{0}},
        std::vector<std::byte>{std::byte{3}}, std::vector<std::byte>{std::byte{2}, std::byte{0}}}) {
    const auto proof = verify(promising(file, payload), named.cloud);
    ASSERT_FALSE(proof);
    EXPECT_EQ(proof.error().code, ErrorCode::corrupt);
  }
}

}  // namespace
}  // namespace curlidar
