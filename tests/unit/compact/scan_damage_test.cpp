// SPDX-License-Identifier: BSD-3-Clause
// Files that are cut off or damaged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "compact/scan_header.hpp"
#include "support/chunks.hpp"
#include "support/clouds.hpp"
#include "support/compact_files.hpp"
#include "support/compact_scans.hpp"

namespace curlidar::compact {
namespace {

using test::CompactScan;
using testing::HasSubstr;

/// Field and residuals in 2 x 2 segments, small enough to try everything.
std::vector<std::byte> small_file(std::int32_t residual_step = 800, std::uint32_t columns = 40) {
  const CompactScan scan = test::integer_street(18, columns);
  ScanSettings settings;
  settings.steps = {3000, residual_step, 0, 3, 8};
  settings.effort = 2;
  settings.bands = settings.sectors = 2;
  settings.threads = 1;
  return test::file_of(encode_scan(scan.image, scan.table, settings)->chunks);
}

Result<DecodedScan> decode_file(ByteSpan file, const ScanOptions& options = {}) {
  const auto container = read_container_prefix(file);
  if (!container) return container.error();
  return decode_scan(test::chunks_of(*container), {}, options);
}

TEST(ScanDamage, ACutFileDecodesUpToTheCut) {
  const std::vector<std::byte> file = small_file();
  ScanOptions options;
  options.threads = 1;
  const auto whole = decode_file(file, options);
  ASSERT_TRUE(whole) << whole.error().message;
  ASSERT_TRUE(whole->missing.empty());
  std::size_t known_before = 0, decodable = 0;
  for (std::size_t size = kHeaderSize; size < file.size(); ++size) {
    const auto cut = decode_file(ByteSpan(file).first(size), options);
    if (!cut) {
      // Only before the table is there.
      ASSERT_EQ(decodable, 0u) << cut.error().message;
      ASSERT_THAT(cut.error().message, HasSubstr("chunk, without which nothing"));
      continue;
    }
    ++decodable;
    std::size_t known = 0;
    for (std::size_t cell = 0; cell < whole->range.size(); ++cell) {
      if (cut->occupied[cell] != 0) {
        ASSERT_EQ(whole->occupied[cell], 1);
        ++known;
      }
      if (cut->range[cell] == 0) continue;
      ASSERT_EQ(cut->field_range[cell], whole->field_range[cell]);
      ASSERT_EQ(cut->surface[cell], whole->surface[cell]);
      known += 1;
      if (cut->range[cell] == cut->field_range[cell]) continue;
      ASSERT_EQ(cut->range[cell], whole->range[cell]);
      known += 1;
    }
    ASSERT_GE(known, known_before) << "byte " << size;
    known_before = known;
    // The end chunk and the last checksum may be cut off with nothing lost.
    ASSERT_EQ(cut->missing.empty(), cut->range == whole->range && size + 10 >= file.size()) << size;
  }
  EXPECT_GT(decodable, file.size() * 3 / 4);
  EXPECT_GT(known_before, 0u);
}

TEST(ScanDamage, MissingPartsAreNamed) {
  const std::vector<std::byte> file = small_file(800, 400);
  const auto container = read_container(file);
  ASSERT_TRUE(container);
  const std::vector<Chunk> fields = find_chunks(*container, ChunkType::compact_field);
  const std::size_t size = fields[2].offset + fields[2].payload.size() / 2;
  const auto cut = decode_file(ByteSpan(file).first(size));
  ASSERT_TRUE(cut);
  std::vector<std::string> names;
  for (const Missing& missing : cut->missing) names.push_back(to_string(missing));
  ASSERT_EQ(names.size(), 2u + 2 + 2);
  EXPECT_EQ(names[0], "the residual layer of rows 0..8, columns 0..199");
  EXPECT_THAT(names[2], testing::StartsWith("the field of rows 9..17, columns 0..199 from root"));
  EXPECT_EQ(names[4], "the field of rows 9..17, columns 200..399");
}

TEST(ScanDamage, SegmentsTooManyOrTooFewAreRefused) {
  const std::vector<std::byte> file = small_file();
  const auto container = read_container_prefix(file);
  ASSERT_TRUE(container);
  ScanChunks chunks = test::chunks_of(*container);
  ScanChunks more = chunks;
  more.chunks.push_back(more.chunks.back());
  auto refused = decode_scan(more);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("compact_residual chunk, byte"));
  ScanChunks fewer = chunks;
  fewer.chunks.pop_back();
  refused = decode_scan(fewer);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("3 compact_residual chunks for 4 segments"));
  fewer.complete = false;
  const auto partial = decode_scan(fewer);
  ASSERT_TRUE(partial);
  EXPECT_EQ(partial->missing.size(), 1u);
}

