// SPDX-License-Identifier: BSD-3-Clause
#include "format/metadata_chunk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/bytes.hpp"
#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::chunk_of;
using testing::HasSubstr;

Result<Metadata> read_back(const std::vector<std::byte>& payload) {
  return read_metadata(chunk_of(ChunkType::metadata, payload));
}

TEST(MetadataChunk, RoundTrips) {
  const Metadata metadata{{"frame_id", "lidar"},
                          {"note", "gr\xc3\xbc\xc3\x9f\x65 \xf0\x9f\x9b\xb0\n"},
                          {"empty", ""},
                          {"stamp_ns", "1315973523029999989"},
                          {"zero", std::string("a\0b", 3)},
                          {"long", std::string(5000, 'x')}};
  for (const Metadata& entries : {metadata, Metadata{}}) {
    const auto payload = write_metadata(entries);
    ASSERT_TRUE(payload) << payload.error().message;
    const auto back = read_back(*payload);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, entries);
  }
}

TEST(MetadataChunk, RefusesToWriteWhatItCouldNotRead) {
  const Metadata cases[] = {{{"latin\xe9", "1"}},
                            {{"sensor_serial", "caf\xe9"}},
                            {{std::string(300, 'k'), "1"}},
                            {{"big", std::string(kMaxMetadataValueBytes + 1, 'x')}},
                            {{"", "1"}}};
  const char* named[] = {"latin\\xe9", "sensor_serial", "kkk", "big", "empty"};
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    const auto payload = write_metadata(cases[i]);
    ASSERT_FALSE(payload);
    EXPECT_EQ(payload.error().code, ErrorCode::invalid_argument);
    EXPECT_THAT(payload.error().message, HasSubstr(named[i]));
  }
  Metadata many;
  for (std::size_t i = 0; i <= kMaxMetadataEntries; ++i) many["key" + std::to_string(i)] = "";
  EXPECT_FALSE(write_metadata(many));
}

TEST(MetadataChunk, RefusesDisorderDuplicatesAndBadText) {
  const auto payload_of = [](std::initializer_list<const char*> texts) {
    ByteWriter writer;
    writer.write_varint(texts.size() / 2);
    for (const char* text : texts) writer.write_string(text);
    return std::move(writer).bytes();
  };
  EXPECT_TRUE(read_back(payload_of({"a", "1", "b", "2"})));
  EXPECT_FALSE(read_back(payload_of({"b", "1", "a", "2"})));
  EXPECT_FALSE(read_back(payload_of({"a", "1", "a", "2"})));
  EXPECT_FALSE(read_back(payload_of({"", "1"})));
  EXPECT_FALSE(read_back(payload_of({"a", "\xff"})));
  EXPECT_FALSE(read_back(payload_of({"\xff", "1"})));
  auto longer = payload_of({"a", "1"});
  longer.push_back(std::byte{0});
  const auto back = read_back(longer);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::corrupt);
  EXPECT_THAT(back.error().message, HasSubstr("metadata chunk, byte 105"));
}

}  // namespace
}  // namespace curlidar
