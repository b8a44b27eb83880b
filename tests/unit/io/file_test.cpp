// SPDX-License-Identifier: BSD-3-Clause
// Whole files: atomic writes, formats by name and content, real scans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"
#include "support/data.hpp"

namespace curlidar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// An empty directory that goes away with the test.
class FileTest : public testing::Test {
 protected:
  FileTest() {
    std::string name = (fs::temp_directory_path() / "curlidar-test-XXXXXX").string();
    directory_ = ::mkdtemp(name.data());
  }
  ~FileTest() override {
    fs::permissions(directory_, fs::perms::owner_all);
    fs::remove_all(directory_);
  }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }
  static std::vector<std::byte> content(const std::string& path) {
    auto bytes = read_file(path);
    EXPECT_TRUE(bytes);
    return bytes ? *bytes : std::vector<std::byte>();
  }

  fs::path directory_;
};

TEST_F(FileTest, WritesAndReplaces) {
  for (const char* text : {"one", "", "a longer text"}) {
    ASSERT_TRUE(write_file(path("f"), test::to_bytes(text)));
    EXPECT_EQ(content(path("f")), test::to_bytes(text));
    EXPECT_EQ(entries(), 1u);
  }
}

TEST_F(FileTest, KeepsPermissionsAndLinks) {
  ASSERT_TRUE(write_file(path("f"), test::to_bytes("old")));
  fs::permissions(path("f"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("f", path("link"));
  ASSERT_TRUE(write_file(path("link"), test::to_bytes("new")));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(content(path("f")), test::to_bytes("new"));
  EXPECT_EQ(fs::status(path("f")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(entries(), 2u);
}

TEST_F(FileTest, LeavesTheOldFileWhenWritingFails) {
  ASSERT_TRUE(write_file(path("a.bin"), test::to_bytes("old")));
  // The cloud cannot be held by the format: nothing is touched.
  Cloud cloud;
  cloud.positions = {{1, 2, 3}};
  cloud.width = 1;
  cloud.attributes.push_back({"ring", 1, std::vector<std::uint16_t>{1}});
  EXPECT_FALSE(write_cloud(path("a.bin"), cloud));
  EXPECT_EQ(content(path("a.bin")), test::to_bytes("old"));
  // Nor does a directory become a file.
  fs::create_directory(path("d"));
  const Status status = write_file(path("d"), test::to_bytes("new"));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::io);
  EXPECT_THAT(status.error().message, HasSubstr(path("d")));
  EXPECT_EQ(entries(), 2u);
}

TEST_F(FileTest, LeavesTheOldFileWhenTheDirectoryIsClosed) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  ASSERT_TRUE(write_file(path("f"), test::to_bytes("old")));
  fs::permissions(directory_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_FALSE(write_file(path("f"), test::to_bytes("new")));
  EXPECT_EQ(content(path("f")), test::to_bytes("old"));
}

TEST_F(FileTest, RemovesTheTemporaryFileWhenTheDiskIsFull) {
  ASSERT_TRUE(write_file(path("f"), test::to_bytes("old")));
  // A limit on the size of files fails a write half way, as a full disk does.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status status = write_file(path("f"), std::vector<std::byte>(100000));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr(path("f")));
  EXPECT_EQ(content(path("f")), test::to_bytes("old"));
  EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, ReportsAFullDevice) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const Status status = write_file("/dev/full", test::to_bytes("text"));
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("/dev/full"));
}

TEST_F(FileTest, WritesToDevices) {
  EXPECT_TRUE(write_file("/dev/null", test::to_bytes("x")));
}

TEST_F(FileTest, NamesMissingFilesAndDirectories) {
  const auto missing = read_file(path("none"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
  EXPECT_THAT(missing.error().message, HasSubstr(path("none")));
  EXPECT_EQ(read_file(directory_.string()).error().code, ErrorCode::io);
  EXPECT_EQ(write_file(path("no/such/file"), {}).error().code, ErrorCode::not_found);
}

TEST_F(FileTest, LongNamesNeedNoLongerTemporaryName) {
  EXPECT_TRUE(write_file(path(std::string(255, 'n')), test::to_bytes("x")));
}

/// Lets a pipe stand in for a standard stream while it lives.
class PipeAs {
 public:
  PipeAs(int stream, int end) : stream_(stream), saved_(::dup(stream)) {
    EXPECT_EQ(::pipe(ends_), 0);
    ::dup2(ends_[end], stream);
    ::close(ends_[end]);
    other_ = ends_[1 - end];
  }
  ~PipeAs() {
    ::dup2(saved_, stream_);
    ::close(saved_);
  }
  int other() const { return other_; }

 private:
  int stream_, saved_, other_ = -1;
  int ends_[2] = {-1, -1};
};

TEST(Streams, DashIsStandardInput) {
  const std::string text = "1 2 3\n4 5 6\n";
  const PipeAs input(STDIN_FILENO, 0);
  ASSERT_EQ(::write(input.other(), text.data(), text.size()), ssize_t(text.size()));
  ::close(input.other());
  const auto cloud = read_cloud("-");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
}

TEST(Streams, ErrorsNameStandardInput) {
  const PipeAs input(STDIN_FILENO, 0);
  ::close(input.other());
  EXPECT_THAT(read_cloud("-").error().message, HasSubstr("standard input"));
}

TEST(Streams, DashIsStandardOutput) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}};
  cloud.width = 1;
  std::string got(100, '\0');
  {
    std::fflush(stdout);
    const PipeAs output(STDOUT_FILENO, 1);
    EXPECT_TRUE(write_cloud("-", cloud, {CloudFormat::csv, Encoding::ascii}));
    const ssize_t size = ::read(output.other(), got.data(), got.size());
    ::close(output.other());
    got.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  }
  EXPECT_EQ(got, "x,y,z\n1,2,3\n");
}

