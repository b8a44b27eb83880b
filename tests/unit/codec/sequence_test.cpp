// SPDX-License-Identifier: BSD-3-Clause
// Frames in memory: what comes back, what may stand alone, what damage does.
#include "curlidar/sequence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "codec/sequence_frame.hpp"
#include "codec/sequence_group.hpp"
#include "codec/sequence_stamps.hpp"
#include "support/scans.hpp"
#include "support/sequences.hpp"

namespace curlidar {
namespace {

std::vector<EncodedFrame> encode_all(const std::vector<Cloud>& clouds,
                                     const SequenceSettings& settings) {
  auto encoder = SequenceEncoder::create(settings);
  EXPECT_TRUE(encoder) << encoder.error().message;
  std::vector<EncodedFrame> frames;
  for (const Cloud& cloud : clouds) {
    auto frame = encoder->add(cloud);
    EXPECT_TRUE(frame) << frame.error().message;
    if (frame) frames.push_back(*std::move(frame));
  }
  return frames;
}

TEST(Sequence, EveryScanComesBackAsItsOwnFileWould) {
  const auto clouds = test::drive(4);
  const SequenceSettings settings = test::drive_settings(3);
  const auto frames = encode_all(clouds, settings);
  ASSERT_EQ(frames.size(), clouds.size());
  EXPECT_EQ(frames[0].kind, FrameKind::first);
  EXPECT_NE(frames[1].kind, FrameKind::first);
  EXPECT_EQ(frames[3].kind, FrameKind::first);
  SequenceDecoder decoder;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frame_kind(frames[i].bytes).value(), frames[i].kind);
    const auto scan = decoder.add(frames[i].bytes);
    ASSERT_TRUE(scan) << scan.error().message;
    ASSERT_TRUE(scan->cloud);
    ASSERT_EQ(scan->cloud->size(), clouds[i].size());
    double sum = 0;
    for (std::size_t k = 0; k < clouds[i].size(); ++k) {
      sum += norm(scan->cloud->positions[k] - clouds[i].positions[k]);
    }
    EXPECT_NEAR(sum / static_cast<double>(clouds[i].size()), frames[i].report.compact->mean_error_m,
                1e-12);
    EXPECT_EQ(frames[i].report.bytes, frames[i].bytes.size());
  }
}

TEST(Sequence, AFirstFrameIsAFileOfItsOwn) {
  const auto clouds = test::drive(2);
  const SequenceSettings settings = test::drive_settings(8);
  const auto frames = encode_all(clouds, settings);
  const auto file = encode(clouds[0], settings.encode);
  ASSERT_TRUE(file);
  SequenceDecoder decoder;
  EXPECT_EQ(decoder.file_of(frames[0].bytes).value(), file->bytes);
  EXPECT_LT(frames[0].bytes.size() + 20, file->bytes.size());
}

TEST(Sequence, WhatIsTheSameIsToldOnce) {
  const auto clouds = test::drive(1);
  SequenceSettings settings = test::drive_settings(8);
  FrameMemory memory, other;
  const auto file = encode(clouds[0], settings.encode);
  ASSERT_TRUE(file);
  const auto first = pack_frame(file->bytes, FrameKind::first, memory);
  const auto again = pack_frame(file->bytes, FrameKind::alone, memory);
  ASSERT_TRUE(first && again);
  EXPECT_LT(again->size() + 20, first->size());
  EXPECT_EQ(unpack_frame(*first, UINT64_MAX, other).value(), file->bytes);
  EXPECT_EQ(unpack_frame(*again, UINT64_MAX, other).value(), file->bytes);
  other.clear();
  EXPECT_FALSE(unpack_frame(*again, UINT64_MAX, other));
}

TEST(Sequence, FramesBytesDoNotDependOnThreads) {
  const auto clouds = test::drive(3);
  SequenceSettings settings = test::drive_settings(3);
  const auto one = encode_all(clouds, settings);
  settings.encode.threads = 3;
  const auto three = encode_all(clouds, settings);
  for (std::size_t i = 0; i < clouds.size(); ++i) EXPECT_EQ(one[i].bytes, three[i].bytes);
}

TEST(Sequence, EmptyScansAndOtherSensorsGoOn) {
  auto clouds = test::drive(2);
  Cloud empty;
  empty.positions.assign(5, Vec3{std::nan(""), std::nan(""), std::nan("")});
  empty.width = 5;
  clouds.insert(clouds.begin() + 1, empty);
  clouds.push_back(Cloud{});
  clouds.push_back(test::scan_of(test::small_sensor(12, 200)));
  SequenceSettings settings = test::drive_settings(8);
  settings.encode.sensor.reset();
  for (const bool image : {false, true}) {
    settings.encode.compact.columns = image ? 256 : 0;
    const auto frames = encode_all(clouds, settings);
    ASSERT_EQ(frames.size(), clouds.size());
    SequenceDecoder decoder;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto scan = decoder.add(frames[i].bytes);
      ASSERT_TRUE(scan) << scan.error().message;
      ASSERT_EQ(scan->cloud.has_value(), !image || count_returns(clouds[i]) == 0);
      if (scan->cloud) {
        EXPECT_EQ(scan->cloud->size(), clouds[i].size());
      }
    }
  }
}

TEST(Sequence, GroupsOfOneAreFirstFramesOnly) {
  for (const EncodedFrame& frame : encode_all(test::drive(2), test::drive_settings(1))) {
    EXPECT_EQ(frame.kind, FrameKind::first);
  }
}

