// SPDX-License-Identifier: BSD-3-Clause
#include "records/attributes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "support/record_scenes.hpp"

namespace curlidar {
namespace {

constexpr std::uint64_t kMuch = 1u << 28;

using Scene = test::RecordScene;

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
  EXPECT_LT(check(Scene(), {}), .01);
  const Scene scene({.rows = 0, .columns = 0});
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
    const Scene scene({.loose = 25, .others = others, .by_firing = true});
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
    const Scene scene({.by_firing = by_firing});
    const auto row = [&](std::uint32_t cell) { return (scene.row(cell) * 5 + 3) % 16; };
    EXPECT_LT(check(scene, {scene.attribute<std::uint16_t>("ring", row)}), .25);
    const auto time = [&](std::uint32_t cell) {
      return 1000 * (scene.firing(cell) * scene.firing(cell) / 3) + scene.row(cell) * 11;
    };
    EXPECT_LT(check(scene, {scene.attribute<std::uint32_t>("t", time)}), 2.2);
    const auto seconds = [&](std::uint32_t cell) { return 1e-6 * scene.firing(cell) * 55; };
    EXPECT_LT(check(scene, {scene.attribute<double>("time", seconds)}), 1.);
  }
}

TEST(Records, SmoothLevelsCostLittle) {
  const Scene scene({.loose = 10, .others = 30});
  std::mt19937 generator(2);
  const auto random = [&] { return static_cast<double>(generator() % 3); };
  const auto level = [&](std::uint32_t cell) {
    return 30 + 20 * std::sin(scene.column(cell) * .05) + random();
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
  const Scene scene({.loose = 10});
  std::mt19937 generator(2);
  const auto random = [&] { return static_cast<double>(generator() % 50); };
  const auto wide = [&](std::uint32_t cell) {
    return std::exp(5 + 3 * std::sin(scene.column(cell) * .05)) + random();
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
  const Scene scene;
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
  const Scene scene({.loose = 9, .others = 20, .by_firing = true});
  std::mt19937 random(5);
  const std::vector<Attribute> attributes = {
      scene.attribute<std::uint8_t>("i", [&](auto cell) { return cell % 100 + random() % 9; }),
      scene.attribute<std::uint16_t>("ring", [&](auto cell) { return scene.row(cell); }),
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
