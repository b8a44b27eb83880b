// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "support/clouds.hpp"
#include "support/compact_files.hpp"
#include "support/compact_scans.hpp"

namespace curlidar::compact {
namespace {

using test::CompactScan;
using test::integer_street;
using test::views_of;
using testing::HasSubstr;

ScanSettings settings_for(double error_m, std::uint32_t effort = 2) {
  ScanSettings settings;
  settings.steps = steps_for_error(static_cast<std::int64_t>(error_m * kRangeUnit));
  settings.effort = effort;
  settings.bands = settings.sectors = 1;
  settings.threads = 1;
  return settings;
}

EncodedScan encoded(const CompactScan& scan, const ScanSettings& settings) {
  auto out = encode_scan(scan.image, scan.table, settings);
  EXPECT_TRUE(out) << out.error().message;
  return out ? std::move(*out) : EncodedScan{};
}

DecodedScan decoded(const EncodedScan& scan, const ScanOptions& options = {}) {
  auto out = decode_scan(views_of(scan.chunks), {}, options);
  EXPECT_TRUE(out) << out.error().message;
  return out ? std::move(*out) : DecodedScan{};
}

/// Everything that a decoder says of the cells fits together.
void expect_consistent(const DecodedScan& scan) {
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    const bool known = scan.range[cell] != 0;
    ASSERT_EQ(known, scan.field_range[cell] != 0);
    ASSERT_EQ(known, scan.surface[cell] != kNoSurface);
    ASSERT_EQ(known, scan.leaf[cell] >= 0);
    ASSERT_LE(known, scan.occupied[cell] != 0);
    if (!known) continue;
    const auto surface = static_cast<std::uint32_t>(scan.surface[cell]);
    ASSERT_LT(surface, scan.surfaces.size());
    const DecodedLeaf& leaf = scan.leaves[static_cast<std::size_t>(scan.leaf[cell])];
    ASSERT_GE(surface, leaf.first_surface);
    ASSERT_LT(surface, leaf.first_surface + leaf.layers);
    if (!leaf.has_residual) {
      ASSERT_EQ(scan.range[cell], scan.field_range[cell]);
    }
  }
}

class AtErrors : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Regimes, AtErrors, testing::Values(.05, .015, .003));

TEST_P(AtErrors, DecoderSeesWhatTheEncoderSays) {
  const CompactScan scan = integer_street(33, 150);
  const EncodedScan written = encoded(scan, settings_for(GetParam()));
  const DecodedScan read = decoded(written);
  EXPECT_EQ(read.range, written.decoded.range);
  EXPECT_TRUE(read.missing.empty());
  EXPECT_TRUE(read.table == scan.table);
  expect_consistent(read);
  for (std::size_t cell = 0; cell < read.range.size(); ++cell) {
    ASSERT_EQ(read.range[cell] != 0, scan.image.range[cell] != 0);
  }
  const double error = test::mean_error(scan.image, read.range) / kRangeUnit;
  EXPECT_LT(error, 2 * GetParam());
  EXPECT_GT(error, GetParam() / 20);
}

TEST_P(AtErrors, BreakdownAddsUpToTheFile) {
  ScanSettings settings = settings_for(GetParam());
  settings.sectors = 3;
  const EncodedScan written = encoded(integer_street(20, 150), settings);
  const std::size_t outside = kHeaderSize + 6;  // magic and version; the end chunk
  const auto file = test::file_of(written.chunks);
  EXPECT_NEAR(test::total_bits(written.breakdown), 8 * static_cast<double>(file.size() - outside),
              1e-6);
  EXPECT_EQ(written.breakdown.residual > 0, GetParam() < .03);
  EXPECT_GT(written.breakdown.header, 0);
  const EncodeStatistics& s = written.statistics;
  std::uint64_t layers = 0, with_functions = 0, by_size = 0;
  for (std::size_t k = 0; k < kMaxLayers; ++k) layers += (k + 1) * s.leaves_by_layers[k];
  for (const std::uint64_t n : s.layers_by_functions) with_functions += n;
  for (const std::uint64_t n : s.leaves_by_size) by_size += n;
  EXPECT_EQ(layers, with_functions);
  EXPECT_EQ(by_size, s.leaves);
  EXPECT_EQ(decoded(written).leaves.size(), s.leaves);
}

TEST_P(AtErrors, SegmentsAreTheSameForAnyNumberOfThreads) {
  const CompactScan scan = integer_street(24, 130);
  ScanSettings settings = settings_for(GetParam());
  settings.bands = 2;
  settings.sectors = 3;
  const EncodedScan one = encoded(scan, settings);
  settings.threads = 4;
  const EncodedScan four = encoded(scan, settings);
  ASSERT_EQ(one.chunks.size(), four.chunks.size());
  for (std::size_t i = 0; i < one.chunks.size(); ++i) {
    EXPECT_EQ(one.chunks[i].payload, four.chunks[i].payload);
  }
  ScanOptions options;
  options.threads = 4;
  const DecodedScan read = decoded(one, options);
  EXPECT_EQ(read.range, one.decoded.range);
  EXPECT_EQ(read.segments.size(), 6u);
  expect_consistent(read);
}

