// SPDX-License-Identifier: BSD-3-Clause
// Sequence files: any scan as all of them, stamps, what damage and cuts leave, no half-made file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "codec/sequence_parts.hpp"
#include "curlidar/io.hpp"
#include "format/indexed_file.hpp"
#include "support/sequences.hpp"

namespace curlidar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::size_t kScans = 5;
constexpr std::uint32_t kGroup = 2;

ScanStamp stamp_of(std::size_t scan) {
  return {1.6e9 + 0.1 * static_cast<double>(scan), test::some_pose(static_cast<int>(scan))};
}

class SequenceFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("curlidar-sequence-" + std::to_string(::getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name = "drive.curl") const {
    return (folder_ / name).string();
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  /// Writes the clouds with stamps and gives the bytes of the file.
  std::vector<std::byte> write(const std::vector<Cloud>& clouds, const SequenceSettings& settings) {
    auto writer = SequenceWriter::create(path(), settings);
    EXPECT_TRUE(writer) << writer.error().message;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      const auto frame = writer->add(clouds[i], stamp_of(i));
      EXPECT_TRUE(frame) << frame.error().message;
    }
    const auto size = writer->finish();
    EXPECT_TRUE(size);
    auto bytes = read_file(path());
    EXPECT_TRUE(bytes);
    EXPECT_EQ(bytes->size(), *size);
    return *std::move(bytes);
  }
  std::vector<std::byte> write_drive() {
    return write(test::drive(kScans), test::drive_settings(kGroup));
  }

 private:
  fs::path folder_;
};

Result<SequenceFile> parse(std::vector<std::byte> bytes, bool allow_truncated = false) {
  SequenceReadOptions options;
  options.allow_truncated = allow_truncated;
  return SequenceFile::parse(std::move(bytes), "drive", options);
}

std::vector<Vec3> points_of(SequenceFile& file, std::size_t scan) {
  auto decoded = file.decode(scan);
  EXPECT_TRUE(decoded) << decoded.error().message;
  if (!decoded || !decoded->cloud) return {};
  return decoded->cloud->positions;
}

std::vector<std::vector<Vec3>> all_points(SequenceFile& file) {
  std::vector<std::vector<Vec3>> points;
  for (std::size_t i = 0; i < file.scans(); ++i) points.push_back(points_of(file, i));
  return points;
}

TEST_F(SequenceFiles, AnyScanComesBackAsInARow) {
  const auto clouds = test::drive(kScans);
  const auto bytes = write(clouds, test::drive_settings(kGroup));
  EXPECT_TRUE(is_sequence_file(path()));
  EXPECT_TRUE(is_sequence(bytes));
  auto file = SequenceFile::open(path());
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->scans(), kScans);
  EXPECT_EQ(file->bytes(), bytes.size());
  EXPECT_EQ(file->group_size(), kGroup);
  EXPECT_FALSE(file->still());
  EXPECT_TRUE(file->missing().empty());
  const auto points = all_points(*file);
  std::size_t predicted = 0;
  for (std::size_t i = 0; i < kScans; ++i) {
    ASSERT_EQ(points[i].size(), clouds[i].size());
    double sum = 0;
    for (std::size_t k = 0; k < points[i].size(); ++k) {
      sum += norm(points[i][k] - clouds[i].positions[k]);
    }
    EXPECT_LT(sum / static_cast<double>(points[i].size()), 0.2) << "scan " << i;
    const auto scan = file->scan(i);
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->group, i / kGroup);
    EXPECT_EQ(scan->kind == FrameKind::first, i % kGroup == 0);
    EXPECT_EQ(scan->returns, count_returns(clouds[i]));
    predicted += scan->kind == FrameKind::predicted ? 1 : 0;
  }
  EXPECT_GT(predicted, 0u);
  for (const std::size_t i : {3u, 0u, 4u, 3u, 2u, 1u, 1u, 0u}) {
    EXPECT_TRUE(points_of(*file, i) == points[i]) << i;
    auto fresh = parse(bytes);
    ASSERT_TRUE(fresh);
    EXPECT_TRUE(points_of(*fresh, i) == points[i]) << i;
  }
  const auto behind = file->decode(kScans);
  ASSERT_FALSE(behind);
  EXPECT_EQ(behind.error().code, ErrorCode::invalid_argument);
}

TEST_F(SequenceFiles, TheIndexTellsGroupsWithoutReadingThem) {
  auto file = parse(write_drive());
  ASSERT_TRUE(file);
  const auto groups = file->groups();
  ASSERT_EQ(groups.size(), 3u);
  std::uint64_t scans = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    EXPECT_EQ(groups[i].first_scan, scans);
    EXPECT_EQ(groups[i].scans, i < 2 ? kGroup : 1u);
    EXPECT_EQ(groups[i].time_s, file->scan(scans)->stamp.time_s);
    std::uint64_t returns = 0;
    for (std::size_t k = 0; k < groups[i].scans; ++k) returns += file->scan(scans + k)->returns;
    EXPECT_EQ(groups[i].returns, returns);
    scans += groups[i].scans;
  }
}

