// SPDX-License-Identifier: BSD-3-Clause
// PCD files laid out by hand as PCL and others write them.
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
  auto cloud = parse_cloud(bytes, "t.pcd");
  if (!cloud) ADD_FAILURE() << cloud.error().message;
  return cloud ? std::move(*cloud) : Cloud();
}

std::string error_of(const std::vector<std::byte>& bytes) {
  const auto cloud = parse_cloud(bytes, "t.pcd");
  EXPECT_FALSE(cloud);
  return cloud ? "" : cloud.error().message;
}

/// A header with the given lines and data word.
std::vector<std::byte> header(const std::string& fields, const std::string& sizes,
                              const std::string& types, const std::string& counts,
                              std::size_t width, std::size_t height, const std::string& data) {
  return to_bytes("# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS " + fields +
                  "\nSIZE " + sizes + "\nTYPE " + types + "\nCOUNT " + counts + "\nWIDTH " +
                  std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
                  "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) +
                  "\nDATA " + data + "\n");
}

TEST(Pcd, ReadsTheTutorialExample) {
  auto bytes = header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 3, 1, "ascii");
  const auto points = to_bytes(
      "0.93773 0.33763 0 4.2108e+06\n0.90805 0.35641 0 4.2108e+06\r\n0.81915 nan -0 4.2108e+06");
  bytes.insert(bytes.end(), points.begin(), points.end());
  const Cloud cloud = parsed(bytes);
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.width, 3u);
  EXPECT_EQ(cloud.position_type, ScalarType::float32);
  EXPECT_EQ(cloud.positions[0], (Vec3{0.93773f, 0.33763f, 0}));
  EXPECT_TRUE(std::isnan(cloud.positions[2].y));
  EXPECT_TRUE(std::signbit(cloud.positions[2].z));
  ASSERT_EQ(cloud.attributes.size(), 1u);
  EXPECT_EQ(std::get<std::vector<float>>(cloud.find("rgb")->values)[1], 4.2108e+06f);
  EXPECT_TRUE(cloud.metadata.empty());
}

TEST(Pcd, ReadsVersion5WithoutCountHeightAndViewpoint) {
  const Cloud cloud = parsed(
      to_bytes("# .PCD v.5 - Point Cloud Data file format\nVERSION .5\nCOLUMNS x y z\nSIZE 8 8 8\n"
               "TYPE F F F\nWIDTH 2\nPOINTS 2\nDATA ascii\n1 2 3\n\n4e-1 +5 -6\n"));
  EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{1, 2, 3}, {0.4, 5, -6}}));
  EXPECT_EQ(cloud.position_type, ScalarType::float64);
}

TEST(Pcd, ReadsOrganisedBinaryWithPaddingAndComponents) {
  // The memory image of a PCL point with padding, and a field of three numbers.
  auto bytes = header("x y z _ ring normal _", "4 4 4 1 2 4 1", "F F F U U F U", "1 1 1 4 1 3 2", 2,
                      2, "binary");
  for (int i = 0; i < 4; ++i) {
    for (const float v : {0.5f, 1.5f, 2.5f}) put(bytes, v + static_cast<float>(i));
    put(bytes, std::uint32_t{0xdeadbeef});
    put(bytes, static_cast<std::uint16_t>(65535 - i));
    for (const float v : {1.f, 2.f, 3.f}) put(bytes, v * static_cast<float>(i));
    put(bytes, std::uint16_t{0xffff});
  }
  const Cloud cloud = parsed(bytes);
  ASSERT_EQ(cloud.size(), 4u);
  EXPECT_EQ(cloud.width, 2u);
  EXPECT_EQ(cloud.height, 2u);
  EXPECT_EQ(cloud.positions[3], (Vec3{3.5, 4.5, 5.5}));
  ASSERT_EQ(cloud.attributes.size(), 2u);
  EXPECT_EQ(std::get<std::vector<std::uint16_t>>(cloud.find("ring")->values),
            (std::vector<std::uint16_t>{65535, 65534, 65533, 65532}));
  EXPECT_EQ(cloud.find("normal")->components, 3u);
  EXPECT_EQ(std::get<std::vector<float>>(cloud.find("normal")->values),
            (std::vector<float>{0, 0, 0, 1, 2, 3, 2, 4, 6, 3, 6, 9}));
}