TEST_P(AtErrors, ASegmentAloneIsTheSameAsAmongOthers) {
  const CompactScan scan = integer_street(24, 130);
  ScanSettings settings = settings_for(GetParam());
  settings.bands = 2;
  settings.sectors = 3;
  const EncodedScan written = encoded(scan, settings);
  const DecodedScan all = decoded(written);
  for (const DecodedSegment& segment : all.segments) {
    const SegmentPlace& p = segment.place;
    ScanOptions options;
    options.region = Region{p.row, p.row + p.rows, p.column, p.column + p.columns};
    // Only its own chunks are looked at: the others' bytes are gone.
    ScanChunks chunks = views_of(written.chunks);
    std::map<ScanPart, std::uint32_t> seen;
    for (ScanChunkView& chunk : chunks.chunks) {
      if (chunk.part < ScanPart::mask) continue;
      if (seen[chunk.part]++ != static_cast<std::uint32_t>(&segment - all.segments.data())) {
        chunk.payload = {};
      }
    }
    const auto alone = decode_scan(chunks, {}, options);
    ASSERT_TRUE(alone) << alone.error().message;
    for (std::uint32_t row = 0; row < 24; ++row) {
      for (std::uint32_t column = 0; column < 130; ++column) {
        const bool inside = row >= p.row && row < p.row + p.rows && column >= p.column &&
                            column < p.column + p.columns;
        const std::size_t cell = row * 130 + column;
        ASSERT_EQ(alone->range[cell], inside ? all.range[cell] : 0);
      }
    }
  }
}

TEST(ScanCodec, RegionsMayCutThroughSegments) {
  const CompactScan scan = integer_street(24, 130);
  ScanSettings settings = settings_for(.05);
  settings.bands = settings.sectors = 2;
  const EncodedScan written = encoded(scan, settings);
  const DecodedScan all = decoded(written);
  ScanOptions options;
  options.region = Region{5, 9, 10, UINT32_MAX};
  const DecodedScan part = decoded(written, options);
  EXPECT_FALSE(part.segments[2].wanted);
  EXPECT_TRUE(part.segments[1].wanted);
  for (std::uint32_t row = 0; row < 24; ++row) {
    for (std::uint32_t column = 0; column < 130; ++column) {
      const bool inside = row >= 5 && row < 9 && column >= 10;
      const std::size_t cell = row * 130 + column;
      ASSERT_EQ(part.range[cell], inside ? all.range[cell] : 0);
    }
  }
  options.region = Region{9, 5, 0, 10};
  EXPECT_THAT(decoded(written, options).range, testing::Each(0));
}

TEST(ScanCodec, FieldOnlyIsTheFieldOfTheWhole) {
  const CompactScan scan = integer_street(24, 130);
  for (const double error : {.015, .003}) {
    const EncodedScan written = encoded(scan, settings_for(error));
    ScanOptions options;
    options.field_only = true;
    const DecodedScan coarse = decoded(written, options);
    const DecodedScan fine = decoded(written);
    EXPECT_EQ(coarse.range, fine.field_range);
    EXPECT_EQ(coarse.field_range, fine.field_range);
    EXPECT_TRUE(coarse.missing.empty());
    EXPECT_LT(test::mean_error(scan.image, fine.range),
              .7 * test::mean_error(scan.image, coarse.range));
  }
}

TEST(ScanCodec, OffsetsOfRowsAreTakenOutAndPutBack) {
  CompactScan scan = integer_street(24, 200, 100);
  const EncodedScan plain = encoded(scan, settings_for(.03));
  for (std::uint32_t row = 0; row < 24; ++row) {
    const std::int32_t offset = (row % 2 == 0 ? 1 : -1) * 8192;
    scan.table.range_offset.push_back(offset);
    for (std::uint32_t column = 0; column < 200; ++column) {
      std::int32_t& range = scan.image.range[row * 200 + column];
      if (range != 0) range += offset;
    }
  }
  scan.table.offset_shift = 10;
  const EncodedScan shifted = encoded(scan, settings_for(.03));
  // The same payloads but for the table.
  for (std::size_t i = 2; i < plain.chunks.size(); ++i) {
    EXPECT_EQ(plain.chunks[i].payload, shifted.chunks[i].payload);
  }
  EXPECT_EQ(test::mean_error(scan.image, decoded(shifted).range),
            test::mean_error(integer_street(24, 200, 100).image, decoded(plain).range));
}

