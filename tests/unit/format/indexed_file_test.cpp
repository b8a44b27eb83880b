// SPDX-License-Identifier: BSD-3-Clause
#include "format/indexed_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/crc32c.hpp"
#include "curlidar/io.hpp"
#include "format/container.hpp"

namespace curlidar {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;
namespace fs = std::filesystem;

Bytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A folder of its own that is gone at the end.
class IndexedFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("curlidar-indexed-" + std::to_string(::getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name = "a.curl") const { return (folder_ / name).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  /// Parts of several sizes, one empty, one whose size takes two bytes.
  Bytes small_file() const {
    auto writer = IndexedWriter::create(path(), IndexedKind::sequence, bytes_of("settings"));
    EXPECT_TRUE(writer);
    EXPECT_TRUE(writer->add(bytes_of("first"), bytes_of("1")));
    EXPECT_TRUE(writer->add({}, {}));
    EXPECT_TRUE(writer->add(bytes_of(std::string(200, 'x')), bytes_of("third")));
    const auto size = writer->finish();
    EXPECT_TRUE(size);
    Bytes bytes = read_file(path()).value();
    EXPECT_EQ(bytes.size(), *size);
    return bytes;
  }

 private:
  fs::path folder_;
};

Result<IndexedFile> open_bytes(ByteSpan bytes, bool allow_truncated = false) {
  IndexedOptions options;
  options.allow_truncated = allow_truncated;
  return IndexedFile::open(random_access_of({bytes.begin(), bytes.end()}, "memory"), options);
}

TEST_F(IndexedFileTest, GivesPartsBackFromFileAndMemory) {
  const Bytes bytes = small_file();
  auto from_file = IndexedFile::open(open_random_access(path()).value());
  auto from_memory = open_bytes(bytes);
  for (const auto* file : {&from_file, &from_memory}) {
    ASSERT_TRUE(*file) << file->error().message;
    EXPECT_EQ((*file)->kind(), IndexedKind::sequence);
    EXPECT_EQ(text_of((*file)->header()), "settings");
    EXPECT_FALSE((*file)->missing());
    ASSERT_EQ((*file)->entries().size(), 3u);
    EXPECT_EQ(text_of((*file)->read(0).value()), "first");
    EXPECT_EQ(text_of((*file)->read(1).value()), "");
    EXPECT_EQ(text_of((*file)->read(2).value()), std::string(200, 'x'));
    EXPECT_EQ(text_of((*file)->entries()[2].summary), "third");
    EXPECT_FALSE((*file)->read(3));
  }
  EXPECT_EQ(indexed_kind(bytes), IndexedKind::sequence);
  // The same chunks as any reader of the container sees them.
  const auto chunks = read_container(bytes);
  ASSERT_TRUE(chunks) << chunks.error().message;
  ASSERT_EQ(chunks->size(), 6u);
  EXPECT_EQ((*chunks)[3].offset, from_memory->entries()[2].offset);
}

TEST_F(IndexedFileTest, AFileWithoutPartsIsWhole) {
  auto writer = IndexedWriter::create(path(), IndexedKind::surface_map, {});
  ASSERT_TRUE(writer->finish());
  const auto file = IndexedFile::open(open_random_access(path()).value());
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->entries().empty());
}

TEST_F(IndexedFileTest, NothingIsSeenBeforeTheEnd) {
  {
    auto writer = IndexedWriter::create(path(), IndexedKind::surface_map, {});
    ASSERT_TRUE(writer->add(bytes_of("part"), {}));
    EXPECT_FALSE(fs::exists(path()));
  }
  EXPECT_EQ(files(), 0u);
  const Bytes old = small_file();
  {
    auto writer = IndexedWriter::create(path(), IndexedKind::surface_map, {});
    ASSERT_TRUE(writer->add(bytes_of("part"), {}));
  }
  EXPECT_EQ(read_file(path()).value(), old);
  EXPECT_EQ(files(), 1u);
}

TEST_F(IndexedFileTest, CutAnywhereIsRefusedOrWalked) {
  const Bytes whole = small_file();
  const auto file = open_bytes(whole);
  const auto& entries = file->entries();
  std::size_t readable = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const ByteSpan cut = ByteSpan(whole).first(size);
    const auto refused = open_bytes(cut);
    ASSERT_FALSE(refused) << size;
    EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
    const auto part = open_bytes(cut, true);
    if (size < entries[0].offset - 2) {
      EXPECT_FALSE(part) << size;
      continue;
    }
    ASSERT_TRUE(part) << size << ": " << part.error().message;
    EXPECT_TRUE(part->missing());
    std::size_t expected = 0;
    for (const IndexedEntry& entry : entries) expected += entry.offset + entry.size + 4 <= size;
    ASSERT_EQ(part->entries().size(), expected) << size;
    for (std::size_t i = 0; i < expected; ++i) {
      EXPECT_EQ(part->read(i).value(), file->read(i).value());
      ++readable;
    }
  }
  EXPECT_GT(readable, 100u);
}

