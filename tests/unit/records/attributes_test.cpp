// SPDX-License-Identifier: BSD-3-Clause
#include "records/attributes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace curlidar {
namespace {

constexpr std::uint64_t kMuch = 1u << 28;

/// A scan of which some cells are empty, its points ring by ring or firing by firing, some loose
/// ones at the end, and slots without a point.
struct Scene {
  std::uint32_t rows = 16, columns = 200;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges, shift;
  std::vector<std::uint32_t> cells;  ///< of the records in cells
  CloudOrder order;
  std::size_t loose;

  explicit Scene(std::size_t loose_points, bool by_firing = false, std::size_t others = 0)
      : loose(loose_points) {
    std::mt19937 random(11);
    for (std::uint32_t cell = 0; cell < rows * columns; ++cell) {
      occupied.push_back(random() % 5 != 0 ? 1 : 0);
      ranges.push_back(static_cast<std::int32_t>(65536 * (10 + cell % columns % 37)));
      if (occupied.back() != 0) cells.push_back(cell);
    }
    for (std::uint32_t row = 0; row < rows; ++row) {
      shift.push_back(static_cast<std::int32_t>(row * 7) - 50);
    }
    order.record.resize(cells.size() + loose);
    std::iota(order.record.begin(), order.record.end(), 0u);
    if (by_firing) {
      std::stable_sort(
          order.record.begin(), order.record.end() - static_cast<std::ptrdiff_t>(loose),
          [&](std::uint32_t a, std::uint32_t b) { return firing(cells[a]) < firing(cells[b]); });
    }
    order.kind.assign(order.record.size(), SlotKind::point);
    order.kind.insert(order.kind.begin() + 100, others, SlotKind::nan);
    order.width = order.slots();
  }

  std::uint32_t firing(std::uint32_t cell) const {
    const auto ahead = static_cast<std::int64_t>(cell % columns) - shift[cell / columns];
    return static_cast<std::uint32_t>((ahead + columns) % columns);
  }
  RecordGeometry geometry() const { return {{rows, columns, occupied, loose}, ranges, shift}; }

  /// Values by cell; 3 for slots of no cell.
  template <class Value, class Function>
  Attribute attribute(const char* name, const Function& value) const {
    std::vector<Value> values;
    std::size_t point = 0;
    for (const SlotKind kind : order.kind) {
      const std::size_t record =
          kind == SlotKind::point ? order.record[point++] : order.record.size();
      values.push_back(record < cells.size() ? static_cast<Value>(value(cells[record]))
                                             : static_cast<Value>(3));
    }
    return {name, 1, std::move(values)};
  }
};

/// Values compared bit for bit.
template <class Value>
std::vector<std::uint64_t> bits_of(const std::vector<Value>& values) {
  std::vector<std::uint64_t> bits;
  for (const Value value : values) {
    bits.push_back(static_cast<std::uint64_t>(std::bit_cast<UnsignedOfSize<sizeof(Value)>>(value)));
  }
  return bits;
}

void expect_same(const Attribute& a, const Attribute& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.components, b.components);
  ASSERT_EQ(type_of(a.values), type_of(b.values));
  const auto bits = [](const Column& column) {
    return std::visit([](const auto& values) { return bits_of(values); }, column);
  };
  EXPECT_EQ(bits(a.values), bits(b.values)) << a.name;
}

/// Coded and decoded; bits a slot.
double check(const Scene& scene, const std::vector<Attribute>& attributes) {
  const auto bytes = write_records(attributes, scene.order, scene.geometry());
  EXPECT_TRUE(bytes) << (bytes ? "" : bytes.error().message);
  const auto decoded =
      read_records({ChunkType::records, *bytes, 0}, scene.order, scene.geometry(), kMuch);
  EXPECT_TRUE(decoded) << (decoded ? "" : decoded.error().message);
  if (!decoded) return 0;
  EXPECT_EQ(decoded->size(), attributes.size());
  for (std::size_t i = 0; i < attributes.size(); ++i) expect_same(attributes[i], (*decoded)[i]);
  return 8. * static_cast<double>(bytes->size()) / static_cast<double>(scene.order.slots());
}

TEST(Records, NoAttributesOrNoSlots) {
  EXPECT_LT(check(Scene(0), {}), .01);
  Scene scene(0);
  scene.occupied.clear();
  scene.ranges.clear();
  scene.shift.clear();
  scene.rows = scene.columns = 0;
  scene.order = {};
  const Attribute none{"intensity", 1, std::vector<float>{}};
  const auto bytes = write_records({none}, scene.order, scene.geometry());
  ASSERT_TRUE(bytes);
  const auto decoded =
      read_records({ChunkType::records, *bytes, 0}, scene.order, scene.geometry(), kMuch);
  ASSERT_TRUE(decoded);
  expect_same(none, decoded->front());
}

