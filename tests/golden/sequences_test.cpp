// SPDX-License-Identifier: BSD-3-Clause
// The golden sequence decodes to the twins of its scans, and is written again byte for byte.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "codec/predicted.hpp"
#include "codec/sequence_frame.hpp"
#include "codec/sequence_group.hpp"
#include "codec/sequence_parts.hpp"
#include "curlidar/io.hpp"
#include "curlidar/sequence.hpp"
#include "format/indexed_file.hpp"

namespace curlidar {
namespace {

const std::string kGolden = std::string(CURLIDAR_GOLDEN) + "/../";
const std::string kFile = kGolden + "sequences/two-groups.curl";

/// The golden scan that each scan is.
constexpr const char* kScans[] = {"predicted/street-0",      "predicted/street-1",
                                  "predicted/street-2",      "predicted/street-0",
                                  "clouds/rings-directions", "clouds/organised"};

TEST(Sequences, GoldenScansDecodeToTheirTwins) {
  auto file = SequenceFile::open(kFile);
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->scans(), std::size(kScans));
  for (std::size_t i = file->scans(); i-- > 0;) {
    const auto scan = file->decode(i);
    ASSERT_TRUE(scan) << scan.error().message;
    EXPECT_EQ(scan->coded_returns, file->scan(i)->returns);
    const auto twin = nlohmann::json::parse(std::ifstream(kGolden + kScans[i] + ".json"));
    if (scan->cloud) {
      EXPECT_EQ(scan->cloud->width, twin["width"].get<std::uint32_t>());
      EXPECT_EQ(scan->cloud->size(), twin["slots"].size());
      continue;
    }
    const auto image = PredictionReference::of(*scan);
    ASSERT_TRUE(image);
    EXPECT_EQ((*image)->scan().range, twin["range"].get<std::vector<std::int32_t>>()) << i;
  }
  const ScanStamp stamp = file->scan(2)->stamp;
  EXPECT_EQ(stamp.time_s, 1600000000.359375);
  EXPECT_EQ(stamp.T_map_sensor->move.x, -1);
  EXPECT_NEAR(stamp.T_map_sensor->rotation[0].x, -0.28, 1e-8);  // w = -.6, z = .8
  EXPECT_NEAR(stamp.T_map_sensor->rotation[0].y, 0.96, 1e-8);
}

TEST(Sequences, TheGoldenFileIsWrittenAgain) {
  auto file = SequenceFile::open(kFile);
  ASSERT_TRUE(file);
  const std::string path =
      (std::filesystem::temp_directory_path() / "curlidar-golden-sequence.curl").string();
  auto writer = IndexedWriter::create(path, IndexedKind::sequence,
                                      write_sequence_head({file->group_size(), file->still()}));
  ASSERT_TRUE(writer);
  std::size_t number = 0;
  for (const SequencePart& part : file->groups()) {
    FrameMemory memory;
    GroupWriter group;
    for (std::size_t i = 0; i < part.scans; ++i, ++number) {
      const auto scan = file->scan(number);
      const auto whole = read_file(kGolden + kScans[number] + ".curl");
      ASSERT_TRUE(scan && whole);
      const auto frame = pack_frame(*whole, scan->kind, memory);
      ASSERT_TRUE(frame);
      ASSERT_TRUE(group.add(*frame, scan->returns, scan->stamp));
    }
    ASSERT_TRUE(writer->add(group.finish(part.first_scan), write_group_summary(part)));
  }
  ASSERT_TRUE(writer->finish());
  EXPECT_TRUE(read_file(path).value() == read_file(kFile).value());
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace curlidar