TEST_F(IndexedFileTest, DamageOfAPartIsThatPartsAlone) {
  const Bytes whole = small_file();
  const auto file = open_bytes(whole);
  for (std::size_t at = file->entries()[0].offset - 2; at < file->entries()[1].offset - 2; ++at) {
    Bytes damaged = whole;
    damaged[at] ^= std::byte{0x11};
    const auto opened = open_bytes(damaged);
    ASSERT_TRUE(opened) << at;
    const auto first = opened->read(0);
    ASSERT_FALSE(first) << at;
    EXPECT_EQ(first.error().code, ErrorCode::corrupt);
    EXPECT_EQ(opened->read(2).value(), file->read(2).value());
  }
}

TEST_F(IndexedFileTest, EveryFlippedByteOfHeaderOrIndexShows) {
  const Bytes whole = small_file();
  const auto file = open_bytes(whole);
  const std::size_t parts = file->entries()[0].offset - 2;
  const std::size_t index = whole.size() - file->index_bytes();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    if (at >= parts && at < index) continue;
    Bytes damaged = whole;
    damaged[at] ^= std::byte{0x41};
    EXPECT_FALSE(open_bytes(damaged)) << at;
    const auto walked = open_bytes(damaged, true);
    EXPECT_EQ(walked.has_value(), at >= index) << at;
    if (walked) {
      ASSERT_EQ(walked->entries().size(), 3u) << at;
      EXPECT_EQ(walked->read(2).value(), file->read(2).value());
    }
  }
}

/// The file with its index replaced by another payload, checksums right.
Bytes with_index(const Bytes& whole, ByteSpan payload) {
  const auto file = open_bytes(whole);
  const std::size_t start = whole.size() - file->index_bytes();
  ByteWriter writer;
  writer.write_bytes(ByteSpan(whole).first(start));
  const auto add = [&](ChunkType type, ByteSpan bytes) {
    const std::size_t begin = writer.size();
    writer.write(static_cast<std::uint8_t>(type));
    writer.write_varint(bytes.size());
    writer.write_bytes(bytes);
    writer.write(crc32c(ByteSpan(writer.bytes()).subspan(begin)));
    return writer.size() - begin;
  };
  ByteWriter footer;
  footer.write(std::uint64_t{start});
  footer.write(std::uint64_t{add(ChunkType::indexed_index, payload)});
  add(ChunkType::indexed_footer, footer.bytes());
  add(ChunkType::end, {});
  return std::move(writer).bytes();
}

TEST_F(IndexedFileTest, HostileIndexesAreRefused) {
  const Bytes whole = small_file();
  const auto index_of = [](const std::vector<std::uint64_t>& numbers) {
    ByteWriter writer;
    for (const std::uint64_t number : numbers) writer.write_varint(number);
    return std::move(writer).bytes();
  };
  ASSERT_TRUE(open_bytes(with_index(whole, index_of({3, 5, 0, 0, 0, 200, 0}))));
  const std::vector<std::vector<std::uint64_t>> hostile = {
      {},
      {UINT64_MAX},
      {UINT64_MAX / 2, 0, 0},
      {3, 5, 0, 0, 0, 201, 0},
      {2, 5, 0, 0, 0},                   // not all parts
      {3, 5, 0, 0, 0, 200, 0, 0},        // bytes left over
      {3, UINT64_MAX, 0, 0, 0, 200, 0},  // overflow
      {3, UINT64_MAX - 8, 0, 0, 0, 200, 0},
      {3, 5, UINT64_MAX, 0, 0, 200, 0},  // a summary of all there is
      {3, 5, 0, 0, 0, 200, 7},
  };
  for (const auto& numbers : hostile) {
    const auto file = open_bytes(with_index(whole, index_of(numbers)));
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::corrupt) << file.error().message;
  }
}

TEST_F(IndexedFileTest, LimitsAndKindsAreHeld) {
  const Bytes whole = small_file();
  IndexedOptions options;
  options.limits.max_parts = 2;
  for (const bool walk : {false, true}) {
    options.allow_truncated = walk;
    const ByteSpan bytes = ByteSpan(whole).first(whole.size() - (walk ? 1 : 0));
    const auto file =
        IndexedFile::open(random_access_of({bytes.begin(), bytes.end()}, "memory"), options);
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::limit_exceeded);
  }
  ContainerWriter other;
  other.add(ChunkType::sensor, {});
  const auto scan = open_bytes(std::move(other).finish(), true);
  ASSERT_FALSE(scan);
  EXPECT_THAT(scan.error().message, HasSubstr("sensor chunk where"));
  ContainerWriter unknown;
  unknown.add(ChunkType::indexed_header, bytes_of("\x33"));
  const auto newer = open_bytes(std::move(unknown).finish());
  ASSERT_FALSE(newer);
  EXPECT_EQ(newer.error().code, ErrorCode::unsupported);
}

TEST_F(IndexedFileTest, FilesThatAreNotThereOrCannotBeWritten) {
  EXPECT_EQ(open_random_access(path("none")).error().code, ErrorCode::not_found);
  EXPECT_EQ(open_random_access(fs::path(path()).parent_path().string()).error().code,
            ErrorCode::invalid_argument);
  const auto writer = IndexedWriter::create(path("no/such/folder"), IndexedKind::scan_map, {});
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace curlidar