TEST(Sequence, RefusesImpossibleGroups) {
  SequenceSettings settings;
  settings.group = 0;
  EXPECT_FALSE(SequenceEncoder::create(settings));
  settings.group = kMaxSequenceGroup + 1;
  EXPECT_FALSE(SequenceEncoder::create(settings));
}

TEST(Sequence, AScanThatCannotBeCodedLeavesTheSequenceAsItWas) {
  const auto clouds = test::drive(2);
  const SequenceSettings settings = test::drive_settings(4);
  const auto expected = encode_all(clouds, settings);
  auto encoder = SequenceEncoder::create(settings);
  ASSERT_TRUE(encoder);
  EXPECT_EQ(encoder->add(clouds[0])->bytes, expected[0].bytes);
  Cloud broken = clouds[1];
  broken.metadata[""] = "a key without a name";
  EXPECT_FALSE(encoder->add(broken));
  EXPECT_EQ(encoder->add(clouds[1])->bytes, expected[1].bytes);
}

TEST(Sequence, FramesNeedTheirForerunners) {
  const auto frames = encode_all(test::drive(3), test::drive_settings(3));
  SequenceDecoder decoder;
  EXPECT_FALSE(decoder.add(frames[1].bytes));
  ASSERT_TRUE(decoder.add(frames[0].bytes));
  auto damaged = frames[1].bytes;
  damaged.resize(damaged.size() / 3);
  EXPECT_FALSE(decoder.add(damaged));
  EXPECT_FALSE(decoder.add(frames[2].bytes)) << "the frame before it is missing";
  EXPECT_TRUE(decoder.add(frames[0].bytes));
}

TEST(SequenceStamps, TimesComeBackToTheNanosecond) {
  for (const double time :
       {0.0, 0.1036224, -3.25, 1534839184.482107, 1.7e9 + 1e-6, 86399.999999999}) {
    const auto fixed = fixed_time(time);
    ASSERT_TRUE(fixed);
    EXPECT_EQ(time_of(*fixed), time);
  }
  EXPECT_FALSE(fixed_time(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(fixed_time(1e300));
}

TEST(SequenceStamps, PosesComeBackToTheMicrometre) {
  for (int i = 0; i < 200; ++i) {
    const RigidMotion pose = test::some_pose(i);
    const auto fixed = fixed_pose(pose);
    ASSERT_TRUE(fixed) << i;
    const RigidMotion back = pose_of(*fixed);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(norm(back.rotation[k] - pose.rotation[k]), 3e-8);
    }
    EXPECT_LT(norm(back.move - pose.move), 1.7e-6 / 2);
    // What comes back is kept as it is.
    const auto again = fixed_pose(back);
    ASSERT_TRUE(again);
    EXPECT_LT(norm(pose_of(*again).move - back.move), 1e-12);
  }
  RigidMotion mirror;
  mirror.rotation[2] = {0, 0, -1};
  EXPECT_FALSE(fixed_pose(mirror));
  RigidMotion stretched;
  stretched.rotation[0] = {1.1, 0, 0};
  EXPECT_FALSE(fixed_pose(stretched));
  RigidMotion far;
  far.move.x = 1e13;
  EXPECT_FALSE(fixed_pose(far));
}

TEST(SequenceGroup, TellsItsScansAndWhereTheirFramesAre) {
  GroupWriter writer;
  std::vector<std::vector<std::byte>> frames;
  for (std::size_t i = 0; i < 5; ++i) {
    frames.emplace_back(3 + 200 * i, std::byte{7});
    frames.back()[0] = static_cast<std::byte>(i == 0 ? 0 : 1 + i % 2);
    ASSERT_TRUE(writer.add(frames.back(), 1000 - 100 * i,
                           {static_cast<double>(i) / 10, test::some_pose(static_cast<int>(i))}));
  }
  EXPECT_FALSE(writer.add(frames[1], 3, {}));
  EXPECT_EQ(writer.returns(), 4000u);
  const auto part = writer.finish(41);
  const auto group = read_group(part);
  ASSERT_TRUE(group) << group.error().message;
  EXPECT_EQ(group->first_scan, 41u);
  ASSERT_EQ(group->scans.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const GroupScan& scan = group->scans[i];
    const auto frame = ByteSpan(part).subspan(scan.offset, scan.bytes);
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), frames[i].begin(), frames[i].end()));
    EXPECT_EQ(scan.returns, 1000 - 100 * i);
    EXPECT_EQ(scan.stamp.time_s, static_cast<double>(i) / 10);
    ASSERT_TRUE(scan.stamp.T_map_sensor);
    EXPECT_LT(norm(scan.stamp.T_map_sensor->move - test::some_pose(static_cast<int>(i)).move),
              1e-6);
  }
}

TEST(SequenceGroup, CutOffItTellsTheScansThatAreWhole) {
  GroupWriter writer;
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<std::byte> frame(100, std::byte{9});
    frame[0] = static_cast<std::byte>(i == 0 ? 0 : 1);
    ASSERT_TRUE(writer.add(frame, 10, {}));
  }
  const auto part = writer.finish(0);
  std::size_t most = 0;
  for (std::size_t size = 0; size < part.size(); ++size) {
    const auto cut = ByteSpan(part).first(size);
    EXPECT_EQ(read_group(cut).has_value() ? read_group(cut)->scans.size() : 4u, 4u);
    const auto group = read_group(cut, true);
    if (!group) continue;
    EXPECT_EQ(group->scans.size() + group->lost, 4u);
    EXPECT_GE(group->scans.size(), most);
    most = group->scans.size();
  }
  EXPECT_EQ(most, 3u);
}

}  // namespace
}  // namespace curlidar