TEST(Format, ByNameAndExtension) {
  for (const CloudFormat format : {CloudFormat::pcd, CloudFormat::ply, CloudFormat::kitti,
                                   CloudFormat::nuscenes, CloudFormat::npy, CloudFormat::csv}) {
    EXPECT_EQ(*cloud_format_by_name(to_string(format)), format);
  }
  EXPECT_EQ(*cloud_format_by_name("xyz"), CloudFormat::csv);
  EXPECT_FALSE(cloud_format_by_name("las"));
  EXPECT_EQ(cloud_format_by_extension("a/b.pcd.bin"), CloudFormat::nuscenes);
  EXPECT_EQ(cloud_format_by_extension("a/b.bin"), CloudFormat::kitti);
  EXPECT_EQ(cloud_format_by_extension("a/B.PCD"), CloudFormat::pcd);
  EXPECT_EQ(cloud_format_by_extension("a.b/c"), std::nullopt);
}

TEST(Format, ContentComesBeforeExtension) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}, {4, 5, 6}};
  cloud.width = 2;
  for (const char* name : {"a.pcd", "a.ply", "a.npy", "a.csv"}) {
    const auto bytes = format_cloud(cloud, name);
    ASSERT_TRUE(bytes);
    for (const char* as : {"a.bin", "standard input", "a.xyz"}) {
      if (std::string_view(name) == "a.csv" && std::string_view(as) == "a.bin") continue;
      const auto back = parse_cloud(*bytes, as);
      ASSERT_TRUE(back) << back.error().message;
      EXPECT_EQ(back->positions, cloud.positions);
    }
  }
}

TEST(Format, ExplicitOneForces) {
  const auto bytes = test::to_bytes("ply\n");
  EXPECT_THAT(parse_cloud(bytes, "a", {CloudFormat::kitti, {}}).error().message,
              HasSubstr("KITTI"));
  EXPECT_EQ(parse_cloud(test::to_bytes("\x01\x02"), "a").error().code, ErrorCode::unsupported);
}

/// Rows of the manifest that are clouds: path and points.
std::vector<std::pair<std::string, std::size_t>> clouds_of_manifest(const fs::path& data) {
  std::vector<std::pair<std::string, std::size_t>> out;
  std::ifstream manifest(data / "MANIFEST.tsv");
  std::string line;
  while (std::getline(manifest, line)) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, '\t');) row.push_back(cell);
    const std::string extension = fs::path(row[0]).extension().string();
    if (extension == ".pcd" || extension == ".bin") out.emplace_back(row[0], std::stoul(row[4]));
  }
  return out;
}

TEST(RealScans, HaveThePointsOfTheManifest) {
  const auto data = test::data_directory();
  if (!data) GTEST_SKIP() << "no real scans here; set CURLIDAR_DATA";
  const auto clouds = clouds_of_manifest(*data);
  EXPECT_FALSE(clouds.empty());
  for (const auto& [name, points] : clouds) {
    const auto cloud = read_cloud((*data / name).string());
    ASSERT_TRUE(cloud) << cloud.error().message;
    // The manifest counts returns for some data sets and slots for others.
    EXPECT_TRUE(cloud->size() == points || count_returns(*cloud) == points)
        << name << ": " << cloud->size() << " slots, " << count_returns(*cloud) << " returns, "
        << points << " in the manifest";
    const bool ouster = name.find("ouster") != std::string::npos;
    EXPECT_EQ(cloud->organised(), ouster) << name;
    EXPECT_EQ(cloud->find("ring") != nullptr, ouster) << name;
  }
}

}  // namespace
}  // namespace curlidar