TEST_F(SequenceFiles, PartsOfScansDoNotDisturbTheNext) {
  auto file = parse(write(test::drive(3), test::drive_settings(3)));
  ASSERT_TRUE(file);
  const auto points = all_points(*file);
  DecodeOptions field_only;
  field_only.field_only = true;
  ASSERT_TRUE(file->decode(1, field_only));
  EXPECT_TRUE(points_of(*file, 2) == points[2]);
  DecodeOptions part;
  part.region = {0, 4};
  const auto upper = file->decode(1, part);
  ASSERT_TRUE(upper);
  EXPECT_LT(upper->coded_returns, points[1].size() / 2);
  EXPECT_TRUE(points_of(*file, 2) == points[2]);
}

TEST_F(SequenceFiles, ADamagedGroupHarmsNoOther) {
  const auto bytes = write_drive();
  auto whole = parse(bytes);
  ASSERT_TRUE(whole);
  const auto points = all_points(*whole);
  const auto indexed = IndexedFile::open(random_access_of(bytes, "drive"));
  ASSERT_TRUE(indexed);
  for (std::size_t group = 0; group < 3; ++group) {
    const IndexedEntry& part = indexed->entries()[group];
    for (const std::uint64_t at : {std::uint64_t{0}, part.size / 2, part.size - 1}) {
      auto damaged = bytes;
      damaged[part.offset + at] ^= std::byte{0x20};
      auto file = parse(damaged);
      ASSERT_TRUE(file) << file.error().message;
      for (std::size_t i = kScans; i-- > 0;) {
        if (i / kGroup != group) {
          EXPECT_TRUE(points_of(*file, i) == points[i]) << i;
          continue;
        }
        const auto lost = file->decode(i);
        ASSERT_FALSE(lost);
        EXPECT_EQ(lost.error().code, ErrorCode::corrupt);
        EXPECT_THAT(lost.error().message, HasSubstr("group " + std::to_string(group) + " with"));
        EXPECT_FALSE(file->scan(i));
      }
    }
  }
}

TEST_F(SequenceFiles, WithoutItsIndexItIsReadIfThatIsAllowed) {
  const auto bytes = write_drive();
  auto whole = parse(bytes);
  ASSERT_TRUE(whole);
  const auto points = all_points(*whole);
  auto damaged = bytes;
  damaged[damaged.size() - 40] ^= std::byte{1};  // in the index
  const auto refused = parse(damaged);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
  auto file = parse(damaged, true);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->missing().size(), 1u);
  ASSERT_EQ(file->scans(), kScans);
  EXPECT_TRUE(all_points(*file) == points);
  // With a damaged group as well, the numbers of the others tell how many scans it had.
  const auto indexed = IndexedFile::open(random_access_of(bytes, "drive"));
  damaged[indexed->entries()[1].offset + 20] ^= std::byte{1};
  file = parse(damaged, true);
  ASSERT_TRUE(file);
  ASSERT_EQ(file->scans(), kScans);
  EXPECT_FALSE(file->decode(2));
  EXPECT_FALSE(file->decode(3));
  EXPECT_TRUE(points_of(*file, 4) == points[4]);
  EXPECT_TRUE(points_of(*file, 1) == points[1]);
  // Of the last group nobody can know.
  damaged[indexed->entries()[2].offset + 20] ^= std::byte{1};
  file = parse(damaged, true);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->scans(), 2u);
  EXPECT_THAT(file->missing(), testing::Contains(HasSubstr("group 2, which is damaged")));
}

TEST_F(SequenceFiles, CutOffAnywhereItTellsWhatIsThere) {
  const auto bytes = write_drive();
  auto whole = parse(bytes);
  ASSERT_TRUE(whole);
  const auto points = all_points(*whole);
  std::size_t most = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const auto refused = parse(cut);
    ASSERT_FALSE(refused) << size;
    EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
    auto file = parse(cut, true);
    if (!file) {
      EXPECT_EQ(most, 0u) << size;
      continue;
    }
    EXPECT_FALSE(file->missing().empty()) << size;
    ASSERT_GE(file->scans(), most) << size;
    ASSERT_LE(file->scans(), kScans);
    if (file->scans() == most) continue;
    most = file->scans();
    for (std::size_t i = 0; i < most; ++i) {
      EXPECT_EQ(file->scan(i)->stamp.time_s, whole->scan(i)->stamp.time_s);
      EXPECT_TRUE(points_of(*file, i) == points[i]) << i;
    }
  }
  EXPECT_EQ(most, kScans);
}

