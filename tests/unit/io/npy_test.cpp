// SPDX-License-Identifier: BSD-3-Clause
// .npy files laid out by hand as NumPy writes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

using test::put;
using test::to_bytes;
using testing::HasSubstr;

/// Magic, version, length and header text padded to a multiple of 64 bytes.
std::vector<std::byte> npy(const std::string& dictionary, int version = 1) {
  auto bytes = to_bytes("\x93NUMPY");
  put(bytes, static_cast<std::uint8_t>(version));
  put(bytes, std::uint8_t{0});
  std::string text = dictionary;
  while ((8 + (version == 1 ? 2 : 4) + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  if (version == 1) {
    put(bytes, static_cast<std::uint16_t>(text.size()));
  } else {
    put(bytes, static_cast<std::uint32_t>(text.size()));
  }
  const auto tail = to_bytes(text);
  bytes.insert(bytes.end(), tail.begin(), tail.end());
  return bytes;
}

std::string plain(const char* type, const char* shape, bool fortran = false) {
  return std::string("{'descr': '") + type + "', 'fortran_order': " + (fortran ? "True" : "False") +
         ", 'shape': " + shape + ", }";
}

Cloud parsed(const std::vector<std::byte>& bytes) {
  auto cloud = parse_cloud(bytes, "t.npy");
  if (!cloud) ADD_FAILURE() << cloud.error().message;
  return cloud ? std::move(*cloud) : Cloud();
}

std::string error_of(const std::string& dictionary, std::size_t data_bytes) {
  auto bytes = npy(dictionary);
  bytes.resize(bytes.size() + data_bytes);
  const auto cloud = parse_cloud(bytes, "t.npy");
  EXPECT_FALSE(cloud) << dictionary;
  return cloud ? "" : cloud.error().message;
}

template <class T>
std::vector<std::byte> with_range(std::vector<std::byte> bytes, int count, bool big = false) {
  for (int i = 0; i < count; ++i) put(bytes, static_cast<T>(i), big);
  return bytes;
}

TEST(Npy, ReadsPlainArraysOfAllVersionsAndOrders) {
  const std::vector<Vec3> expected{{0, 1, 2}, {3, 4, 5}};
  for (const int version : {1, 2, 3}) {
    EXPECT_EQ(parsed(with_range<float>(npy(plain("<f4", "(2, 3)"), version), 6)).positions,
              expected);
  }
  EXPECT_EQ(parsed(with_range<double>(npy(plain(">f8", "(2, 3)")), 6, true)).positions, expected);
  EXPECT_EQ(parsed(with_range<std::int64_t>(npy(plain("<i8", "(2, 3)")), 6)).positions, expected);
  EXPECT_EQ(parsed(with_range<std::uint16_t>(npy(plain(">u2", "(2, 3)")), 6, true)).positions,
            expected);
  EXPECT_EQ(parsed(with_range<std::uint8_t>(npy(plain("|u1", "(2L, 3L)")), 6)).positions, expected);
  const Cloud fortran = parsed(with_range<float>(npy(plain("<f4", "(2, 3)", true)), 6));
  EXPECT_EQ(fortran.positions, (std::vector<Vec3>{{0, 2, 4}, {1, 3, 5}}));
}

TEST(Npy, TypesOfCoordinates) {
  const auto type = [](const char* name, std::size_t size) {
    auto bytes = npy(plain(name, "(1, 3)"));
    bytes.resize(bytes.size() + 3 * size);
    return parsed(bytes).position_type;
  };
  EXPECT_EQ(type("<f4", 4), ScalarType::float32);
  EXPECT_EQ(type("<f8", 8), ScalarType::float64);
  EXPECT_EQ(type("<i2", 2), ScalarType::float32);
  EXPECT_EQ(type("<i4", 4), ScalarType::float64);
  EXPECT_EQ(type("|b1", 1), ScalarType::float32);
}

TEST(Npy, NamesFurtherColumns) {
  const auto names = [](const char* shape, int count) {
    std::vector<std::string> out;
    for (const auto& a : parsed(with_range<float>(npy(plain("<f4", shape)), count)).attributes) {
      out.push_back(a.name);
    }
    return out;
  };
  EXPECT_EQ(names("(2, 4)", 8), (std::vector<std::string>{"intensity"}));
  EXPECT_EQ(names("(1, 5)", 5), (std::vector<std::string>{"intensity", "ring"}));
  EXPECT_EQ(names("(1, 6)", 6), (std::vector<std::string>{"column3", "column4", "column5"}));
}

TEST(Npy, ReadsOrganisedArrays) {
  const Cloud c = parsed(with_range<float>(npy(plain("<f4", "(2, 3, 4)")), 24));
  EXPECT_EQ(c.width, 3u);
  EXPECT_EQ(c.height, 2u);
  EXPECT_EQ(c.positions[4], (Vec3{16, 17, 18}));
  EXPECT_EQ(c.find("intensity")->as_double(5), 23);
  const Cloud f = parsed(with_range<float>(npy(plain("<f4", "(2, 3, 4)", true)), 24));
  // Element (h, w, k) of a Fortran array of this shape is h + 2 w + 6 k.
  EXPECT_EQ(f.positions[4], (Vec3{1 + 2, 1 + 2 + 6, 1 + 2 + 12}));
  EXPECT_EQ(f.find("intensity")->as_double(2), 4 + 18);
}

TEST(Npy, ReadsStructures) {
  auto bytes =
      npy("{'descr': [('t', '>u4'), ('x', '<f4'), ('y', '<f4'), ('z', '<f8'), ('', '|V4'), "
          "('n', '<i2', (3,)), ('ok', '|b1')], 'fortran_order': False, 'shape': (2,), }");
  for (int i = 0; i < 2; ++i) {
    put(bytes, static_cast<std::uint32_t>(70000 + i), true);
    put(bytes, 1.5f);
    put(bytes, 2.5f);
    put(bytes, 0.1 + i);
    put(bytes, std::uint32_t{0xffffffff});
    for (const int k : {1, 2, 3}) put(bytes, static_cast<std::int16_t>(k * (i + 1)));
    put(bytes, std::uint8_t{1});
  }
  const Cloud cloud = parsed(bytes);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{1.5, 2.5, 0.1}, {1.5, 2.5, 1.1}}));
  EXPECT_EQ(cloud.position_type, ScalarType::float64);
  EXPECT_EQ(std::get<std::vector<std::uint32_t>>(cloud.find("t")->values),
            (std::vector<std::uint32_t>{70000, 70001}));
  EXPECT_EQ(cloud.find("n")->components, 3u);
  EXPECT_EQ(std::get<std::vector<std::int16_t>>(cloud.find("n")->values),
            (std::vector<std::int16_t>{1, 2, 3, 2, 4, 6}));
  EXPECT_EQ(cloud.attributes.size(), 3u);
}

