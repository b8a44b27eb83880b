// SPDX-License-Identifier: BSD-3-Clause
// Damaged sequences give scans or errors, never faults; with checksums put right, damage reaches
// the readers of groups and frames.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "codec/sequence_group.hpp"
#include "codec/sequence_parts.hpp"
#include "curlidar/io.hpp"
#include "format/indexed_file.hpp"
#include "hostile/targets/sequence.hpp"

namespace curlidar {
namespace {

std::vector<std::byte> golden_sequence() {
  std::ifstream file(std::string(CURLIDAR_TEST_FOLDER) + "/../golden/sequences/two-groups.curl",
                     std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const ByteSpan bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Its second group alone, which decodes quickly: nothing in it is predicted.
std::vector<std::byte> quick_sequence() {
  auto golden = SequenceFile::parse(golden_sequence(), "golden").value();
  const auto indexed = IndexedFile::open(random_access_of(golden_sequence(), "golden")).value();
  const auto part = indexed.read(1).value();
  const auto group = read_group(part).value();
  GroupWriter again;
  for (const GroupScan& scan : group.scans) {
    EXPECT_TRUE(again.add(ByteSpan(part).subspan(scan.offset, scan.bytes), scan.returns, {}));
  }
  SequencePart told = golden.groups()[1];
  const std::string path =
      (std::filesystem::temp_directory_path() / "curlidar-quick-sequence.curl").string();
  auto writer = IndexedWriter::create(path, IndexedKind::sequence, indexed.header()).value();
  EXPECT_TRUE(writer.add(again.finish(0), write_group_summary(told)));
  EXPECT_TRUE(writer.finish());
  auto bytes = read_file(path).value();
  std::filesystem::remove(path);
  return bytes;
}

TEST(SequenceDamage, WholeFilesAreGood) {
  EXPECT_EQ(SequenceFile::parse(golden_sequence(), "golden")->scans(), 6u);
  EXPECT_EQ(test::sequence_target(golden_sequence()), "");
  auto quick = SequenceFile::parse(quick_sequence(), "quick");
  ASSERT_TRUE(quick);
  EXPECT_EQ(quick->scans(), 2u);
  EXPECT_TRUE(quick->decode(1));
}

TEST(SequenceDamage, ChangedBytes) {
  const auto bytes = quick_sequence();
  for (std::size_t at = 0; at < bytes.size(); at += at < 60 || at + 50 > bytes.size() ? 2 : 29) {
    for (const int change : {0x01, 0xff}) {
      auto damaged = bytes;
      damaged[at] ^= static_cast<std::byte>(change);
      ASSERT_EQ(test::sequence_target(damaged), "") << at << " " << change;
    }
  }
}

TEST(SequenceDamage, ChangedStamps) {
  const auto bytes = golden_sequence();
  const auto indexed = IndexedFile::open(random_access_of(bytes, "golden")).value();
  const auto part = indexed.read(0).value();
  const std::size_t frames = read_group(part).value().scans.front().offset;
  for (std::size_t at = 0; at < frames; ++at) {
    for (int change = 1; change < 256; change += 6) {
      auto damaged = part;
      damaged[at] ^= static_cast<std::byte>(change);
      const auto group = read_group(damaged);
      if (!group) continue;
      for (const GroupScan& scan : group->scans) ASSERT_EQ(test::check_stamp(scan.stamp), "");
    }
  }
}

TEST(SequenceDamage, Cuts) {
  const auto bytes = quick_sequence();
  for (std::size_t size = 0; size < bytes.size(); size += 5) {
    ASSERT_EQ(test::sequence_target(ByteSpan(bytes).first(size)), "") << size;
  }
}

TEST(SequenceDamage, BytesLeftOutAndPutIn) {
  const auto bytes = quick_sequence();
  for (std::size_t at = 8; at < bytes.size(); at += 17) {
    auto shorter = bytes, longer = bytes;
    const auto place = static_cast<std::ptrdiff_t>(at);
    shorter.erase(shorter.begin() + place);
    longer.insert(longer.begin() + place, std::byte{0x40});
    ASSERT_EQ(test::sequence_target(shorter), "") << at;
    ASSERT_EQ(test::sequence_target(longer), "") << at;
  }
}

TEST(SequenceDamage, RandomGroups) {
  std::mt19937 engine(1);
  std::vector<std::byte> part;
  for (int round = 0; round < 10000; ++round) {
    part.resize(engine() % 60);
    // Small numbers more often than not: they get further.
    for (std::byte& b : part) b = static_cast<std::byte>(engine() % (engine() % 2 ? 4 : 256));
    for (const bool cut : {false, true}) {
      const auto group = read_group(part, cut);
      if (!group) {
        ASSERT_FALSE(group.error().message.empty());
        continue;
      }
      for (const GroupScan& scan : group->scans) {
        ASSERT_GT(scan.bytes, 0u);
        ASSERT_LE(scan.offset + scan.bytes, part.size());
      }
    }
  }
}

}  // namespace
}  // namespace curlidar
