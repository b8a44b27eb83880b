// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "base/bytes.hpp"
#include "curlidar/io.hpp"

namespace curlidar {
namespace {

using ::testing::HasSubstr;

class MeshFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  std::string write(const std::string& name, Encoding encoding) {
    path_ = testing::TempDir() + "curlidar_mesh_test_" + name;
    const Status status = write_mesh(path_, vertices_, triangles_, encoding);
    EXPECT_TRUE(status) << (status ? "" : status.error().message);
    const auto bytes = read_file(path_);
    EXPECT_TRUE(bytes);
    if (!bytes) return {};
    return {reinterpret_cast<const char*>(bytes.value().data()), bytes.value().size()};
  }

  std::string path_;
  const std::vector<Vec3> vertices_{{0, 0, 0}, {1.5, 0, 0}, {0, -2, 0.25}};
  const std::vector<std::array<std::uint32_t, 3>> triangles_{{0, 1, 2}, {2, 1, 0}};
};

TEST_F(MeshFile, NormalsGoWithTheirVertices) {
  const std::vector<Vec3> normals{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  path_ = testing::TempDir() + "curlidar_mesh_test_normals.obj";
  ASSERT_TRUE(write_mesh(path_, vertices_, triangles_, Encoding::binary, normals));
  auto bytes = read_file(path_).value();
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
            "v 0 0 0\nv 1.5 0 0\nv 0 -2 0.25\nvn 0 0 1\nvn 0 1 0\nvn -1 0 0\n"
            "f 1//1 2//2 3//3\nf 3//3 2//2 1//1\n");
  std::filesystem::remove(path_);
  path_ = testing::TempDir() + "curlidar_mesh_test_normals.ply";
  ASSERT_TRUE(write_mesh(path_, vertices_, triangles_, Encoding::binary, normals));
  const Cloud back = read_cloud(path_).value();
  EXPECT_EQ(back.positions, vertices_);
  ASSERT_NE(back.find("nz"), nullptr);
  EXPECT_EQ(back.find("nx")->as_double(2), -1);
  EXPECT_EQ(back.find("nz")->as_double(0), 1);
  const Status refused =
      write_mesh(path_, vertices_, triangles_, Encoding::binary, std::span(normals).first(2));
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
}

TEST_F(MeshFile, AsciiPlyByHand) {
  EXPECT_EQ(write("a.ply", Encoding::ascii),
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 2\nproperty list uchar uint vertex_indices\n"
            "end_header\n0 0 0\n1.5 0 0\n0 -2 0.25\n3 0 1 2\n3 2 1 0\n");
}

TEST_F(MeshFile, BinaryPlyByHand) {
  const std::string text = write("b.ply", Encoding::binary);
  EXPECT_THAT(text, HasSubstr("format binary_little_endian 1.0\n"));
  const std::size_t body = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size() - body, 3 * 12u + 2 * 13u);
  ByteReader reader(std::as_bytes(std::span(text.data() + body, text.size() - body)));
  reader.take(12);
  EXPECT_EQ(reader.read<float>(), 1.5f);
  reader.take(2 * 4 + 4);
  EXPECT_EQ(reader.read<float>(), -2.0f);
  EXPECT_EQ(reader.read<float>(), 0.25f);
  EXPECT_EQ(reader.read<std::uint8_t>(), 3);
  EXPECT_EQ(reader.read<std::uint32_t>(), 0u);
  EXPECT_EQ(reader.read<std::uint32_t>(), 1u);
}

TEST_F(MeshFile, ObjCountsFromOne) {
  EXPECT_EQ(write("c.obj", Encoding::binary),
            "v 0 0 0\nv 1.5 0 0\nv 0 -2 0.25\nf 1 2 3\nf 3 2 1\n");
}

TEST_F(MeshFile, FormatsByNameOfAnyCaseOrAsGiven) {
  EXPECT_EQ(mesh_format_by_extension("a.b/x.OBJ"), MeshFormat::obj);
  EXPECT_EQ(mesh_format_by_extension("x.Ply"), MeshFormat::ply);
  for (const char* none : {"", "obj", "x.obj.gz", "x.pcd"}) {
    EXPECT_EQ(mesh_format_by_extension(none), std::nullopt);
  }
  const std::string obj = write("d.obj", Encoding::binary);
  std::filesystem::remove(path_);
  path_ = testing::TempDir() + "curlidar_mesh_test_given.ply";
  ASSERT_TRUE(write_mesh(path_, vertices_, triangles_, Encoding::binary, {}, MeshFormat::obj));
  const auto bytes = read_file(path_).value();
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), obj);
}

TEST_F(MeshFile, OtherEncodingsAreRefused) {
  const Status status = write_mesh("never.ply", vertices_, triangles_, Encoding::binary_compressed);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::unsupported);
  EXPECT_FALSE(std::filesystem::exists("never.ply"));
}

}  // namespace
}  // namespace curlidar
