// SPDX-License-Identifier: BSD-3-Clause
// PLY files laid out by hand as other tools write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

using test::put;
using test::to_bytes;
using testing::HasSubstr;

Cloud parsed(const std::vector<std::byte>& bytes) {
  auto cloud = parse_cloud(bytes, "t.ply");
  if (!cloud) ADD_FAILURE() << cloud.error().message;
  return cloud ? std::move(*cloud) : Cloud();
}

std::string error_of(const std::vector<std::byte>& bytes) {
  const auto cloud = parse_cloud(bytes, "t.ply");
  EXPECT_FALSE(cloud);
  return cloud ? "" : cloud.error().message;
}

TEST(Ply, ReadsAsciiWithFacesBeforeAndAfter) {
  const Cloud cloud = parsed(
      to_bytes("ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info a b c\r\n"
               "element face 2\r\nproperty list uchar int vertex_indices\r\n"
               "element vertex 2\r\nproperty float x\r\nproperty float32 y\r\nproperty double z\r\n"
               "property uchar red\r\nproperty int16 t\r\n"
               "element edge 1\r\nproperty int a\r\nend_header\r\n"
               "3 0 1 1\r\n4 0 1 1 0\r\n1 2 0.1 255 -3\r\nnan -inf 4 0 4\r\n7\r\n"));
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 0.1}));
  EXPECT_TRUE(std::isnan(cloud.positions[1].x));
  EXPECT_EQ(cloud.positions[1].y, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(cloud.position_type, ScalarType::float64);  // z needs it
  EXPECT_EQ(std::get<std::vector<std::uint8_t>>(cloud.find("red")->values),
            (std::vector<std::uint8_t>{255, 0}));
  EXPECT_EQ(std::get<std::vector<std::int16_t>>(cloud.find("t")->values),
            (std::vector<std::int16_t>{-3, 4}));
  EXPECT_TRUE(cloud.metadata.empty());
}

class PlyBinary : public testing::TestWithParam<bool> {
 protected:
  std::string format() const {
    return std::string("ply\nformat binary_") + (GetParam() ? "big" : "little") + "_endian 1.0\n";
  }
};

TEST_P(PlyBinary, PassesOverOtherElementsAndLists) {
  auto bytes = to_bytes(format() +
                        "element face 2\nproperty list uchar int vertex_indices\n"
                        "property list short double w\nproperty uchar flag\n"
                        "element vertex 3\nproperty float x\nproperty list uint ushort seen\n"
                        "property float y\nproperty float z\nproperty ushort ring\n"
                        "element face2 9\nproperty list uchar int v\nend_header\n");
  const bool big = GetParam();
  for (const std::uint8_t length : {std::uint8_t{3}, std::uint8_t{0}}) {
    put(bytes, length, big);
    for (int i = 0; i < length; ++i) put(bytes, i, big);
    put(bytes, std::int16_t{2}, big);
    put(bytes, 1.0, big);
    put(bytes, 2.0, big);
    put(bytes, std::uint8_t{9}, big);
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const auto f = static_cast<float>(i);
    put(bytes, f, big);
    put(bytes, i, big);
    for (std::uint32_t k = 0; k < i; ++k) put(bytes, std::uint16_t{7}, big);
    put(bytes, f + 0.25f, big);
    put(bytes, f + 0.5f, big);
    put(bytes, static_cast<std::uint16_t>(1000 + i), big);
  }
  const Cloud cloud = parsed(bytes);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{0, 0.25, 0.5}, {1, 1.25, 1.5}, {2, 2.25, 2.5}}));
  EXPECT_EQ(std::get<std::vector<std::uint16_t>>(cloud.find("ring")->values),
            (std::vector<std::uint16_t>{1000, 1001, 1002}));
  EXPECT_EQ(cloud.metadata.at("ply_lists_not_read"), "seen");
}

TEST_P(PlyBinary, RefusesListsThatLeaveTheFile) {
  auto bytes = to_bytes(format() +
                        "element face 1\nproperty list int uchar v\n"
                        "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
                        "end_header\n");
  for (const std::int32_t length : {-1, 5, std::numeric_limits<std::int32_t>::max()}) {
    auto bad = bytes;
    put(bad, length, GetParam());
    bad.resize(bad.size() + 4);
    EXPECT_THAT(error_of(bad), HasSubstr("'face'"));
  }
}

