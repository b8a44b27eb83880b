// SPDX-License-Identifier: BSD-3-Clause
// Text tables as other tools write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

using test::to_bytes;
using testing::HasSubstr;

Cloud parsed(const std::string& text) {
  auto cloud = parse_cloud(to_bytes(text), "t.csv");
  if (!cloud) ADD_FAILURE() << cloud.error().message;
  return cloud ? std::move(*cloud) : Cloud();
}

std::string error_of(const std::string& text) {
  const auto cloud = parse_cloud(to_bytes(text), "t.csv");
  EXPECT_FALSE(cloud) << text.substr(0, 100);
  return cloud ? "" : cloud.error().message;
}

TEST(Csv, TellsSeparatorsAndHeaders) {
  const std::vector<Vec3> expected{{1, 2, 3}, {-4, 0.5, 6e3}};
  for (const char* text : {
           "1,2,3\n-4,0.5,6e3\n",
           "1 2 3\n-4 +.5 6000",
           "1\t2\t3\r\n-4\t0.5\t6E3\r\n",
           "1;2;3\n-4;0.5;6e3\n",
           " 1 , 2 , 3 ,\n\n# a comment, with commas\n -4 , 0.5 , 6e3,\n",
           "x,y,z\n1,2,3\n-4,0.5,6e3\n",
           "\xef\xbb\xbf\"X\",\"Y\",\"Z\"\n1,2,3\n-4,0.5,6e3\n",
           "z y x\n3 2 1\n6e3 0.5 -4\n",
           "// Z Y X\n3 2 1\n6e3 0.5 -4\n",
           "# made by hand\n# z,y,x\n3 2 1\n6e3 0.5 -4\n",
       }) {
    EXPECT_EQ(parsed(text).positions, expected) << text;
    EXPECT_EQ(parsed(text).position_type, ScalarType::float64);
  }
}

TEST(Csv, NamesAndTypesColumns) {
  const Cloud cloud = parsed(
      "x,y,z,intensity,stamp,big,mixed,zero\n"
      "1,2,3,0.5,-1732848128093928016,18446744073709551615,-1,-0\n"
      "nan,inf,-inf,,1732848128093928017,1,18446744073709551615,0\n");
  EXPECT_TRUE(std::isnan(cloud.positions[1].x));
  EXPECT_EQ(cloud.positions[1].y, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(cloud.find("intensity")->as_double(1)));  // an empty cell
  EXPECT_EQ(std::get<std::vector<std::int64_t>>(cloud.find("stamp")->values),
            (std::vector<std::int64_t>{-1732848128093928016, 1732848128093928017}));
  EXPECT_EQ(std::get<std::vector<std::uint64_t>>(cloud.find("big")->values),
            (std::vector<std::uint64_t>{18446744073709551615u, 1}));
  EXPECT_EQ(type_of(cloud.find("mixed")->values), ScalarType::float64);
  EXPECT_EQ(type_of(cloud.find("zero")->values), ScalarType::float64);  // -0 keeps its sign
}

TEST(Csv, NamesColumnsWithoutAHeader) {
  EXPECT_EQ(parsed("1 2 3 4").attributes[0].name, "intensity");
  EXPECT_EQ(parsed("1 2 3 4 5").attributes[1].name, "ring");
  EXPECT_EQ(parsed("1 2 3 4 5 6").attributes[0].name, "column3");
}

TEST(Csv, HeaderAloneIsAnEmptyCloud) {
  EXPECT_EQ(parsed("x,y,z,ring\n").size(), 0u);
  EXPECT_EQ(parsed("# x y z\n").size(), 0u);
}

TEST(Csv, WritesHeaders) {
  Cloud cloud;
  cloud.positions = {{1, 2.5, -3}};
  cloud.width = 1;
  cloud.attributes.push_back({"n", 2, std::vector<std::int8_t>{-1, 2}});
  const auto text = [&](const char* name) {
    const auto bytes = *format_cloud(cloud, name);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  EXPECT_EQ(text("t.csv"), "x,y,z,n_0,n_1\n1,2.5,-3,-1,2\n");
  EXPECT_EQ(text("t.xyz"), "# x y z n_0 n_1\n1 2.5 -3 -1 2\n");
}

TEST(Csv, NamesTheLineThatIsWrong) {
  EXPECT_THAT(error_of(""), HasSubstr("neither points nor names"));
  EXPECT_THAT(error_of("\n# only words\n"), HasSubstr("neither points nor names"));
  EXPECT_THAT(error_of("1 2\n"), HasSubstr("t.csv: line 1: 2 numbers"));
  EXPECT_THAT(error_of("a,b,c\n1,2,3\n"), HasSubstr("line 1"));
  EXPECT_THAT(error_of("x,y,x,z\n1,2,3,4\n"), HasSubstr("two fields are named 'x'"));
  EXPECT_THAT(error_of("1 2 3\n1 2\n"), HasSubstr("line 2: 2 values"));
  EXPECT_THAT(error_of("1 2 3\n\n1 2 3 4\n"), HasSubstr("line 3: 4 values"));
  EXPECT_THAT(error_of("1 2 3\n1 2 abc\n"), HasSubstr("line 2: 'abc' is no number"));
  EXPECT_THAT(error_of("1,5;2,5;3\n"), HasSubstr("line 1"));
  EXPECT_THAT(error_of("1 2 3 " + std::string(2 << 20, '4')), HasSubstr("line 1: the line has"));
  EXPECT_THAT(error_of("1 2 3\n1 2 " + std::string(2 << 20, '4')), HasSubstr("line 2"));
  EXPECT_THAT(error_of(std::string(10000, ',')), HasSubstr("columns"));
}

TEST(Csv, RefusesMorePointsThanTheLimit) {
  EXPECT_EQ(parse_cloud(to_bytes("1 2 3\n1 2 3\n"), "t.csv", {std::nullopt, {1}}).error().code,
            ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace curlidar