TEST(Records, AllTypesAndAnyBits) {
  std::mt19937_64 random(5);
  for (const std::size_t others : {0u, 60u}) {
    const Scene scene(25, true, others);
    std::vector<Attribute> attributes;
    for (int type = 0; type < 10; ++type) {
      for (const std::uint32_t components : {1u, 3u, 17u}) {
        Column values =
            make_column(static_cast<ScalarType>(type), scene.order.slots() * components);
        std::visit(
            [&](auto& column) {
              using Value = typename std::decay_t<decltype(column)>::value_type;
              using Bits = UnsignedOfSize<sizeof(Value)>;
              for (Value& value : column) value = std::bit_cast<Value>(static_cast<Bits>(random()));
            },
            values);
        attributes.push_back(
            {fmt::format("{}x{}", type, components), components, std::move(values)});
      }
    }
    check(scene, attributes);
  }
}

TEST(Records, FunctionsOfRowAndFiringCostNextToNothing) {
  for (const bool by_firing : {false, true}) {
    const Scene scene(0, by_firing);
    const auto row = [&](std::uint32_t cell) { return (cell / scene.columns * 5 + 3) % 16; };
    EXPECT_LT(check(scene, {scene.attribute<std::uint16_t>("ring", row)}), .25);
    const auto time = [&](std::uint32_t cell) {
      return 1000 * (scene.firing(cell) * scene.firing(cell) / 3) + cell / scene.columns * 11;
    };
    EXPECT_LT(check(scene, {scene.attribute<std::uint32_t>("t", time)}), 2.2);
    const auto seconds = [&](std::uint32_t cell) { return 1e-6 * scene.firing(cell) * 55; };
    EXPECT_LT(check(scene, {scene.attribute<double>("time", seconds)}), 1.);
  }
}

TEST(Records, SmoothLevelsCostLittle) {
  const Scene scene(10, false, 30);
  std::mt19937 generator(2);
  const auto random = [&] { return static_cast<double>(generator() % 3); };
  const auto level = [&](std::uint32_t cell) {
    return 30 + 20 * std::sin(cell % scene.columns * .05) + random();
  };
  const Attribute integers = scene.attribute<std::uint8_t>("intensity", level);
  const auto hundredths = [&](std::uint32_t cell) {
    return static_cast<float>(std::round(level(cell))) / 100.f;
  };
  const Attribute decimals = scene.attribute<float>("reflectance", hundredths);
  EXPECT_LT(check(scene, {integers}), 3.2);
  EXPECT_LT(check(scene, {decimals}), 3.2);
}

TEST(Records, WideLevelsAndPalettes) {
  const Scene scene(10);
  std::mt19937 generator(2);
  const auto random = [&] { return static_cast<double>(generator() % 50); };
  const auto wide = [&](std::uint32_t cell) {
    return std::exp(5 + 3 * std::sin(cell % scene.columns * .05)) + random();
  };
  const auto some = [&](std::uint32_t cell) { return 1e9 * (cell % 7) * (cell % 7) + .123; };
  EXPECT_LT(check(scene, {scene.attribute<std::uint16_t>("signal", wide)}), 10.);
  EXPECT_LT(check(scene, {scene.attribute<double>("class", some)}), 4.);
  EXPECT_LT(
      check(scene, {scene.attribute<float>(
                       "none", [](auto) { return std::numeric_limits<float>::quiet_NaN(); })}),
      .2);
}

TEST(Records, RefusesWhatDoesNotFit) {
  const Scene scene(0);
  const Attribute shorter{"a", 1, std::vector<float>(3)};
  EXPECT_FALSE(write_records({shorter}, scene.order, scene.geometry()));
  const Attribute plain = scene.attribute<float>("a", [](auto cell) { return cell; });
  EXPECT_FALSE(write_records({plain, plain}, scene.order, scene.geometry()));
  const auto bytes = write_records({plain}, scene.order, scene.geometry());
  const auto decoded =
      read_records({ChunkType::records, *bytes, 0}, scene.order, scene.geometry(), 100);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::limit_exceeded);
}

TEST(Records, DamageIsRefusedOrHarmless) {
  const Scene scene(9, true, 20);
  std::mt19937 random(5);
  const std::vector<Attribute> attributes = {
      scene.attribute<std::uint8_t>("i", [&](auto cell) { return cell % 100 + random() % 9; }),
      scene.attribute<std::uint16_t>("ring", [&](auto cell) { return cell / scene.columns; }),
      scene.attribute<double>("class",
                              [&](auto) { return 1e9 * static_cast<double>(random() % 9) + .1; })};
  const auto bytes = write_records(attributes, scene.order, scene.geometry());
  ASSERT_TRUE(bytes);
  const auto decode = [&](ByteSpan damaged) {
    const auto decoded =
        read_records({ChunkType::records, damaged, 0}, scene.order, scene.geometry(), kMuch);
    if (!decoded) return false;
    for (const Attribute& attribute : *decoded) {
      EXPECT_EQ(size_of(attribute.values), scene.order.slots() * attribute.components);
    }
    return true;
  };
  for (std::size_t size = 0; size < bytes->size(); size += 7) {
    EXPECT_FALSE(decode(ByteSpan(*bytes).first(size))) << size;
  }
  for (int round = 0; round < 200; ++round) {
    std::vector<std::byte> damaged = *bytes;
    damaged[random() % 40] = static_cast<std::byte>(random());
    damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    decode(damaged);
  }
}

}  // namespace
}  // namespace curlidar
