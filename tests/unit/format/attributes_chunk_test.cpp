// SPDX-License-Identifier: BSD-3-Clause
#include "format/attributes_chunk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

#include "base/bytes.hpp"
#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::chunk_of;
using testing::HasSubstr;

constexpr std::uint64_t kAmple = 1u << 30;

Result<std::vector<Attribute>> read_back(const std::vector<std::byte>& payload,
                                         std::uint64_t returns, std::uint64_t limit = kAmple) {
  return read_attributes(chunk_of(ChunkType::attributes, payload), returns, limit);
}

/// Equal bit for bit, where NaN equals itself.
bool same_bits(const Column& a, const Column& b) {
  if (type_of(a) != type_of(b) || size_of(a) != size_of(b)) return false;
  return std::visit(
      [&](const auto& values) {
        const auto& others = std::get<std::decay_t<decltype(values)>>(b);
        return values.empty() ||
               std::memcmp(values.data(), others.data(), values.size() * sizeof(values[0])) == 0;
      },
      a);
}

enum class Content { zeros, ramp, noise };

/// Values with every bit pattern possible in `noise`, NaN included.
Column column_with(ScalarType type, std::size_t size, Content content) {
  Column column = make_column(type, size);
  std::mt19937_64 engine(static_cast<std::uint64_t>(type) + 1);
  std::visit(
      [&](auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        for (std::size_t i = 0; i < size; ++i) {
          if (content == Content::ramp) values[i] = static_cast<Value>(i % 100);
          if (content == Content::noise) {
            const std::uint64_t bits = engine();
            std::memcpy(&values[i], &bits, sizeof(Value));
          }
        }
      },
      column);
  return column;
}

TEST(AttributesChunk, RoundTripsEveryTypeShapeAndContent) {
  for (const std::size_t returns : {0u, 1u, 997u}) {
    for (const Content content : {Content::zeros, Content::ramp, Content::noise}) {
      std::vector<Attribute> attributes;
      for (std::size_t type = 0; type < std::variant_size_v<Column>; ++type) {
        for (const std::uint32_t components : {1u, 3u}) {
          const auto scalar = static_cast<ScalarType>(type);
          attributes.push_back({std::string(to_string(scalar)) + std::to_string(components),
                                components, column_with(scalar, returns * components, content)});
        }
      }
      const auto payload = write_attributes(attributes, returns);
      ASSERT_TRUE(payload) << payload.error().message;
      const auto back = read_back(*payload, returns);
      ASSERT_TRUE(back) << back.error().message;
      ASSERT_EQ(back->size(), attributes.size());
      for (std::size_t i = 0; i < attributes.size(); ++i) {
        EXPECT_EQ((*back)[i].name, attributes[i].name);
        EXPECT_EQ((*back)[i].components, attributes[i].components);
        EXPECT_TRUE(same_bits((*back)[i].values, attributes[i].values)) << attributes[i].name;
      }
    }
  }
}

TEST(AttributesChunk, StoresSmoothValuesInLittle) {
  std::vector<double> time(20000);
  std::vector<std::uint16_t> ring(time.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    time[i] = static_cast<double>(i) / 1024;
    ring[i] = static_cast<std::uint16_t>(i / 1000);
  }
  const auto payload = write_attributes({{"time", 1, time}, {"ring", 1, ring}}, time.size());
  ASSERT_TRUE(payload);
  EXPECT_LT(payload->size(), time.size());  // of 10 bytes a return
}

TEST(AttributesChunk, RefusesToWriteWhatItCouldNotRead) {
  const std::vector<float> two{1, 2};
  const std::vector<std::vector<Attribute>> cases{
      {{"", 1, two}},
      {{"a", 1, two}, {"a", 1, two}},
      {{"short", 1, std::vector<float>{1}}},
      {{"none", 0, std::vector<float>{}}},
      {{"ragged", 3, std::vector<float>{1, 2, 3, 4}}},
      {{std::string(256, 'n'), 1, two}},
      {{"caf\xe9", 1, two}},
      std::vector<Attribute>(kMaxAttributes + 1, {"a", 1, two}),
  };
  const char* named[] = {"no name",    "\"a\"", "\"short\"", "\"none\"",
                         "\"ragged\"", "nnn",   "caf\\xe9",  "257 attributes"};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto payload = write_attributes(cases[i], 2);
    ASSERT_FALSE(payload) << "case " << i;
    EXPECT_EQ(payload.error().code, ErrorCode::invalid_argument);
    EXPECT_THAT(payload.error().message, HasSubstr(named[i]));
  }
}

TEST(AttributesChunk, AnotherNumberOfReturnsIsCorrupt) {
  const auto payload = write_attributes({{"a", 1, std::vector<float>{1, 2}}}, 2);
  ASSERT_TRUE(payload);
  EXPECT_TRUE(read_back(*payload, 2));
  for (const std::uint64_t returns : {0u, 1u, 3u}) {
    const auto back = read_back(*payload, returns);
    ASSERT_FALSE(back);
    EXPECT_EQ(back.error().code, ErrorCode::corrupt);
  }
}

TEST(AttributesChunk, LimitsTheTotalOfAllAttributes) {
  const std::vector<double> values(100);
  const auto payload = write_attributes({{"a", 1, values}, {"b", 1, values}}, 100);
  ASSERT_TRUE(payload);
  EXPECT_TRUE(read_back(*payload, 100, 1600));
  const auto back = read_back(*payload, 100, 1599);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::limit_exceeded);
}

TEST(AttributesChunk, RefusesBadFields) {
  const auto payload_of = [](const char* name, unsigned type, std::uint64_t components,
                             unsigned form) {
    ByteWriter writer;
    writer.write_varint(1);
    writer.write_string(name);
    writer.write(static_cast<std::uint8_t>(type));
    writer.write_varint(components);
    writer.write(static_cast<std::uint8_t>(form));
    writer.write_varint(0);  // an empty packed block
    return std::move(writer).bytes();
  };
  EXPECT_TRUE(read_back(payload_of("a", 1, 1, 0), 0));
  EXPECT_FALSE(read_back(payload_of("", 1, 1, 0), 0));
  EXPECT_FALSE(read_back(payload_of("a", 10, 1, 0), 0));
  EXPECT_FALSE(read_back(payload_of("a", 1, 0, 0), 0));
  EXPECT_FALSE(read_back(payload_of("a", 1, 65537, 0), 0));
  EXPECT_FALSE(read_back(payload_of("a", 1, 1, 4), 0));
  const auto overflow =
      read_back(payload_of("a", 9, 65536, 0), std::numeric_limits<std::uint64_t>::max());
  ASSERT_FALSE(overflow);
  EXPECT_EQ(overflow.error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace curlidar