TEST(Pcd, ReadsCompressedFieldByField) {
  auto bytes = header("y x z a", "2 2 4 1", "I I F U", "1 1 1 2", 2, 1, "binary_compressed");
  std::vector<std::byte> plain;
  for (const std::int16_t v : {std::int16_t{-1}, std::int16_t{-2}}) put(plain, v);
  for (const std::int16_t v : {std::int16_t{300}, std::int16_t{400}}) put(plain, v);
  for (const float v : {1.25f, -0.f}) put(plain, v);
  for (const int v : {1, 2, 3, 4}) put(plain, static_cast<std::uint8_t>(v));
  put(bytes, static_cast<std::uint32_t>(plain.size() + 1));
  put(bytes, static_cast<std::uint32_t>(plain.size()));
  put(bytes, static_cast<std::uint8_t>(plain.size() - 1));  // one run of literals
  bytes.insert(bytes.end(), plain.begin(), plain.end());
  const Cloud cloud = parsed(bytes);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{300, -1, 1.25}, {400, -2, -0.0}}));
  EXPECT_EQ(cloud.position_type, ScalarType::float32);  // which holds every int16
  EXPECT_EQ(std::get<std::vector<std::uint8_t>>(cloud.find("a")->values),
            (std::vector<std::uint8_t>{1, 2, 3, 4}));
}

TEST(Pcd, WideIntegerCoordinatesAreFloat64) {
  auto bytes = header("x y z", "4 4 4", "I I I", "1 1 1", 1, 1, "binary");
  for (const std::int32_t v : {16777217, -2, 3}) put(bytes, v);
  const Cloud cloud = parsed(bytes);
  EXPECT_EQ(cloud.position_type, ScalarType::float64);
  EXPECT_EQ(cloud.positions[0].x, 16777217);
}

TEST(Pcd, KeepsTheViewpoint) {
  const Cloud cloud = parsed(
      to_bytes("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 1\n"
               "VIEWPOINT 1 0  0 0.5 0.5 0.5 0.5\nPOINTS 0\nDATA binary\n"));
  EXPECT_EQ(cloud.size(), 0u);
  EXPECT_EQ(cloud.metadata.at("viewpoint"), "1 0 0 0.5 0.5 0.5 0.5");
}

TEST(Pcd, WritesTheUsualHeader) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}, {-0.5, 0.25, std::nan("")}};
  cloud.width = 2;
  cloud.attributes.push_back({"ring", 1, std::vector<std::uint16_t>{3, 4}});
  const auto bytes = format_cloud(cloud, "t.pcd", {std::nullopt, Encoding::ascii});
  ASSERT_TRUE(bytes);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()),
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z ring\n"
            "SIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 3 3\n-0.5 0.25 nan 4\n");
}

// ---- headers and points that are wrong: one error with the place ----

std::string with_line(const std::string& from, const std::string& to) {
  std::string text =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n";
  text.replace(text.find(from), from.size(), to);
  return error_of(to_bytes(text));
}

