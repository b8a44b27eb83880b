// SPDX-License-Identifier: BSD-3-Clause
// tests/golden/points: chunks of points and what they decode to, bit for bit. The second decoder in
// tests/spec is held to the same files. CURLIDAR_MAKE_VECTORS=FOLDER writes them anew.
#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "records/corrections.hpp"
#include "records/directions.hpp"
#include "records/loose.hpp"
#include "unit/records/random_points.hpp"

namespace curlidar {
namespace {

using Json = nlohmann::ordered_json;
using test::Random;

std::string hex(std::uint64_t value, int digits) {
  std::string text(static_cast<std::size_t>(digits), '0');
  for (int i = digits; i-- > 0; value >>= 4) {
    text[static_cast<std::size_t>(i)] = "0123456789abcdef"[value & 15];
  }
  return text;
}

Json json_of(ByteSpan bytes) {
  std::string text;
  for (const std::byte b : bytes) text += hex(static_cast<std::uint64_t>(b), 2);
  return text;
}

Json json_of(const std::vector<Vec3>& points) {
  Json values = Json::array();
  for (const Vec3& p : points) {
    for (const double x : {p.x, p.y, p.z})
      values.push_back(hex(std::bit_cast<std::uint64_t>(x), 16));
  }
  return values;
}

std::vector<std::byte> bytes_of(const Json& json) {
  const auto text = json.get<std::string>();
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::vector<Vec3> points_of(const Json& json) {
  std::vector<double> values;
  for (const auto& word : json) {
    values.push_back(std::bit_cast<double>(
        static_cast<std::uint64_t>(std::stoull(word.get<std::string>(), nullptr, 16))));
  }
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    points.push_back({values[i], values[i + 1], values[i + 2]});
  }
  return points;
}

/// Scan lines side by side, as a sensor at the origin sees a wavy floor; every 50th point is
/// doubled.
std::vector<Vec3> scan_lines(ScalarType type) {
  Random random(31);
  std::vector<Vec3> points;
  for (int line = 0; line < 6; ++line) {
    for (int i = 0; i < 50; ++i) {
      const double azimuth = 0.02 * i, slope = 0.1 + 0.02 * line;
      const double range = 2 / slope * (1 + 0.05 * std::floor(i / 20.0)) + 0.01 * random.uniform();
      const double x = range * (1 - azimuth * azimuth / 2), y = range * azimuth;
      points.push_back(test::of_type(type, Vec3{x, y, -range * slope}));
    }
    points.push_back(points.back());
  }
  return points;
}

std::vector<Vec3> few(std::vector<Vec3> points, std::size_t count) {
  points.resize(count);
  return points;
}

Json loose(const std::vector<Vec3>& points, ScalarType type, const LooseSettings& settings) {
  const auto coded = encode_loose(points, type, settings);
  return {
      {"chunk", "loose"}, {"payload", json_of(coded->bytes)}, {"points", json_of(coded->decoded)}};
}

Json corrections(const std::vector<Vec3>& original, ScalarType type, double bound, double noise) {
  Random random(32);
  std::vector<Vec3> predicted;
  for (const Vec3& p : original) {
    const double by = predicted.size() % 7 == 3 ? 40 * noise : noise;
    predicted.push_back(
        test::of_type(type, p + Vec3{random.uniform(), random.uniform(), random.uniform()} * by));
  }
  const auto coded = encode_corrections(predicted, original, type, {bound});
  return {{"chunk", "corrections"},
          {"payload", json_of(coded->bytes)},
          {"type", to_string(type)},
          {"predicted", json_of(predicted)},
          {"points", json_of(coded->decoded)}};
}

Json json_of(const std::vector<DirectionOffset>& offsets) {
  Json pairs = Json::array();
  for (const DirectionOffset& offset : offsets) pairs.push_back({offset.across, offset.up});
  return pairs;
}

Json directions() {
  constexpr std::uint32_t rows = 12, columns = 40;
  Random random(33);
  std::string flags;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges;
  std::vector<DirectionOffset> offsets;
  for (std::uint32_t i = 0; i < rows * columns; ++i) {
    occupied.push_back(random.next() % 5 != 0);
    flags += occupied.back() != 0 ? '1' : '0';
    if (occupied.back() == 0) continue;
    ranges.push_back(1 + static_cast<std::int32_t>(random.next() % (60 << 16)));
    const auto part = static_cast<std::int32_t>(1000000 * random.uniform());
    offsets.push_back({static_cast<std::int32_t>(i * 7654321u % 100000000u) + part, part / 4});
  }
  const CellGrid grid{rows, columns, occupied, 0};
  const CodedDirections coded = encode_directions(grid, ranges, offsets, 655);
  return {{"chunk", "directions"},
          {"payload", json_of(coded.bytes)},
          {"rows", rows},
          {"columns", columns},
          {"occupied", flags},
          {"ranges", ranges},
          {"offsets", json_of(coded.decoded)}};
}

struct Vector {
  const char* name;
  Json (*make)();
};

constexpr auto k32 = ScalarType::float32, k64 = ScalarType::float64;
const Vector kVectors[] = {
    {"loose-walk",
     [] {
       return loose(test::random_walk(k32, {}, 0.1, 60), k32, {0.01, 0});
     }},
    {"loose-lines",
     [] {
       return loose(scan_lines(k32), k32, {0.01, 0});
     }},
    {"loose-step",
     [] {
       return loose(few(scan_lines(k64), 70), k64, {0, 0.004});
     }},
    {"loose-floats", [] { return loose(few(scan_lines(k32), 120), k32, {}); }},
    {"loose-millimetres", [] { return loose(few(test::millimetres(k32), 110), k32, {}); }},
    {"loose-any-float32", [] { return loose(few(test::any_bits(k32), 50), k32, {}); }},
    {"loose-any-float64",
     [] {
       return loose(few(test::any_bits(k64), 50), k64, {0.5, 0});
     }},
    {"loose-denormals", [] { return loose(few(test::denormals(k64), 20), k64, {}); }},
    {"corrections-bound", [] { return corrections(scan_lines(k32), k32, 0.01, 0.006); }},
    {"corrections-floats", [] { return corrections(few(scan_lines(k32), 90), k32, 0, 1e-5); }},
    {"corrections-doubles", [] { return corrections(few(test::any_bits(k64), 30), k64, 0, 1); }},
    {"corrections-millimetres",
     [] { return corrections(few(test::millimetres(k32), 150), k32, 0, 4e-4); }},
    {"directions", directions},
};

void expect_decodes(const Json& vector) {
  const auto payload = bytes_of(vector.at("payload"));
  const auto kind = vector.at("chunk").get<std::string>();
  if (kind == "directions") {
    std::vector<std::uint8_t> occupied;
    for (const char flag : vector.at("occupied").get<std::string>())
      occupied.push_back(flag == '1');
    const CellGrid grid{vector.at("rows"), vector.at("columns"), occupied, 0};
    const auto ranges = vector.at("ranges").get<std::vector<std::int32_t>>();
    const auto offsets = decode_directions({ChunkType::directions, payload, 0}, grid, ranges);
    ASSERT_TRUE(offsets);
    EXPECT_EQ(json_of(*offsets), vector.at("offsets"));
  } else if (kind == "loose") {
    const auto points = decode_loose({ChunkType::loose, payload, 0}, 100000);
    ASSERT_TRUE(points);
    EXPECT_EQ(json_of(*points), vector.at("points"));
  } else {
    std::vector<Vec3> points = points_of(vector.at("predicted"));
    const ScalarType type = vector.at("type") == "float32" ? k32 : k64;
    ASSERT_TRUE(apply_corrections({ChunkType::corrections, payload, 0}, type, points));
    EXPECT_EQ(json_of(points), vector.at("points"));
  }
}

class PointVectors : public testing::TestWithParam<Vector> {};

TEST_P(PointVectors, DecodeToTheSameBits) {
  namespace fs = std::filesystem;
  const std::string file = std::string(GetParam().name) + ".json";
  if (const char* folder = std::getenv("CURLIDAR_MAKE_VECTORS"); folder != nullptr) {
    std::ofstream(fs::path(folder) / file) << GetParam().make().dump() << '\n';
  }
  std::ifstream in(fs::path(CURLIDAR_TEST_FOLDER) / "../../golden/points" / file);
  ASSERT_TRUE(in) << file << " is missing";
  const Json vector = Json::parse(in);
  expect_decodes(vector);
  // The encoder, too, is a matter of definition: it writes what it wrote.
  EXPECT_EQ(GetParam().make(), vector);
}

INSTANTIATE_TEST_SUITE_P(All, PointVectors, testing::ValuesIn(kVectors), [](const auto& test) {
  std::string name = test.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace curlidar
