// SPDX-License-Identifier: BSD-3-Clause
#include "records/order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include "records/grid.hpp"

namespace curlidar {
namespace {

constexpr std::uint64_t kManySlots = 1u << 22;

/// A grid with its own cells.
struct Cells {
  std::uint32_t rows, columns;
  std::vector<std::uint8_t> occupied;
  std::size_t loose = 0;

  CellGrid grid() const { return {rows, columns, occupied, loose}; }
  /// Record of each cell.
  std::vector<std::uint32_t> records() const {
    std::vector<std::uint32_t> numbers(occupied.size());
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = next;
      if (occupied[i] != 0) ++next;
    }
    return numbers;
  }
};

Cells cells_of(std::uint32_t rows, std::uint32_t columns, unsigned percent, std::size_t loose = 0) {
  Cells cells{rows, columns, std::vector<std::uint8_t>(rows * columns), loose};
  std::mt19937 random(7);
  for (auto& cell : cells.occupied) cell = random() % 100 < percent ? 1 : 0;
  return cells;
}

CloudOrder order_with(std::vector<std::uint32_t> record) {
  CloudOrder order;
  order.kind.assign(record.size(), SlotKind::point);
  order.record = std::move(record);
  order.width = order.record.size();
  return order;
}

/// Coded and decoded; its size in bits.
std::size_t check(const CloudOrder& order, const CellGrid& grid) {
  const std::vector<std::byte> bytes = encode_order(order, grid);
  const auto decoded = decode_order({ChunkType::order, bytes, 0}, grid, kManySlots);
  EXPECT_TRUE(decoded && *decoded == order) << (decoded ? "differs" : decoded.error().message);
  return 8 * bytes.size();
}

TEST(Order, EmptyCloud) {
  EXPECT_LE(check(CloudOrder{}, CellGrid{}), 64u);
  EXPECT_LE(check(CloudOrder{}, Cells{2, 3, std::vector<std::uint8_t>(6)}.grid()), 96u);
}

TEST(Order, RecordsInTheirOwnOrderCostNothing) {
  const Cells cells = cells_of(64, 500, 70, 100);
  std::vector<std::uint32_t> record(cells.grid().records());
  std::iota(record.begin(), record.end(), 0u);
  EXPECT_LE(check(order_with(record), cells.grid()), 900u);
  EXPECT_LE(check(order_with(record), CellGrid{0, 0, {}, record.size()}), 400u);
}

/// Slots of the cells of a walk; empty ones give slots where `emits` says so.
CloudOrder along(const Cells& cells, bool by_column,
                 const std::function<std::uint32_t(std::uint32_t)>& row_at,
                 const std::function<std::uint32_t(std::uint32_t)>& start,
                 const std::function<bool(std::uint32_t)>& emits) {
  const auto numbers = cells.records();
  CloudOrder order;
  const std::uint32_t outer = by_column ? cells.columns : cells.rows;
  const std::uint32_t inner = by_column ? cells.rows : cells.columns;
  for (std::uint32_t a = 0; a < outer; ++a) {
    for (std::uint32_t b = 0; b < inner; ++b) {
      const std::uint32_t row = row_at(by_column ? b : a);
      const std::uint32_t cell =
          row * cells.columns + (start(row) + (by_column ? a : b)) % cells.columns;
      if (cells.occupied[cell] != 0) {
        order.kind.push_back(SlotKind::point);
        order.record.push_back(numbers[cell]);
      } else if (emits(row)) {
        order.kind.push_back(SlotKind::zero);
      }
    }
  }
  order.width = order.kind.size();
  return order;
}

TEST(Order, RingByRingCostsLittle) {
  const Cells cells = cells_of(64, 2000, 80);
  const auto upwards = [&](std::uint32_t k) { return 63 - k; };
  const auto start = [](std::uint32_t row) { return 900 + row * 7 % 50; };
  CloudOrder order = along(cells, false, upwards, start, [](std::uint32_t) { return false; });
  EXPECT_LE(check(order, cells.grid()), 1500u);
  for (std::size_t i = 100; i < order.record.size(); i += 1000) {
    std::swap(order.record[i], order.record[i + 1]);
  }
  EXPECT_LE(check(order, cells.grid()), 5000u);
}

TEST(Order, FiringByFiringCostsLittle) {
  const Cells cells = cells_of(32, 1800, 90);
  const auto interleaved = [](std::uint32_t k) { return k / 2 + k % 2 * 16; };
  const auto start = [](std::uint32_t row) { return row * 37 % 100; };
  const auto some = [](std::uint32_t row) { return row % 3 == 0; };
  EXPECT_LE(check(along(cells, true, interleaved, start, some), cells.grid()), 2500u);
}

TEST(Order, OrganisedCloudCostsLittle) {
  const Cells cells = cells_of(32, 1024, 60);
  const auto all = [](std::uint32_t) { return true; };
  CloudOrder order = along(
      cells, false, [](std::uint32_t k) { return k; },
      [](std::uint32_t row) { return row * 11 % 64; }, all);
  order.width = 1024;
  order.height = 32;
  EXPECT_LE(check(order, cells.grid()), 1200u);
}

TEST(Order, AnyPermutationOfAnySlots) {
  for (const std::size_t loose : {0u, 40u, 5000u}) {
    const Cells cells = cells_of(8, 300, 50, loose);
    std::vector<std::uint32_t> record(cells.grid().records());
    std::iota(record.begin(), record.end(), 0u);
    std::mt19937 random(3);
    std::shuffle(record.begin(), record.end(), random);
    CloudOrder order = order_with(record);
    const double n = static_cast<double>(record.size());
    EXPECT_LE(static_cast<double>(check(order, cells.grid())), n * (std::log2(n) + 1));
    order.kind.clear();
    for (std::size_t points = 0; points < record.size();) {
      order.kind.push_back(static_cast<SlotKind>(random() % 4));
      if (order.kind.back() == SlotKind::point) ++points;
      if (order.kind.back() == SlotKind::odd) {
        order.odd.push_back({std::uint64_t{0x7ff0} << 48, random(), 0});
      }
    }
    order.type = ScalarType::float64;
    while (order.kind.size() % 17 != 0) order.kind.push_back(SlotKind::nan);
    order.width = order.kind.size() / 17;
    order.height = 17;
    check(order, cells.grid());
  }
}

TEST(Order, ShapesOfOtherSizesAreCorrupt) {
  CloudOrder order;
  order.kind.assign(12, SlotKind::nan);
  for (const auto& [width, height] : {std::pair<std::uint64_t, std::uint64_t>{4, 4},
                                      {1ull << 32, 1},
                                      {12, 1ull << 32},
                                      {1ull << 62, 4}}) {
    order.width = width;
    order.height = height;
    const auto payload = encode_order(order, {});
    EXPECT_FALSE(decode_order({ChunkType::order, payload, 0}, {}, 100)) << width;
  }
}

TEST(Order, SlotsWithoutAnyPoint) {
  CloudOrder order;
  order.kind.assign(5000, SlotKind::nan);
  order.width = 100;
  order.height = 50;
  EXPECT_LE(check(order, Cells{4, 9, std::vector<std::uint8_t>(36)}.grid()), 400u);
}

TEST(Order, KindsOfSlots) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(slot_kind({1, 0, 0}), SlotKind::point);
  EXPECT_EQ(slot_kind({0, 0, 0}), SlotKind::zero);
  EXPECT_EQ(slot_kind({0, -0.0, 0}), SlotKind::odd);
  EXPECT_EQ(slot_kind({nan, nan, nan}), SlotKind::nan);
  EXPECT_EQ(slot_kind({nan, 1, nan}), SlotKind::odd);
  EXPECT_EQ(slot_kind({inf, 1, 2}), SlotKind::odd);
  EXPECT_EQ(slot_bits(slot_position(slot_bits({nan, -0.0, inf}))), slot_bits({nan, -0.0, inf}));
  Cloud cloud;
  cloud.positions = {{1, 2, 3}, {nan, nan, nan}, {0, 0, 0}, {inf, 0, 0}, {4, 5, 6}};
  const CloudOrder order = order_of(cloud);
  EXPECT_EQ(order.record, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(order.odd.size(), 1u);
}

TEST(Order, DamageIsRefusedOrHarmless) {
  const Cells cells = cells_of(8, 200, 60, 9);
  std::vector<std::uint32_t> record(cells.grid().records());
  std::iota(record.begin(), record.end(), 0u);
  CloudOrder order = order_with(record);
  order.kind.insert(order.kind.begin() + 50, 5, SlotKind::odd);
  order.odd.assign(5, {1, std::uint64_t{0x7ff0} << 48, 3});
  const std::vector<std::byte> bytes = encode_order(order, cells.grid());
  const auto decode = [&](ByteSpan damaged) {
    const auto decoded = decode_order({ChunkType::order, damaged, 0}, cells.grid(), 100000);
    if (!decoded) return false;
    std::vector<std::uint32_t> sorted = decoded->record;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, record);
    return true;
  };
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode(ByteSpan(bytes).first(size))) << size;
  }
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::byte> damaged = bytes;
    damaged[random() % bytes.size()] = static_cast<std::byte>(random());
    decode(damaged);
  }
  const auto limited = decode_order({ChunkType::order, bytes, 0}, cells.grid(), 100);
  ASSERT_FALSE(limited);
  EXPECT_EQ(limited.error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace curlidar