TEST(Pcd, NamesTheLineThatIsWrong) {
  EXPECT_THAT(with_line("FIELDS x y z\n", ""), HasSubstr("FIELDS"));
  EXPECT_THAT(with_line("SIZE 4 4 4", "SIZE 4 4"), HasSubstr("t.pcd: line 3: SIZE"));
  EXPECT_THAT(with_line("SIZE 4 4 4", "SIZE 4 -4 4"), HasSubstr("'-4'"));
  EXPECT_THAT(with_line("SIZE 4 4 4", "SIZE 4 2 4"), HasSubstr("'y' has TYPE 'F' and SIZE '2'"));
  EXPECT_THAT(with_line("TYPE F F F", "TYPE F F X"), HasSubstr("'X'"));
  EXPECT_THAT(with_line("COUNT 1 1 1", "COUNT 1 1 0"), HasSubstr("COUNT '0'"));
  EXPECT_THAT(with_line("COUNT 1 1 1", "COUNT 1 1 2"), HasSubstr("numbers"));
  EXPECT_THAT(with_line("COUNT 1 1 1", "COUNT 1"), HasSubstr("line 5: COUNT"));
  EXPECT_THAT(with_line("COUNT 1 1 1", "COUNT 1 1 4294967295"), HasSubstr("claimed"));
  EXPECT_THAT(with_line("FIELDS x y z", "FIELDS x y w"), HasSubstr("no field 'z'"));
  EXPECT_THAT(with_line("FIELDS x y z", "FIELDS x y y"), HasSubstr("two fields are named 'y'"));
  EXPECT_THAT(with_line("WIDTH 1", "WIDTH -1"), HasSubstr("line 6: WIDTH"));
  EXPECT_THAT(with_line("WIDTH 1", "WIDTH 2"), HasSubstr("POINTS is 1"));
  EXPECT_THAT(with_line("WIDTH 1", "WIDTH 99999999999999999999"), HasSubstr("WIDTH"));
  EXPECT_THAT(with_line("HEIGHT 1", "HIGHT 1"), HasSubstr("'HIGHT'"));
  EXPECT_THAT(with_line("HEIGHT 1", "WIDTH 1"), HasSubstr("a second WIDTH"));
  EXPECT_THAT(with_line("VIEWPOINT 0", "VIEWPOINT"), HasSubstr("VIEWPOINT"));
  EXPECT_THAT(with_line("DATA ascii", "DATA zip"), HasSubstr("line 10: DATA"));
  EXPECT_THAT(with_line("DATA ascii\n1 2 3\n", ""), HasSubstr("DATA"));
  EXPECT_THAT(with_line("1 2 3", "1 2       "), HasSubstr("line 11: the line has too few"));
  EXPECT_THAT(with_line("1 2 3", "1 2 3 4"), HasSubstr("line 11: the line has too many"));
  EXPECT_THAT(with_line("1 2 3", "1 2 0x3"), HasSubstr("'0x3' is no float32 for field 'z'"));
  EXPECT_THAT(with_line("1 2 3", "1 2 1e999"), HasSubstr("'1e999'"));
  EXPECT_THAT(with_line("1 2 3\n", "1 2 3\n4 5 6\n"), HasSubstr("byte"));
}

TEST(Pcd, RefusesWhatOverflows) {
  const std::string head = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    for (const char* size :
         {"WIDTH 4000000000\nHEIGHT 1\n", "WIDTH 4294967295\nHEIGHT 4294967295\n",
          "WIDTH 65536\nHEIGHT 65536\n", "WIDTH 1000000\nHEIGHT 900\n"}) {
      error_of(to_bytes(head + size + "DATA " + data + "\n1 2 3\n                        "));
    }
  }
}

TEST(Pcd, RefusesMorePointsThanTheLimit) {
  auto bytes = header("x y z", "1 1 1", "I I I", "1 1 1", 5, 1, "binary");
  bytes.resize(bytes.size() + 15);
  EXPECT_TRUE(parse_cloud(bytes, "t.pcd", {std::nullopt, {5}}));
  EXPECT_EQ(parse_cloud(bytes, "t.pcd", {std::nullopt, {4}}).error().code,
            ErrorCode::limit_exceeded);
}

TEST(Pcd, RefusesAnLzfBomb) {
  // 100 bytes that claim 4 GB.
  auto bytes = header("x y z", "4 4 4", "F F F", "1 1 1", 333333333, 1, "binary_compressed");
  put(bytes, std::uint32_t{60});
  put(bytes, std::uint32_t{333333333u * 12});
  bytes.resize(bytes.size() + 60, std::byte{0xff});
  EXPECT_THAT(error_of(bytes), HasSubstr("LZF"));
}

TEST(Pcd, AcceptsZerosButNoDataAfterTheLastPoint) {
  auto bytes = header("x y z", "1 1 1", "I I I", "1 1 1", 1, 1, "binary");
  bytes.resize(bytes.size() + 3 + 100);
  EXPECT_EQ(parsed(bytes).size(), 1u);
  bytes.back() = std::byte{1};
  EXPECT_THAT(error_of(bytes), HasSubstr("after the last point"));
}

}  // namespace
}  // namespace curlidar