INSTANTIATE_TEST_SUITE_P(Endian, PlyBinary, testing::Bool());

TEST(Ply, ReadsTheOrganisedSizeOnlyIfItFits) {
  const auto with = [](const char* columns, const char* rows) {
    return parsed(to_bytes(std::string("ply\nformat ascii 1.0\nobj_info num_cols ") + columns +
                           "\nobj_info num_rows " + rows +
                           "\nelement vertex 4\nproperty char x\nproperty char y\n"
                           "property char z\nend_header\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n"));
  };
  EXPECT_EQ(with("2", "2").width, 2u);
  EXPECT_EQ(with("2", "2").height, 2u);
  EXPECT_EQ(with("3", "2").height, 1u);
  EXPECT_EQ(with("2", "9223372036854775810").height, 1u);
  EXPECT_EQ(with("2", "2").position_type, ScalarType::float32);
}

TEST(Ply, WritesAPlainHeader) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}};
  cloud.width = 1;
  cloud.position_type = ScalarType::float64;
  cloud.attributes.push_back({"ring", 1, std::vector<std::uint16_t>{3}});
  cloud.attributes.push_back({"normal", 2, std::vector<float>{0.5f, -1}});
  const auto bytes = format_cloud(cloud, "t.ply", {std::nullopt, Encoding::ascii});
  ASSERT_TRUE(bytes);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()),
            "ply\nformat ascii 1.0\ncomment curlidar components normal 2\nelement vertex 1\n"
            "property double x\nproperty double y\nproperty double z\nproperty ushort ring\n"
            "property float normal_0\nproperty float normal_1\nend_header\n1 2 3 3 0.5 -1\n");
}

TEST(Ply, CommentsThatDoNotFitAreIgnored) {
  for (const char* comment : {"n 4294967295", "n 3", "x 2", "n 0", "m 2"}) {
    const Cloud cloud = parsed(
        to_bytes(std::string("ply\nformat ascii 1.0\ncomment curlidar components ") + comment +
                 "\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float n_0\nproperty double n_1\nend_header\n1 2 3 4 5\n"));
    EXPECT_EQ(cloud.attributes.size(), 2u);
  }
}

std::string with_line(const std::string& from, const std::string& to) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n";
  text.replace(text.find(from), from.size(), to);
  return error_of(to_bytes(text));
}

TEST(Ply, NamesTheLineThatIsWrong) {
  EXPECT_THAT(with_line("ascii 1.0", "ascii 2.0"), HasSubstr("t.ply: line 2"));
  EXPECT_THAT(with_line("ascii 1.0", "utf8 1.0"), HasSubstr("'utf8'"));
  EXPECT_THAT(with_line("format ascii 1.0\n", ""), HasSubstr("no format line"));
  EXPECT_THAT(with_line("vertex 1", "vertex -1"), HasSubstr("line 3"));
  EXPECT_THAT(with_line("vertex 1", "vertex 4000000000"), HasSubstr("4000000000"));
  EXPECT_THAT(with_line("vertex 1", "vertex 1000000000"), HasSubstr("claimed"));
  EXPECT_THAT(with_line("vertex 1", "vertex 99999999999999999999"), HasSubstr("line 3"));
  EXPECT_THAT(with_line("vertex", "vertices"), HasSubstr("no vertex"));
  EXPECT_THAT(with_line("float x", "quad x"), HasSubstr("line 4: property 'x'"));
  EXPECT_THAT(with_line("float x", "list float float x"), HasSubstr("'x'"));
  EXPECT_THAT(with_line("float x", "list uchar float x"), HasSubstr("t.ply"));
  EXPECT_THAT(with_line("float z", "float w"), HasSubstr("no field 'z'"));
  EXPECT_THAT(with_line("float z", "float y"), HasSubstr("two fields are named 'y'"));
  EXPECT_THAT(with_line("element vertex 1\n", ""), HasSubstr("before the first element"));
  EXPECT_THAT(with_line("end_header\n", ""), HasSubstr("line 7"));
  EXPECT_THAT(with_line("1 2 3\n", ""), HasSubstr("claimed"));
  EXPECT_THAT(with_line("1 2 3\n", "1 two 3\n"), HasSubstr("line 8: 'two' is no float32"));
  EXPECT_THAT(with_line("element vertex 1\n", "element vertex 1\nelement vertex 1\n"),
              HasSubstr("two vertex"));
}

}  // namespace
}  // namespace curlidar