TEST(Npy, WritesWhatNumpyWrites) {
  Cloud cloud;
  cloud.positions = {{0, 1, 2}, {3, 4, 5}};
  cloud.width = 2;
  EXPECT_EQ(*format_cloud(cloud, "t.npy"), with_range<float>(npy(plain("<f4", "(2, 3)")), 6));
  cloud.attributes.push_back({"intensity", 1, std::vector<float>{0, 0}});
  auto four = npy(plain("<f4", "(2, 4)"));
  for (const float v : {0.f, 1.f, 2.f, 0.f, 3.f, 4.f, 5.f, 0.f}) put(four, v);
  EXPECT_EQ(*format_cloud(cloud, "t.npy"), four);
  cloud.attributes[0].name = "ring";
  auto structured =
      npy("{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('ring', '<f4')], 'fortran_order': "
          "False, 'shape': (2,), }");
  structured.insert(structured.end(), four.end() - 32, four.end());
  EXPECT_EQ(*format_cloud(cloud, "t.npy"), structured);
}

TEST(Npy, EmptyArraysAreEmptyClouds) {
  EXPECT_EQ(parsed(npy(plain("<f4", "(0, 4)"))).size(), 0u);
  EXPECT_EQ(parsed(npy(plain("<f4", "(9223372036854775807, 0, 3)"))).height, 1u);
}

TEST(Npy, RefusesWhatIsNoCloud) {
  EXPECT_THAT(error_of(plain("<f4", "(2, 2)"), 16), HasSubstr("(2, 2)"));
  EXPECT_THAT(error_of(plain("<f4", "(3, 1000)"), 12000), HasSubstr("transposed"));
  EXPECT_THAT(error_of(plain("<f4", "(6,)"), 24), HasSubstr("shape (6)"));
  EXPECT_THAT(error_of(plain("<f4", "()"), 4), HasSubstr("shape"));
  EXPECT_THAT(error_of(plain("<f4", "(1, 1, 1, 3)"), 12), HasSubstr("shape"));
  EXPECT_THAT(error_of(plain("<c8", "(1, 3)"), 24), HasSubstr("'<c8'"));
  EXPECT_THAT(error_of(plain("|O", "(1, 3)"), 24), HasSubstr("'|O'"));
  EXPECT_THAT(error_of(plain("<f2", "(1, 3)"), 6), HasSubstr("'<f2'"));
  EXPECT_THAT(error_of("{'descr': [('x', '<f4'), ('y', '<f4')], 'fortran_order': False, "
                       "'shape': (1,), }",
                       8),
              HasSubstr("no field 'z'"));
}

TEST(Npy, RefusesSizesThatDoNotFit) {
  for (const char* shape :
       {"(4000000000, 3)", "(18446744073709551615, 18446744073709551615, 3)",
        "(6148914691236517206, 3)", "(1, 3)", "(3, 3)", "(99999999999999999999, 3)", "(-2, 3)"}) {
    EXPECT_THAT(error_of(plain("<f4", shape), 24), HasSubstr("t.npy: byte")) << shape;
  }
  EXPECT_THAT(error_of("{'descr': [('x', '<f4', (4294967296, 4294967296))], 'fortran_order': "
                       "False, 'shape': (1,), }",
                       8),
              HasSubstr("sub-array"));
}

TEST(Npy, RefusesOtherHeaders) {
  for (const char* text :
       {"", "{", "{}", "{'descr': '<f4'}", "{'descr' '<f4'}", "{'shape': (1, 3), 'shape': (1, 3)}",
        "{'descr': __import__('os'), 'fortran_order': False, 'shape': (1, 3)}",
        "{'descr': '<f4', 'fortran_order': 0, 'shape': (1, 3)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3)} x",
        "{'descr': [('x', [('y', '<f4')])], 'fortran_order': False, 'shape': (1,)}",
        "{'descr': [(('t', 'x'), '<f4')], 'fortran_order': False, 'shape': (1,)}",
        "{'descr': [('x', '<f4'", "{'descr': '", "{'descr': 'f99999999999999999999'}"}) {
    error_of(text, 12);
  }
  auto version = npy(plain("<f4", "(0, 3)"));
  version[6] = std::byte{9};
  EXPECT_EQ(parse_cloud(version, "t.npy").error().code, ErrorCode::unsupported);
}

}  // namespace
}  // namespace curlidar
