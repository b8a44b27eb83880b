// SPDX-License-Identifier: BSD-3-Clause
// Every cloud format against files cut at every length and with random damage: a cloud that is
// consistent or one error that names the file; never a crash, a hang or an absurd allocation.
#include <gtest/gtest.h>

#include "curlidar/io.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

using test::Random;

struct Seed {
  std::string name;  ///< tells the format
  std::vector<std::byte> bytes;
  bool is_text = false;  ///< a cut may leave a well-formed file
};

void append_text(std::vector<std::byte>& bytes, const char* text) {
  const auto tail = test::to_bytes(text);
  bytes.insert(bytes.end(), tail.begin(), tail.end());
}

/// A binary PLY with lists, before, inside and after the vertices.
Seed ply_with_lists() {
  Seed seed{"lists.ply", {}, false};
  append_text(seed.bytes,
              "ply\nformat binary_big_endian 1.0\nelement face 2\n"
              "property list uchar int v\nelement vertex 2\nproperty float x\n"
              "property list ushort char l\nproperty float y\nproperty float z\nend_header\n");
  for (int i = 0; i < 2; ++i) {
    test::put(seed.bytes, std::uint8_t{2}, true);
    for (const int k : {i, 5}) test::put(seed.bytes, k, true);
  }
  for (int i = 0; i < 2; ++i) {
    test::put(seed.bytes, 1.5f, true);
    test::put(seed.bytes, static_cast<std::uint16_t>(i), true);
    for (int k = 0; k < i; ++k) test::put(seed.bytes, std::uint8_t{7}, true);
    test::put(seed.bytes, 2.5f, true);
    test::put(seed.bytes, 3.5f, true);
  }
  return seed;
}

std::vector<Seed> seeds() {
  Random random(11);
  Cloud cloud = test::random_positions(random, 12, ScalarType::float32);
  cloud.width = 4;
  cloud.height = 3;
  cloud.metadata["frame_id"] = "a b";
  cloud.attributes.push_back(
      test::random_attribute(random, "ring", ScalarType::uint16, 1, cloud.size()));
  cloud.attributes.push_back(
      test::random_attribute(random, "normal", ScalarType::float32, 3, cloud.size()));
  const auto seed = [&](const char* name, Encoding encoding, bool is_text) {
    auto bytes = format_cloud(cloud, name, {std::nullopt, encoding});
    EXPECT_TRUE(bytes);
    return Seed{name, *bytes, is_text};
  };
  std::vector<Seed> out{seed("a.pcd", Encoding::ascii, true),
                        seed("b.pcd", Encoding::binary, false),
                        seed("c.pcd", Encoding::binary_compressed, false),
                        seed("a.ply", Encoding::ascii, true),
                        seed("b.ply", Encoding::binary, false),
                        seed("c.ply", Encoding::binary_big_endian, false),
                        seed("structured.npy", Encoding::binary, false),
                        seed("a.csv", Encoding::binary, true),
                        seed("a.xyz", Encoding::binary, true),
                        ply_with_lists()};
  cloud.attributes.clear();
  out.push_back(seed("plain.npy", Encoding::binary, false));
  out.push_back(seed("a.bin", Encoding::binary, true));
  out.push_back(seed("a.pcd.bin", Encoding::binary, true));
  return out;
}

/// A cloud must be consistent, an error must name the file.
void check(const Seed& seed, const std::vector<std::byte>& bytes) {
  ReadOptions options;
  options.format = cloud_format_by_extension(seed.name);  // damaged magic: still this parser
  const auto cloud = parse_cloud(bytes, seed.name, options);
  if (!cloud) {
    EXPECT_EQ(cloud.error().message.rfind(seed.name + ":", 0), 0u) << cloud.error().message;
    EXPECT_LT(cloud.error().message.size(), 600u) << cloud.error().message;
    return;
  }
  EXPECT_EQ(std::size_t{cloud->width} * cloud->height, cloud->size());
  EXPECT_LE(cloud->size(), bytes.size());
  for (const Attribute& attribute : cloud->attributes) {
    EXPECT_GE(attribute.components, 1u);
    EXPECT_EQ(size_of(attribute.values), cloud->size() * attribute.components);
  }
}

TEST(HostileClouds, CutAtEveryLength) {
  for (const Seed& seed : seeds()) {
    SCOPED_TRACE(seed.name);
    ASSERT_TRUE(parse_cloud(seed.bytes, seed.name));
    for (std::size_t size = 0; size < seed.bytes.size(); ++size) {
      const std::vector<std::byte> cut(seed.bytes.begin(),
                                       seed.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      check(seed, cut);
      if (!seed.is_text) {
        EXPECT_FALSE(parse_cloud(cut, seed.name)) << size;
      }
    }
  }
}

TEST(HostileClouds, RandomDamage) {
  Random random(23);
  for (const Seed& seed : seeds()) {
    SCOPED_TRACE(seed.name);
    for (int i = 0; i < 3000; ++i) {
      std::vector<std::byte> bytes = seed.bytes;
      // Mostly in the first half, where headers are.
      for (std::uint64_t n = 1 + random.below(4); n > 0; --n) {
        const std::size_t range = random.below(2) == 0 ? bytes.size() : bytes.size() / 2;
        bytes[random.below(range)] = static_cast<std::byte>(random.next());
      }
      check(seed, bytes);
    }
  }
}

TEST(HostileClouds, DigitsOfHeadersReplaced) {
  Random random(29);
  const std::vector<const char*> numbers{"0",          "-1",         "4294967295",
                                         "4294967296", "4000000000", "18446744073709551615",
                                         "1e9",        "nan",        "99999999999999999999"};
  for (const Seed& seed : seeds()) {
    SCOPED_TRACE(seed.name);
    for (std::size_t at = 0; at < std::min<std::size_t>(seed.bytes.size(), 400); ++at) {
      const auto c = std::to_integer<char>(seed.bytes[at]);
      if (c < '0' || c > '9') continue;
      for (const char* number : numbers) {
        std::vector<std::byte> bytes(seed.bytes.begin(),
                                     seed.bytes.begin() + static_cast<std::ptrdiff_t>(at));
        append_text(bytes, number);
        bytes.insert(bytes.end(), seed.bytes.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                     seed.bytes.end());
        check(seed, bytes);
      }
    }
  }
}

TEST(HostileClouds, RandomBytesAsEveryFormat) {
  Random random(31);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes(random.below(200));
    for (auto& b : bytes) b = static_cast<std::byte>(random.next());
    for (const char* name : {"a.pcd", "a.ply", "a.npy", "a.csv", "a.bin", "a.pcd.bin"}) {
      check({name, {}, false}, bytes);
    }
  }
}

TEST(HostileClouds, HugeLines) {
  const std::string digits(3 << 20, '1');
  const std::string words(3 << 20, ' ');
  for (const char* name : {"a.pcd", "a.ply", "a.csv"}) {
    check({name, {}, true}, test::to_bytes(digits));
    check({name, {}, true}, test::to_bytes("1 2 3\n" + words + digits + "\n"));
    check({name, {}, true},
          test::to_bytes("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\n"
                         "DATA ascii\n1 2 3\n1 2 3" +
                         words + digits));
    check({name, {}, true},
          test::to_bytes("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                         "float y\nproperty float z\nend_header\n1 2 3" +
                         digits));
  }
}

}  // namespace
}  // namespace curlidar
