// SPDX-License-Identifier: BSD-3-Clause
#include "compact/ray_chunk.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "compact/firing_list.hpp"
#include "compact/ray_tables.hpp"
#include "compact/scan_decoder.hpp"
#include "compact/scan_encoder.hpp"
#include "support/clouds.hpp"
#include "support/ray_tables.hpp"

namespace curlidar::compact {
namespace {

using test::rows_of;
using test::set_motion;
using test::turning;

std::vector<std::byte> firing_bytes(const std::vector<std::uint32_t>& firings,
                                    std::uint32_t slots) {
  RangeEncoder encoder;
  write_firings(encoder, firings, slots);
  return std::move(encoder).finish();
}

void expect_firings_come_back(const std::vector<std::uint32_t>& firings, std::uint32_t slots,
                              double most_bits_each) {
  const auto bytes = firing_bytes(firings, slots);
  const auto count = static_cast<std::uint32_t>(firings.size());
  EXPECT_LE(8 * static_cast<double>(bytes.size()), most_bits_each * count + 24) << count;
  RangeDecoder decoder(bytes);
  std::vector<std::uint32_t> found;
  ASSERT_TRUE(read_firings(decoder, count, slots, found));
  EXPECT_TRUE(decoder.finished());
  EXPECT_EQ(found, firings);
}

TEST(FiringList, ComesBackAndCostsWhatIsNew) {
  expect_firings_come_back(turning(4000, 1.857, 0), 4000, .12);
  expect_firings_come_back(turning(36000, 16.67, 2), 36000, 2.0);
  expect_firings_come_back(turning(2000, 1, 0), 2000, .012);
  expect_firings_come_back(turning(36000, 18, 0), 36000, .015);
  expect_firings_come_back({0}, 1, 0);
  expect_firings_come_back({kMaxSlots - 1}, kMaxSlots, 40);
  expect_firings_come_back({0, 1, 2, 100, 3999}, 4000, 40);
  expect_firings_come_back({5, 100000, 100001, kMaxSlots - 1}, kMaxSlots, 40);
}

TEST(FiringList, AnyListComesBack) {
  test::Random random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const auto slots = static_cast<std::uint32_t>(1 + random.below(3000));
    const std::uint64_t share = 1 + random.below(20);
    std::vector<std::uint32_t> firings;
    for (std::uint32_t i = 0; i < slots; ++i) {
      if (random.below(20) < share) firings.push_back(i);
    }
    if (!firings.empty()) expect_firings_come_back(firings, slots, 30);
  }
}

RowTable inline_table() {
  return test::inline_rays(32, turning(36000, 16.67, 2), 36000);
}

RowTable frozen_table() {
  return test::frozen_rays(1, turning(4000, 1.857, 0));
}

Status read_back(ByteSpan payload, const RowTable& wanted, RowTable& found) {
  found.turn_columns = wanted.turn_columns;
  found.first_column = wanted.first_column;
  return read_rays({ScanPart::rays, payload, 100}, rows_of(wanted), wanted.turn_columns, found);
}

TEST(RayChunk, ComesBack) {
  for (const bool frozen : {false, true}) {
    for (const int motion : {0, 1, 2}) {
      for (const bool unit : {false, true}) {
        RowTable table = frozen ? frozen_table() : inline_table();
        if (motion > 0) set_motion(*table.rays, motion == 2);
        if (!unit) table.rays->range_unit_q48 = 0;
        const auto checked = check_rays(table, rows_of(table), table.turn_columns);
        ASSERT_TRUE(checked) << checked.error().message;
        RowTable found;
        const auto payload = write_rays(table);
        const auto status = read_back(payload, table, found);
        ASSERT_TRUE(status) << status.error().message;
        EXPECT_EQ(found, table);
        // A turn of KITTI's sensor with the vehicle's motion is a matter of some 60 bytes.
        if (frozen && motion < 2) {
          EXPECT_LT(payload.size(), 75u);
        }
      }
    }
  }
}

TEST(RayChunk, RepeatingRowsCostLittle) {
  RowTable table = inline_table();
  const std::size_t with = write_rays(table).size();
  for (Ray& ray : table.rays->rays) ray.azimuth_offset = ray.lateral = 0;
  EXPECT_LT(with, write_rays(table).size() + 24);
}

TEST(RayChunk, RefusesWhatItCannotHold) {
  const auto refused = [](auto change) {
    RowTable table = inline_table();
    change(table, *table.rays);
    return !check_rays(table, 32, static_cast<std::uint32_t>(inline_table().turn_columns));
  };
  EXPECT_FALSE(refused([](RowTable&, RayTable&) {}));
  EXPECT_TRUE(refused([](RowTable& t, RayTable&) { t.elevation[3] += 1; }));
  EXPECT_TRUE(refused([](RowTable& t, RayTable&) { t.elevation.pop_back(); }));
  EXPECT_TRUE(refused([](RowTable& t, RayTable&) { t.height.resize(32); }));
  EXPECT_TRUE(refused([](RowTable& t, RayTable&) { t.first_column = 1; }));
  EXPECT_TRUE(refused([](RowTable& t, RayTable&) { ++t.turn_columns; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.rays.pop_back(); }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.rays[0].azimuth_offset += 4; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.rays[5].lateral = kMaxRowOffset + 1; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.phase_shift = 25; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.slots = 0; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.slots = kMaxSlots + 1; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.slots = r.firings.back(); }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.firings.pop_back(); }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { std::swap(r.firings[4], r.firings[5]); }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.motion.turn[0] = kMostMotion + 1; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.turn_shift = 1; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.table = 1; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.table = 1000; }));
  EXPECT_TRUE(refused([](RowTable&, RayTable& r) { r.range_unit_q48 = 1; }));
}

