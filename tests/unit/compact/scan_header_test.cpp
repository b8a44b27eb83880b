// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "compact/row_sequence.hpp"
#include "compact/scan_header.hpp"
#include "support/clouds.hpp"

namespace curlidar::compact {
namespace {

using testing::HasSubstr;

RowTable even_table(std::uint32_t rows, std::uint32_t columns) {
  RowTable table;
  table.turn_columns = columns;
  table.elevation_shift = 16;
  for (std::uint32_t k = 0; k < rows; ++k) {
    table.elevation.push_back((1 << 27) - static_cast<std::int32_t>(k << 22));
  }
  return table;
}

ScanChunkView view(ScanPart part, const std::vector<std::byte>& payload) {
  return {part, payload, 40, true};
}

struct Headers {
  ScanParameters parameters;
  RowTable table;
};

Headers read_back(const ScanParameters& parameters, const RowTable& table) {
  const auto bytes = write_parameters(parameters, table);
  auto header = read_parameters(view(ScanPart::parameters, bytes), {});
  EXPECT_TRUE(header) << header.error().message;
  const auto rows = write_rows(table);
  const Status status = read_rows(view(ScanPart::sensor, rows), parameters.rows, header->table);
  EXPECT_TRUE(status) << status.error().message;
  return {header->parameters, header->table};
}

TEST(ScanHeader, ComesBackWithEveryFlag) {
  ScanParameters p;
  p.rows = 3;
  p.columns = 500;
  p.step = 3277;
  RowTable table = even_table(3, 500);
  for (int flags = 0; flags < 32; ++flags) {
    ScanParameters with = p;
    RowTable t = table;
    if (flags & 1) with.residual_step = 300;
    if (flags & 2) {
      with.bands = 3;
      with.sectors = 7;
    }
    if (flags & 4) {
      t.turn_columns = 2000;
      t.first_column = 1999;
    }
    if (flags & 8) {
      t.height = {-4096, 0, 8192};
      t.height_shift = 12;
      t.range_offset = {-77, 5, 1 << 22};
    }
    if (flags & 16) {
      with.lattice_q32 = (std::uint64_t{1} << 32) / 500;
      with.residual_step = static_cast<std::int32_t>(with.lattice_q32 >> 16);
    }
    ASSERT_TRUE(check_header(with, t)) << check_header(with, t).error().message;
    const Headers back = read_back(with, t);
    EXPECT_TRUE(back.parameters == with) << flags;
    EXPECT_TRUE(back.table == t) << flags;
  }
}

TEST(ScanHeader, TablesOfEvenRingsTakeFewBytes) {
  EXPECT_LE(write_rows(even_table(128, 1024)).size(), 14u);
}

TEST(ScanHeader, TablesOfAnyNumbersComeBack) {
  test::Random random(5);
  for (int round = 0; round < 200; ++round) {
    const auto rows = static_cast<std::uint32_t>(1 + random.below(40));
    RowTable table;
    table.turn_columns = 100;
    table.elevation_shift = static_cast<std::uint32_t>(random.below(kMaxTableShift + 1));
    const auto fill = [&](std::vector<std::int32_t>& values, std::int32_t limit) {
      for (std::uint32_t k = 0; k < rows; ++k) {
        values.push_back(static_cast<std::int32_t>(random.below(2 * std::uint64_t(limit))) - limit);
      }
    };
    fill(table.elevation, kMaxElevation / 2);
    if (round % 2 == 0) {
      table.height_shift = static_cast<std::uint32_t>(random.below(20));
      fill(table.height, kMaxRowOffset / 2);
    }
    if (round % 3 == 0) {
      table.offset_shift = static_cast<std::uint32_t>(random.below(20));
      fill(table.range_offset, kMaxRowOffset / 2);
    }
    round_to_shifts(table);
    ScanParameters p;
    p.rows = rows;
    p.columns = 100;
    p.step = 1;
    ASSERT_TRUE(check_header(p, table)) << check_header(p, table).error().message;
    EXPECT_TRUE(read_back(p, table).table == table) << round;
  }
}

TEST(ScanHeader, RoundingGoesToTheNearestMultiple) {
  RowTable table;
  table.elevation = {7, 8, -7, -9, 24};
  table.elevation_shift = 4;
  round_to_shifts(table);
  EXPECT_EQ(table.elevation, (std::vector<std::int32_t>{0, 16, 0, -16, 32}));
}

TEST(ScanHeader, SegmentsCoverEveryCellOnce) {
  ScanParameters p;
  p.rows = 7;
  p.columns = 23;
  p.bands = 3;
  p.sectors = 5;
  std::vector<int> seen(7 * 23, 0);
  for (const SegmentPlace& s : segments_of(p)) {
    EXPECT_GT(s.cells(), 0u);
    for (std::uint32_t i = 0; i < s.rows; ++i) {
      for (std::uint32_t j = 0; j < s.columns; ++j) ++seen[(s.row + i) * 23 + s.column + j];
    }
  }
  EXPECT_THAT(seen, testing::Each(1));
}

std::string fault_of(const std::vector<std::byte>& payload, std::uint64_t max_cells = 1u << 20) {
  const auto header = read_parameters(view(ScanPart::parameters, payload), {max_cells});
  EXPECT_FALSE(header);
  return header ? "" : header.error().message;
}

TEST(ScanHeader, RefusesParametersThatMakeNoSense) {
  ScanParameters p;
  p.rows = 64;
  p.columns = 1024;
  p.step = 3277;
  const RowTable table = even_table(64, 1024);
  const auto good = write_parameters(p, table);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_THAT(fault_of({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}),
                HasSubstr("compact_parameters chunk, byte 4"));
  }
  auto longer = good;
  longer.push_back(std::byte{0});
  EXPECT_THAT(fault_of(longer), HasSubstr("1 unexpected bytes"));
  EXPECT_THAT(fault_of(good, 65535), HasSubstr("limit of 65535"));
  auto reserved = good;
  reserved[0] |= std::byte{0x80};
  EXPECT_THAT(fault_of(reserved), HasSubstr("later version"));