TEST(ScanCodec, RangesOnALatticeComeBackExactly) {
  CompactScan scan = integer_street(20, 100);
  const std::uint64_t lattice = (std::uint64_t{1} << 32) / 500;  // 2 mm
  for (std::int32_t& range : scan.image.range) {
    if (range == 0) continue;
    const std::uint64_t levels = (static_cast<std::uint64_t>(range) << 16) / lattice;
    range = static_cast<std::int32_t>((levels * lattice + (1u << 15)) >> 16);
  }
  for (std::uint32_t row = 0; row < 20; ++row) {
    scan.table.range_offset.push_back(static_cast<std::int32_t>(row * 100));
  }
  ScanSettings settings = settings_for(.002);
  settings.steps.lattice_q32 = lattice;
  settings.lambda_per_mille = 0;
  const DecodedScan read = decoded(encoded(scan, settings));
  std::size_t exact = 0;
  for (std::size_t cell = 0; cell < read.range.size(); ++cell) {
    exact += read.range[cell] == scan.image.range[cell];
  }
  EXPECT_EQ(exact, read.range.size());
}

TEST(ScanCodec, PartsOfATurnKnowWhereTheyLook) {
  CompactScan scan = integer_street(16, 64);
  scan.table.turn_columns = 256;
  scan.table.first_column = 224;  // across the seam
  const EncodedScan written = encoded(scan, settings_for(.05));
  const DecodedScan read = decoded(written);
  EXPECT_EQ(read.range, written.decoded.range);
  EXPECT_TRUE(read.table == scan.table);
}

TEST(ScanCodec, SmallAndEmptyImages) {
  for (const std::uint32_t rows : {1u, 2u}) {
    for (const std::uint32_t columns : {1u, 3u, 40u}) {
      CompactScan scan = integer_street(rows, columns);
      for (const bool empty : {false, true}) {
        if (empty) std::fill(scan.image.range.begin(), scan.image.range.end(), 0);
        for (const double error : {.05, .003}) {
          const EncodedScan written = encoded(scan, settings_for(error));
          const DecodedScan read = decoded(written);
          EXPECT_EQ(read.range, written.decoded.range);
          expect_consistent(read);
        }
      }
    }
  }
}

TEST(ScanCodec, RefusesWhatItCannotEncode) {
  CompactScan scan = integer_street(8, 32);
  ScanSettings settings = settings_for(.05);
  scan.image.range[3] = -1;
  auto refused = encode_scan(scan.image, scan.table, settings);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("row 0, column 3"));
  scan.image.range.pop_back();
  EXPECT_FALSE(encode_scan(scan.image, scan.table, settings));
  scan = integer_street(8, 32);
  settings.sectors = 33;
  EXPECT_FALSE(encode_scan(scan.image, scan.table, settings));
  settings.sectors = 1;
  settings.steps.step = 0;
  EXPECT_FALSE(encode_scan(scan.image, scan.table, settings));
}

TEST(ScanCodec, NodesAreKeptWhenAskedFor) {
  const EncodedScan written = encoded(integer_street(20, 70), settings_for(.05));
  EXPECT_TRUE(decoded(written).segments[0].nodes.empty());
  ScanOptions options;
  options.keep_nodes = true;
  EXPECT_EQ(decoded(written, options).segments[0].nodes.size(), 2u * 5u);
}

TEST(ScanCodec, IndexFindsEveryChunk) {
  ScanSettings settings = settings_for(.015);
  settings.sectors = 4;
  const EncodedScan written = encoded(integer_street(16, 128), settings);
  const std::vector<std::byte> file = test::file_of(written.chunks);
  const auto container = read_container(file);
  ASSERT_TRUE(container);
  const Chunk* at = find_chunk(*container, ChunkType::compact_index);
  ASSERT_NE(at, nullptr);
  const std::size_t base = at->offset + at->payload.size() + 4;
  const auto index = decode_scan_index(views_of(written.chunks));
  ASSERT_TRUE(index);
  ASSERT_TRUE(*index);
  ASSERT_EQ((*index)->size(), 12u);
  std::size_t i = container->size() - 12;
  for (const IndexedChunk& entry : **index) {
    const Chunk& chunk = (*container)[i++];
    EXPECT_EQ(static_cast<std::uint8_t>(entry.part), static_cast<std::uint8_t>(chunk.type));
    EXPECT_EQ(base + entry.offset, chunk.offset);
    EXPECT_EQ(entry.size, chunk.payload.size());
  }
  settings.index = false;
  const EncodedScan plain = encoded(integer_street(16, 128), settings);
  const auto none = decode_scan_index(views_of(plain.chunks));
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

}  // namespace
}  // namespace curlidar::compact
