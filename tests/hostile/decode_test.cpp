// SPDX-License-Identifier: BSD-3-Clause
// Whatever the bytes, decoding ends in a scan that can be reconstructed or in an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "codec/field_chunks.hpp"
#include "curlidar/reconstruct.hpp"
#include "format/parameters_chunk.hpp"
#include "format/sensor_chunk.hpp"
#include "hostile/targets/decode.hpp"
#include "records/order.hpp"
#include "support/chunks.hpp"
#include "support/clouds.hpp"
#include "support/promised_clouds.hpp"
#include "support/scans.hpp"

namespace curlidar {
namespace {

constexpr DecodeLimits kLimits{.max_cells = 1u << 16, .max_bytes = 1u << 22};

std::vector<std::byte> file_of(Profile profile) {
  const SensorProfile sensor = test::small_sensor(12, 64);
  EncodeSettings settings = test::small_settings(sensor);
  settings.profile = profile;
  settings.paper = for_profile(settings.paper, profile);
  settings.paper.global_degree = 6;
  settings.compact.columns = 64;
  settings.compact.target_value = 0.01;  // with residuals
  settings.compact.effort = 1;
  Cloud scan = test::small_scan("room", sensor);
  scan.metadata["frame_id"] = "lidar";
  return encode(scan, settings)->bytes;
}

/// Decodes and, if that works, reconstructs; both must stay within bounds and return.
bool survives(ByteSpan bytes) {
  const Result<DecodedScan> scan = decode(bytes, kLimits);
  if (!scan) return !scan.error().message.empty();
  for (const bool masks : {true, false}) {
    const Result<Cloud> cloud =
        reconstruct(*scan, {.rows = 1.5, .columns = 0.75, .masks = masks, .max_points = 1u << 18});
    if (!cloud && cloud.error().message.empty()) return false;
  }
  return true;
}

class HostileDecode : public testing::TestWithParam<Profile> {};

TEST_P(HostileDecode, CutAtEveryLength) {
  const auto file = file_of(GetParam());
  for (std::size_t size = 0; size < file.size(); ++size) {
    const Result<DecodedScan> scan = decode(ByteSpan(file).first(size), kLimits);
    ASSERT_FALSE(scan) << "cut at " << size;
  }
}

TEST_P(HostileDecode, DamageBehindRightChecksums) {
  const auto file = file_of(GetParam());
  ASSERT_TRUE(decode(file, kLimits));
  test::Random random(7);
  std::size_t decoded = 0;
  for (int i = 0; i < 1500; ++i) {
    auto damaged = file;
    for (std::uint64_t n = 1 + random.below(3); n > 0; --n) {
      damaged[8 + random.below(file.size() - 8)] = static_cast<std::byte>(random.next());
    }
    damaged = test::with_right_checksums(damaged);
    ASSERT_TRUE(survives(damaged)) << "case " << i;
    decoded += decode(damaged, kLimits) ? 1 : 0;
  }
  EXPECT_GT(decoded, 50u) << "the damage never reached a readable file";
}

INSTANTIATE_TEST_SUITE_P(All, HostileDecode,
                         testing::Values(Profile::paper, Profile::paper_1to1, Profile::paper_global,
                                         Profile::compact),
                         test::profile_test_name);

TEST(HostileDecode, CompactFilesCutAnywhereGiveWhatIsThere) {
  const auto file = file_of(Profile::compact);
  const std::size_t returns = decode(file, kLimits)->coded_returns;
  DecodeOptions options;
  options.limits = kLimits;
  options.allow_truncated = true;
  std::size_t last = 0;
  for (std::size_t size = 0; size < file.size(); size += 3) {
    const Result<DecodedScan> scan = decode(ByteSpan(file).first(size), options);
    if (!scan) {
      ASSERT_FALSE(scan.error().message.empty());
      ASSERT_EQ(last, 0u) << "cut at " << size;
      continue;
    }
    ASSERT_FALSE(scan->missing.empty()) << "cut at " << size;
    ASSERT_EQ(scan->points.size(), scan->coded_returns);
    ASSERT_GE(scan->coded_returns, last) << "cut at " << size;
    last = scan->coded_returns;
    ASSERT_TRUE(reconstruct(*scan, {.rows = 1.5}));
  }
  EXPECT_EQ(last, returns);
}

TEST(HostileDecode, DamagedCompactFilesDecodedInPart) {
  const auto file = file_of(Profile::compact);
  test::Random random(11);
  for (int i = 0; i < 500; ++i) {
    auto damaged = file;
    damaged[8 + random.below(file.size() - 8)] = static_cast<std::byte>(random.next());
    damaged = test::with_right_checksums(damaged);
    DecodeOptions options;
    options.limits = kLimits;
    options.allow_truncated = true;
    options.partition = true;
    options.field_only = i % 2 == 0;
    options.region = ScanRegion{2, 9, -1, 2};
    const auto length = i % 3 == 0 ? damaged.size() : random.below(damaged.size());
    const Result<DecodedScan> scan = decode(ByteSpan(damaged).first(length), options);
    if (scan) {
      ASSERT_TRUE(reconstruct(*scan, {.rows = 2, .masks = false}));
    } else {
      ASSERT_FALSE(scan.error().message.empty());
    }
  }
}

/// Small files with every return: on rays, on rings with offsets of directions, of loose points.
std::vector<std::vector<std::byte>> record_files() {
  const SensorProfile sensor = test::exact_sensor(6, 48);
  Cloud loose = test::clouds_without_rings().front().cloud;
  loose.positions[3] = {0, 0, 0};
  loose.positions[4].x = std::numeric_limits<double>::infinity();
  const std::vector<test::NamedCloud> clouds{{"rays", test::exact_scan(sensor), sensor},
                                             {"rings", test::unsteady_scan(6, 48)},
                                             {"organised", test::organised_scan(6, 40)},
                                             {"loose", std::move(loose)}};
  std::vector<std::vector<std::byte>> files;
  for (const test::NamedCloud& named : clouds) {
    for (const auto target :
         {CompactTarget::error, CompactTarget::max_error, CompactTarget::lossless}) {
      EncodeSettings settings;
      settings.sensor = named.sensor;
      settings.compact.target = target;
      settings.compact.effort = 1;
      files.push_back(encode(named.cloud, settings)->bytes);
    }
  }
  return files;
}

TEST(HostileRecords, CutAnywhere) {
  for (const auto& file : record_files()) {
    DecodeOptions options;
    options.limits = kLimits;
    options.allow_truncated = true;
    for (std::size_t size = 0; size < file.size(); size += 1 + file.size() / 100) {
      const ByteSpan cut = ByteSpan(file).first(size);
      ASSERT_FALSE(decode(cut, kLimits)) << "cut at " << size;
      const auto scan = decode(cut, options);
      ASSERT_TRUE(scan ? !scan->missing.empty() : !scan.error().message.empty()) << size;
    }
  }
}

TEST(HostileRecords, DamageBehindRightChecksums) {
  test::Random random(23);
  std::size_t decoded = 0;
  for (const auto& file : record_files()) {
    for (int i = 0; i < 60; ++i) {
      auto damaged = file;
      for (std::uint64_t n = 1 + random.below(3); n > 0; --n) {
        damaged[8 + random.below(file.size() - 8)] = static_cast<std::byte>(random.next());
      }
      DecodeOptions options;
      options.limits = kLimits;
      options.partition = true;
      options.field_only = i % 5 == 0;
      const auto bytes = test::with_right_checksums(damaged);
      ASSERT_EQ(test::check_decoded(bytes, options), "") << "case " << i;
      decoded += decode(bytes, options) ? 1 : 0;
    }
  }
  EXPECT_GT(decoded, 50u) << "the damage never reached a readable file";
}

TEST(HostileRecords, LimitsHoldForSlotsAndLoosePoints) {
  for (const auto& file : record_files()) {
    const auto scan = decode(file, kLimits);
    ASSERT_TRUE(scan) << scan.error().message;
    const DecodeLimits limits{scan->cloud->size() - 1, kLimits.max_bytes};
    const auto refused = decode(file, limits);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
  }
}

/// A few bytes that claim as many slots or points as a number holds.
TEST(HostileRecords, ClaimsAreNotBelieved) {
  const auto file_with = [](ChunkType type, const std::vector<std::byte>& payload) {
    CloudOrder none;
    ContainerWriter writer;
    if (type != ChunkType::order) writer.add(ChunkType::order, encode_order(none, {}));
    writer.add(type, payload);
    return std::move(writer).finish();
  };
  for (const std::uint64_t claim : {std::uint64_t{1} << 24, std::uint64_t{1} << 40, UINT64_MAX}) {
    ByteWriter order;
    order.write_varint(claim);
    order.write_varint(claim);
    order.write_varint(1);
    order.write(static_cast<std::uint8_t>(ScalarType::float32));
    order.write_varint(0);
    EXPECT_FALSE(decode(file_with(ChunkType::order, std::move(order).bytes()), kLimits));
    for (const ChunkType type : {ChunkType::loose, ChunkType::corrections}) {
      ByteWriter points;
      points.write(std::uint8_t{2});
      points.write(static_cast<std::uint8_t>(ScalarType::float32));
      points.write(std::uint8_t{0});
      points.write_varint(claim);
      points.write(std::int16_t{0});
      EXPECT_FALSE(decode(file_with(type, std::move(points).bytes()), kLimits));
    }
  }
}

/// A few hundred bytes, in whose settings every row has patches of 44 x 44 samples of its own.
TEST(HostileDecode, PatchesThatTakeForeverAreRefused) {
  constexpr std::size_t rows = 1024, cells = rows * 64;
  Parameters parameters;
  parameters.paper.rows = rows;
  parameters.paper.columns = 64;
  parameters.paper.max_range = {100, 0};
  parameters.paper.patch = 1;
  parameters.paper.upsample_rows = parameters.paper.upsample_columns = 16;
  parameters.paper.overlap = 14;
  std::vector<PatchFit> patches(cells);
  for (std::size_t i = 0; i < cells; i += 64) patches[i].coefficients.assign(256, 0.0);
  ContainerWriter writer;
  writer.add(ChunkType::sensor, *write_sensor(test::small_sensor()));
  writer.add(ChunkType::parameters, write_parameters(parameters));
  write_masks(CellMasks(rows, 64), writer);
  writer.add(ChunkType::patches, write_patches(patches));
  const Result<DecodedScan> scan = decode(std::move(writer).finish(), kLimits);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().code, ErrorCode::limit_exceeded);
}

TEST(HostileDecode, ErrorsNameTheChunkAndTheByte) {
  auto file = file_of(Profile::paper);
  file[file.size() / 2] ^= std::byte{1};
  const Result<DecodedScan> scan = decode(file, kLimits);
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().code, ErrorCode::corrupt);
  EXPECT_NE(scan.error().message.find("byte"), std::string::npos) << scan.error().message;
}

}  // namespace
}  // namespace curlidar