  const auto with = [&](auto change) {
    ScanParameters changed = p;
    change(changed);
    return fault_of(write_parameters(changed, table));
  };
  EXPECT_THAT(with([](auto& q) { q.rows = 0; }), HasSubstr("0 rows"));
  EXPECT_THAT(with([](auto& q) { q.rows = kMaxRows + 1; }), HasSubstr("rows"));
  EXPECT_THAT(with([](auto& q) { q.columns = 1025; }), HasSubstr("columns"));
  EXPECT_THAT(with([](auto& q) { q.step = 0; }), HasSubstr("field step"));
  EXPECT_THAT(with([](auto& q) { q.step = kMaxStep + 1; }), HasSubstr("field step"));
  EXPECT_THAT(with([](auto& q) { q.residual_step = kMaxStep + 1; }), HasSubstr("residual step"));
  EXPECT_THAT(with([](auto& q) { q.root_log2 = 6; }), HasSubstr("roots"));
  EXPECT_THAT(with([](auto& q) { q.smallest_leaf = 0; }), HasSubstr("smallest leaf"));
  EXPECT_THAT(with([](auto& q) { q.bands = 65; }), HasSubstr("segments"));
  EXPECT_THAT(with([](auto& q) { q.bands = 64, q.sectors = 65; }), HasSubstr("segments"));
  EXPECT_THAT(with([](auto& q) { q.residual_step = 1, q.lattice_q32 = 1; }),
              HasSubstr("residual step"));
}

TEST(ScanHeader, RefusesTablesThatAFileCannotHold) {
  ScanParameters p;
  p.rows = 4;
  p.columns = 64;
  p.step = 100;
  const RowTable table = even_table(4, 64);
  EXPECT_TRUE(check_header(p, table));
  const auto with = [&](auto change) {
    RowTable changed = table;
    change(changed);
    const Status status = check_header(p, changed);
    EXPECT_FALSE(status);
    return status ? std::string() : status.error().message;
  };
  EXPECT_THAT(with([](auto& t) { t.elevation.pop_back(); }), HasSubstr("3 rows"));
  EXPECT_THAT(with([](auto& t) { t.height.resize(3); }), HasSubstr("one number for each row"));
  EXPECT_THAT(with([](auto& t) { t.elevation[2] += 1; }), HasSubstr("not a multiple of 2^16"));
  EXPECT_THAT(with([](auto& t) { t.elevation[2] = INT32_MIN; }), HasSubstr("out of range"));
  EXPECT_THAT(with([](auto& t) { t.range_offset.resize(4, kMaxRowOffset + 1); }),
              HasSubstr("range offset of row 0"));
}

TEST(ScanHeader, AnyBytesOfATableEndWell) {
  test::Random random(9);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::byte> payload(random.below(60));
    for (std::byte& b : payload) b = static_cast<std::byte>(random.next());
    if (!payload.empty()) payload[0] &= std::byte{3};
    RowTable table;
    const Status status = read_rows(view(ScanPart::sensor, payload), 64, table);
    if (!status) {
      EXPECT_THAT(status.error().message, HasSubstr("compact_sensor chunk, byte 40"));
      continue;
    }
    for (const std::int32_t e : table.elevation) EXPECT_LE(std::abs(e), kMaxElevation);
  }
}

TEST(ScanHeader, IndexKnowsEverySize) {
  const std::vector<std::uint64_t> sizes = {0, 127, 128, 300000, 5, 1};
  const auto bytes = write_index(sizes);
  const auto back = read_index(view(ScanPart::index, bytes), sizes.size());
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, sizes);
  EXPECT_FALSE(read_index(view(ScanPart::index, bytes), 5));
  EXPECT_FALSE(read_index(view(ScanPart::index, bytes), 7));
}

}  // namespace
}  // namespace curlidar::compact