TEST_F(SequenceFiles, StampsComeBackToTheirPrecision) {
  auto file = parse(write_drive());
  ASSERT_TRUE(file);
  for (std::size_t i = 0; i < kScans; ++i) {
    const ScanStamp stamp = file->scan(i)->stamp, given = stamp_of(i);
    ASSERT_TRUE(stamp.time_s && stamp.T_map_sensor);
    EXPECT_NEAR(*stamp.time_s, *given.time_s, 2e-7);  // what a double holds at 1.6e9
    EXPECT_LT(norm(stamp.T_map_sensor->move - given.T_map_sensor->move), 1e-6);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(norm(stamp.T_map_sensor->rotation[k] - given.T_map_sensor->rotation[k]), 3e-8);
    }
  }
}

TEST_F(SequenceFiles, StampsAtTheirExtremes) {
  const Cloud empty;
  const double farthest_m = std::ldexp(1, 42) * (1 - 1e-12), latest_s = 4.6e9;
  const std::vector<std::pair<double, double>> extremes{{-latest_s, -farthest_m},
                                                        {latest_s, farthest_m},
                                                        {-latest_s, farthest_m},
                                                        {0, 0},
                                                        {latest_s, -farthest_m}};
  auto writer = SequenceWriter::create(path(), test::drive_settings(8));
  ASSERT_TRUE(writer);
  for (const auto& [time_s, x] : extremes) {
    RigidMotion pose;
    pose.move = {x, -x, x};
    ASSERT_TRUE(writer->add(empty, {time_s, pose}));
  }
  RigidMotion beyond;
  beyond.move.y = std::ldexp(1, 43);
  EXPECT_FALSE(writer->add(empty, {0.0, beyond}));
  EXPECT_FALSE(writer->add(empty, {1e10, RigidMotion{}}));
  EXPECT_FALSE(writer->add(empty, {std::numeric_limits<double>::infinity(), RigidMotion{}}));
  ASSERT_TRUE(writer->finish());
  auto file = SequenceFile::open(path());
  ASSERT_TRUE(file);
  ASSERT_EQ(file->scans(), extremes.size());
  for (std::size_t i = 0; i < extremes.size(); ++i) {
    const ScanStamp stamp = file->scan(i)->stamp;
    EXPECT_EQ(stamp.time_s, extremes[i].first);
    EXPECT_NEAR(stamp.T_map_sensor->move.y, -extremes[i].second, 1e-3);
  }
}

TEST_F(SequenceFiles, MixedStampsAreRefusedAndTheSequenceGoesOn) {
  const auto expected = write(test::drive(3), test::drive_settings(3));
  const auto clouds = test::drive(3);
  auto writer = SequenceWriter::create(path("mixed.curl"), test::drive_settings(3));
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add(clouds[0], stamp_of(0)));
  ScanStamp time_only = stamp_of(1), pose_only = stamp_of(1);
  time_only.T_map_sensor.reset();
  pose_only.time_s.reset();
  for (const ScanStamp& stamp : {ScanStamp{}, time_only, pose_only}) {
    const auto refused = writer->add(clouds[1], stamp);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  }
  ASSERT_TRUE(writer->add(clouds[1], stamp_of(1)));
  ASSERT_TRUE(writer->add(clouds[2], stamp_of(2)));
  ASSERT_TRUE(writer->finish());
  EXPECT_TRUE(read_file(path("mixed.curl")).value() == expected);
}

TEST_F(SequenceFiles, GroupsMayDifferInTheirStamps) {
  auto writer = SequenceWriter::create(path(), test::drive_settings(1));
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add({}, {1.5, {}}));
  ASSERT_TRUE(writer->add({}, {}));
  ASSERT_TRUE(writer->add({}, {{}, test::some_pose(3)}));
  ASSERT_TRUE(writer->finish());
  auto file = SequenceFile::open(path());
  ASSERT_TRUE(file);
  EXPECT_EQ(file->scan(0)->stamp.time_s, 1.5);
  EXPECT_FALSE(file->scan(1)->stamp.time_s || file->scan(1)->stamp.T_map_sensor);
  EXPECT_TRUE(file->scan(2)->stamp.T_map_sensor);
  EXPECT_FALSE(file->groups()[1].time_s);
}

TEST_F(SequenceFiles, BytesDoNotDependOnThreads) {
  SequenceSettings settings = test::drive_settings(3);
  const auto one = write(test::drive(4), settings);
  settings.encode.threads = 3;
  EXPECT_TRUE(write(test::drive(4), settings) == one);
}