TEST(ScanDamage, AWholeChunkThatEndsEarlyIsCorrupt) {
  const std::vector<std::byte> file = small_file();
  const auto container = read_container_prefix(file);
  ASSERT_TRUE(container);
  // A mask this small may follow from a byte of it and zeros.
  for (const ScanPart part : {ScanPart::field, ScanPart::residual}) {
    ScanChunks chunks = test::chunks_of(*container);
    for (ScanChunkView& chunk : chunks.chunks) {
      if (chunk.part == part) chunk.payload = chunk.payload.first(1);
    }
    const auto refused = decode_scan(chunks);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
    EXPECT_THAT(refused.error().message, HasSubstr(to_string(part)));
  }
}

TEST(ScanDamage, LimitsAreCheckedBeforeAnything) {
  const std::vector<std::byte> file = small_file();
  const auto container = read_container_prefix(file);
  ASSERT_TRUE(container);
  const ScanChunks chunks = test::chunks_of(*container);
  EXPECT_TRUE(decode_scan(chunks, {18 * 40}));
  const auto refused = decode_scan(chunks, {18 * 40 - 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
}

TEST(ScanDamage, AFewBytesDoNotTakeTheMemoryOfManyCells) {
  ScanParameters parameters;
  RowTable table;
  parameters.rows = 1024;
  parameters.columns = table.turn_columns = 65536;
  parameters.step = 1000;
  table.elevation.resize(parameters.rows);
  const std::vector<std::byte> header = write_parameters(parameters, table);
  const std::vector<std::byte> rows = write_rows(table);
  const std::vector<std::byte> mask(40), field(40);
  ScanChunks chunks;
  chunks.chunks = {{ScanPart::parameters, header},
                   {ScanPart::sensor, rows},
                   {ScanPart::mask, mask, 77},
                   {ScanPart::field, field}};
  const auto refused = decode_scan(chunks);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "compact_mask chunk, byte 77: 40 bytes are too few for 67108864 cells");
}

TEST(ScanDamage, NoLimitAllowsMoreCellsThanHaveNumbers) {
  ScanParameters parameters;
  RowTable table;
  parameters.rows = kMaxRows;
  parameters.columns = table.turn_columns = kMaxTurnColumns;
  parameters.step = 1000;
  const std::vector<std::byte> header = write_parameters(parameters, table);
  ScanChunks chunks;
  chunks.chunks = {{ScanPart::parameters, header}};
  const auto refused = decode_scan_header(chunks, {UINT64_MAX});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
}

TEST(ScanDamage, AnyDamageEndsWell) {
  test::Random random(17);
  for (const std::int32_t residual_step : {0, 800}) {
    const std::vector<std::byte> file = small_file(residual_step);
    for (int round = 0; round < 600; ++round) {
      std::vector<std::byte> damaged = file;
      const std::size_t flips = 1 + random.below(4);
      for (std::size_t i = 0; i < flips; ++i) {
        const std::size_t at = kHeaderSize + random.below(damaged.size() - kHeaderSize);
        damaged[at] ^= static_cast<std::byte>(1 + random.below(255));
      }
      if (round % 3 == 0) damaged.resize(kHeaderSize + random.below(damaged.size() - kHeaderSize));
      damaged = test::with_right_checksums(damaged);
      const auto container = read_container_prefix(damaged);
      if (!container) continue;
      ScanOptions options;
      options.threads = 1;
      options.keep_nodes = true;
      const auto scan = decode_scan(test::chunks_of(*container), {1u << 16}, options);
      if (!scan) continue;
      ASSERT_LE(scan->range.size(), 1u << 16);
      for (std::size_t cell = 0; cell < scan->range.size(); ++cell) {
        ASSERT_GE(scan->range[cell], 0);
        ASSERT_LE(scan->range[cell], 1 << 30);
        ASSERT_LT(scan->surface[cell], static_cast<std::int64_t>(scan->surfaces.size()));
      }
    }
  }
}

TEST(ScanDamage, MeaninglessPayloadsEndWell) {
  test::Random random(23);
  const std::vector<std::byte> file = small_file();
  const auto container = read_container_prefix(file);
  ASSERT_TRUE(container);
  const ScanChunks good = test::chunks_of(*container);
  for (int round = 0; round < 300; ++round) {
    ScanChunks chunks = good;
    std::vector<std::vector<std::byte>> noise(chunks.chunks.size());
    for (std::size_t i = 0; i < chunks.chunks.size(); ++i) {
      ScanChunkView& chunk = chunks.chunks[i];
      if (chunk.part < ScanPart::mask || random.below(3) == 0) continue;
      noise[i].resize(random.below(600));
      const bool ones = random.below(4) == 0;
      for (std::byte& b : noise[i]) b = static_cast<std::byte>(ones ? 255 : random.next());
      chunk.payload = noise[i];
      chunk.whole = random.below(2) == 0;
    }
    ScanOptions options;
    options.threads = 1;
    const auto scan = decode_scan(chunks, {}, options);
    if (scan) {
      ASSERT_EQ(scan->range.size(), 18u * 40u);
    }
  }
}

}  // namespace
}  // namespace curlidar::compact