TEST(RayChunk, DamagedBytesAreAnErrorOrAValidTable) {
  test::Random random(3);
  for (const bool frozen : {false, true}) {
    RowTable table = frozen ? frozen_table() : inline_table();
    set_motion(*table.rays, !frozen);
    const auto payload = write_rays(table);
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
      auto damaged = payload;
      if (i % 4 == 0) damaged.resize(random.below(payload.size()));
      for (std::uint64_t k = random.below(4); k-- > 0 && !damaged.empty();) {
        damaged[random.below(damaged.size())] = static_cast<std::byte>(random.next());
      }
      RowTable found;
      const auto status = read_back(damaged, table, found);
      if (!status) {
        EXPECT_NE(status.error().message.find("compact_rays chunk, byte 100"), std::string::npos);
        ++refused;
      } else {
        const auto checked = check_rays(found, rows_of(table), table.turn_columns);
        EXPECT_TRUE(checked) << checked.error().message;
      }
    }
    EXPECT_GT(refused, 100);
  }
}

TEST(RayChunk, ReadersRefuseWhatDoesNotGoTogether) {
  const RowTable table = frozen_table();
  const auto payload = write_rays(table);
  const auto code_of = [&](std::vector<std::byte> bytes, std::uint32_t rows,
                           std::uint32_t columns) {
    RowTable found;
    found.turn_columns = table.turn_columns;
    const auto status = read_rays({ScanPart::rays, bytes, 0}, rows, columns, found);
    return status ? ErrorCode::io : status.error().code;
  };
  const auto with = [&](std::size_t at, int value) {
    auto bytes = payload;
    bytes[at] = static_cast<std::byte>(value);
    return bytes;
  };
  EXPECT_EQ(code_of(payload, 64, table.turn_columns), ErrorCode::io);  // that is, none
  EXPECT_EQ(code_of(payload, 63, table.turn_columns), ErrorCode::corrupt);
  EXPECT_EQ(code_of(payload, 64, table.turn_columns + 1), ErrorCode::corrupt);
  EXPECT_EQ(code_of({}, 64, table.turn_columns), ErrorCode::corrupt);
  EXPECT_EQ(code_of(with(0, 1 | 16), 64, table.turn_columns), ErrorCode::unsupported);
  EXPECT_EQ(code_of(with(0, 1 | 4), 64, table.turn_columns), ErrorCode::corrupt);
  EXPECT_EQ(code_of(with(1, 0), 64, table.turn_columns), ErrorCode::unsupported);
  EXPECT_EQ(code_of(with(1, 99), 64, table.turn_columns), ErrorCode::unsupported);
  auto longer = payload;
  longer.insert(longer.end(), 8, std::byte{0});
  EXPECT_EQ(code_of(longer, 64, table.turn_columns), ErrorCode::corrupt);
}

/// A wall around the sensor and the ground, on the rays of a table.
Image walls(const RowTable& table) {
  Image image{rows_of(table), table.turn_columns, {}};
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    for (std::uint32_t column = 0; column < image.columns; ++column) {
      const bool hole = (row * 31 + column) % 29 == 0;
      const std::int32_t wall = 12 * 65536 + static_cast<std::int32_t>(column % 64) * 300;
      image.range.push_back(hole ? 0 : wall);
    }
  }
  return image;
}

std::vector<ScanChunkView> views_of(const std::vector<ScanChunk>& chunks) {
  std::vector<ScanChunkView> views;
  for (const ScanChunk& chunk : chunks) views.push_back({chunk.part, chunk.payload, 0});
  return views;
}

TEST(RayScan, ComesBackThroughTheWholeCoder) {
  RowTable table = inline_table();
  set_motion(*table.rays, true);
  table.offset_shift = 4;
  table.range_offset.assign(32, 16);
  ScanSettings settings;
  settings.steps.step = 2000;
  settings.effort = 1;
  settings.threads = 1;
  const auto encoded = encode_scan(walls(table), table, settings);
  ASSERT_TRUE(encoded) << encoded.error().message;
  double bytes = 0;
  for (const ScanChunk& chunk : encoded->chunks) {
    bytes += static_cast<double>(chunk.payload.size()) + 6;  // about what a container adds
  }
  const Breakdown& b = encoded->breakdown;
  EXPECT_NEAR(
      (b.header + b.mask + b.partition + b.modes + b.coefficients + b.labels + b.residual) / 8,
      bytes, 16);
  ASSERT_GE(encoded->chunks.size(), 3u);
  EXPECT_EQ(encoded->chunks[2].part, ScanPart::rays);

  ScanChunks chunks{views_of(encoded->chunks)};
  const auto decoded = decode_scan(chunks);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->table, table);
  EXPECT_EQ(decoded->range, encoded->decoded.range);

  // Without the chunk of the rays nothing can be decoded; a file without rays must not have one.
  ScanChunks without = chunks;
  without.chunks.erase(without.chunks.begin() + 2);
  EXPECT_FALSE(decode_scan(without));
  const std::byte no_flags{0};
  ScanChunks beside = chunks;
  beside.chunks[1].payload = {&no_flags, 1};
  EXPECT_FALSE(decode_scan(beside));
}

}  // namespace
}  // namespace curlidar::compact