TEST_F(SequenceFiles, GroupsOfOneAreScansOfTheirOwn) {
  const auto clouds = test::drive(3);
  const SequenceSettings settings = test::drive_settings(1);
  auto file = parse(write(clouds, settings));
  ASSERT_TRUE(file);
  ASSERT_EQ(file->groups().size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(file->scan(i)->kind, FrameKind::first);
    const auto alone = decode(encode(clouds[i], settings.encode)->bytes);
    ASSERT_TRUE(alone && alone->cloud);
    EXPECT_TRUE(points_of(*file, i) == alone->cloud->positions);
  }
}

TEST_F(SequenceFiles, EmptyScansAndOtherSensorsStandInTheMiddle) {
  auto clouds = test::drive(3);
  clouds.insert(clouds.begin() + 1, Cloud{});
  clouds.insert(clouds.begin() + 3, test::scan_of(test::small_sensor(12, 200)));
  SequenceSettings settings = test::drive_settings(8);
  settings.encode.sensor.reset();
  auto file = parse(write(clouds, settings));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->groups().size(), 1u);
  EXPECT_EQ(file->scan(1)->kind, FrameKind::alone);
  EXPECT_EQ(file->scan(1)->returns, 0u);
  EXPECT_NE(file->scan(3)->kind, FrameKind::first);
  const auto points = all_points(*file);
  for (std::size_t i = clouds.size(); i-- > 0;) {
    EXPECT_EQ(points[i].size(), clouds[i].size());
    EXPECT_TRUE(points_of(*file, i) == points[i]) << i;
  }
}

TEST_F(SequenceFiles, NothingIsLeftWithoutFinish) {
  {
    auto writer = SequenceWriter::create(path(), test::drive_settings(2));
    ASSERT_TRUE(writer);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer->add({}));
  }
  EXPECT_EQ(files(), 0u);
  {
    auto writer = SequenceWriter::create(path(), test::drive_settings(2));
    ASSERT_TRUE(writer);
    const auto nothing = writer->finish();
    ASSERT_FALSE(nothing);
    EXPECT_EQ(nothing.error().code, ErrorCode::invalid_argument);
  }
  EXPECT_EQ(files(), 0u);
  // A file that was there stays as it was.
  const auto before = write(test::drive(1), test::drive_settings(2));
  {
    auto writer = SequenceWriter::create(path(), test::drive_settings(2));
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add({}));
    EXPECT_TRUE(read_file(path()).value() == before);
  }
  EXPECT_TRUE(read_file(path()).value() == before);
  EXPECT_EQ(files(), 1u);
  EXPECT_FALSE(SequenceWriter::create(path("no/such/folder.curl"), {}));
}

TEST_F(SequenceFiles, OtherFilesAreRefused) {
  const auto map =
      IndexedWriter::create(path("map.curl"), IndexedKind::surface_map, {}).value().finish();
  ASSERT_TRUE(map);
  EXPECT_FALSE(is_sequence_file(path("map.curl")));
  const auto opened = SequenceFile::open(path("map.curl"));
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::unsupported);
  EXPECT_THAT(opened.error().message, HasSubstr("surface map"));
  const auto scan = encode(test::drive(1)[0], test::drive_settings(1).encode);
  EXPECT_FALSE(is_sequence(scan->bytes));
  EXPECT_FALSE(parse(scan->bytes));
  EXPECT_EQ(SequenceFile::open(path("none.curl")).error().code, ErrorCode::not_found);
  EXPECT_FALSE(is_sequence_file(path("none.curl")));
}

TEST_F(SequenceFiles, AnIndexThatClaimsTooMuchIsRefused) {
  const std::vector<std::byte> part(100);
  for (const std::uint64_t scans : {101u, 65536u}) {
    auto writer =
        IndexedWriter::create(path(), IndexedKind::sequence, write_sequence_head({kGroup, false}));
    ASSERT_TRUE(writer);
    SequencePart told;
    told.scans = scans;
    ASSERT_TRUE(writer->add(part, write_group_summary(told)));
    ASSERT_TRUE(writer->finish());
    const auto file = SequenceFile::open(path());
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::corrupt);
  }
}

TEST_F(SequenceFiles, AGroupElsewhereThanItsPlaceIsRefused) {
  const auto bytes = write_drive();
  const auto indexed = IndexedFile::open(random_access_of(bytes, "drive"));
  ASSERT_TRUE(indexed);
  auto writer =
      IndexedWriter::create(path("swapped.curl"), IndexedKind::sequence, indexed->header());
  ASSERT_TRUE(writer);
  for (const std::size_t i : {1u, 0u, 2u}) {
    ASSERT_TRUE(writer->add(indexed->read(i).value(), indexed->entries()[i].summary));
  }
  ASSERT_TRUE(writer->finish());
  auto file = SequenceFile::open(path("swapped.curl"));
  ASSERT_TRUE(file);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FALSE(file->decode(i)) << i;
  EXPECT_TRUE(file->decode(4));
}

}  // namespace
}  // namespace curlidar
