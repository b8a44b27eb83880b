// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "curlidar/sensor.hpp"
#include "unit/sensor/synthetic.hpp"

namespace curlidar {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

void expect_same(const SensorProfile& a, const SensorProfile& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.description, b.description);
  EXPECT_EQ(a.pattern, b.pattern);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.fov_up, b.fov_up);
  EXPECT_EQ(a.fov_down, b.fov_down);
  EXPECT_EQ(a.min_range_m, b.min_range_m);
  EXPECT_EQ(a.max_range_m, b.max_range_m);
  EXPECT_EQ(a.beam_origin_radius_m, b.beam_origin_radius_m);
  EXPECT_EQ(a.slots, b.slots);
  EXPECT_EQ(a.range_unit_m, b.range_unit_m);
  ASSERT_EQ(a.rings.size(), b.rings.size());
  for (std::size_t i = 0; i < a.rings.size(); ++i) {
    EXPECT_EQ(a.rings[i].elevation, b.rings[i].elevation) << a.name << " ring " << i;
    EXPECT_EQ(a.rings[i].azimuth_offset, b.rings[i].azimuth_offset);
    EXPECT_EQ(a.rings[i].vertical_offset_m, b.rings[i].vertical_offset_m);
    EXPECT_EQ(a.rings[i].horizontal_offset_m, b.rings[i].horizontal_offset_m);
    EXPECT_EQ(a.rings[i].range_phase_m, b.rings[i].range_phase_m);
  }
}

TEST(SensorToml, ReadsAShortDescription) {
  const auto sensor = parse_sensor_toml(R"(
name = "mine"
columns = 720
max_range_m = 60.5
[rings]
elevation_deg = [10, 0.5, -10.25]
azimuth_offset_deg = [1, 0, -1]
)",
                                        "mine.toml");
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->name, "mine");
  EXPECT_EQ(sensor->columns, 720u);
  EXPECT_EQ(sensor->max_range_m, 60.5);
  ASSERT_EQ(sensor->rings.size(), 3u);
  EXPECT_DOUBLE_EQ(sensor->rings[2].elevation, -10.25 * kDegree);
  EXPECT_DOUBLE_EQ(sensor->rings[2].azimuth_offset, -kDegree);
  // Without a stated field of view the outermost rings bound it.
  EXPECT_EQ(sensor->fov_up, sensor->rings.front().elevation);
  EXPECT_EQ(sensor->fov_down, sensor->rings.back().elevation);
}

TEST(SensorToml, KeepsTheSensorsOwnLattice) {
  const auto sensor = parse_sensor_toml(R"(
slots = 36000
range_unit_m = 0.002
[rings]
elevation_deg = [1, -1]
range_phase_m = [0.0004, -0.0007]
)",
                                        "mine.toml");
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->slots, 36000u);
  EXPECT_EQ(sensor->range_unit_m, 0.002);
  EXPECT_EQ(sensor->rings[1].range_phase_m, -0.0007);
  const auto again = parse_sensor_toml(sensor_to_toml(*sensor), "again.toml");
  ASSERT_TRUE(again) << again.error().message;
  expect_same(*sensor, *again);
}

TEST(SensorToml, RefusesImpossibleLattices) {
  const auto read = [](const std::string& line) {
    return parse_sensor_toml(line + "\n[rings]\nelevation_deg = [1, -1]\n", "mine.toml");
  };
  for (const char* line : {"slots = 0", "slots = 5000000", "slots = 1.5", "range_unit_m = -0.1",
                           "range_unit_m = 11", "range_unit_m = nan"}) {
    EXPECT_FALSE(read(line)) << line;
  }
  EXPECT_TRUE(read("slots = 4000"));
}

TEST(SensorToml, SpreadsUniformRings) {
  const auto sensor = parse_sensor_toml(
      "fov_up_deg = 10\nfov_down_deg = -20\n[rings]\nuniform = 4\n", "uniform.toml");
  ASSERT_TRUE(sensor) << sensor.error().message;
  ASSERT_EQ(sensor->rings.size(), 4u);
  EXPECT_NEAR(sensor->rings[1].elevation, 0, 1e-15);
  EXPECT_EQ(sensor->rings[3].elevation, sensor->fov_down);
}

TEST(SensorToml, BuiltInSensorsRoundTripExactly) {
  for (const std::string& name : builtin_sensor_names()) {
    const auto sensor = builtin_sensor(name);
    ASSERT_TRUE(sensor);
    const auto again = parse_sensor_toml(sensor_to_toml(*sensor), name);
    ASSERT_TRUE(again) << again.error().message;
    expect_same(*sensor, *again);
  }
}

TEST(SensorToml, AnyAnglesRoundTripExactly) {
  test::Random random(21);
  for (int trial = 0; trial < 50; ++trial) {
    SensorProfile sensor;
    sensor.name = "odd \"name\"\\\n\t\x7f \xc3\xa9";
    sensor.pattern = trial % 2 == 0 ? ScanPattern::spinning : ScanPattern::limited_field;
    sensor.beam_origin_radius_m = trial % 3 == 0 ? 0 : random.uniform();
    double elevation = 1.5;
    for (int i = 0; i < 20; ++i) {
      elevation -= 0.001 + 0.1 * random.uniform();
      sensor.rings.push_back(
          {elevation, random.normal() / 10, random.normal() / 10, random.normal() / 10});
    }
    sensor.fov_up = random.uniform();
    sensor.fov_down = -random.uniform();
    sensor.min_range_m = random.uniform();
    sensor.max_range_m = 10 + 1e3 * random.uniform();
    const auto again = parse_sensor_toml(sensor_to_toml(sensor), "again");
    ASSERT_TRUE(again) << again.error().message;
    expect_same(sensor, *again);
  }
}

TEST(SensorToml, WritesReadableDegrees) {
  const auto sensor = builtin_sensor("vlp16");
  ASSERT_TRUE(sensor);
  EXPECT_THAT(sensor_to_toml(*sensor), AllOf(HasSubstr("elevation_deg = [\n  15, 13, 11,"),
                                             HasSubstr("fov_down_deg = -15")));
}

struct Mistake {
  const char* name;
  const char* text;
  ErrorCode code;
  const char* line;
  const char* message;
};

class SensorTomlMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SensorTomlMistakes, NameTheFileTheLineAndTheReason) {
  const Mistake& mistake = GetParam();
  const auto sensor = parse_sensor_toml(mistake.text, "my.toml");
  ASSERT_FALSE(sensor);
  EXPECT_EQ(sensor.error().code, mistake.code);
  EXPECT_THAT(sensor.error().message, AllOf(HasSubstr("my.toml, line " + std::string(mistake.line)),
                                            HasSubstr(mistake.message)));
}

constexpr auto kBad = ErrorCode::invalid_argument;
INSTANTIATE_TEST_SUITE_P(
    Text, SensorTomlMistakes,
    testing::Values(
        Mistake{"NotToml", "name = \"a\"\n= 3\n", ErrorCode::corrupt, "2", "not TOML"},
        Mistake{"Open", "[rings]\nelevation_deg = [1, ", ErrorCode::corrupt, "2", "not TOML"},
        Mistake{"NoKeyInHeader", "[=]\n", ErrorCode::corrupt, "1", "not TOML"},
        Mistake{"Empty", "", kBad, "", "[rings]"},
        Mistake{"RingsNoTable", "rings = 3\n", kBad, "1", "[rings]"},
        Mistake{"NoRings", "\n[rings]\n", kBad, "2", "elevation_deg"},
        Mistake{"UnknownKey", "\nfov_upp_deg = 1\n[rings]\nelevation_deg=[1]", kBad, "2",
                "fov_upp_deg"},
        Mistake{"UnknownRingKey", "[rings]\nelevation_deg=[1]\nelevation=[1]", kBad, "3",
                "\"elevation\""},
        Mistake{"TextForNumber", "max_range_m = \"far\"\n[rings]\nelevation_deg=[1]", kBad, "1",
                "must be a number"},
        Mistake{"NumberForText", "name = 3\n[rings]\nelevation_deg=[1]", kBad, "1",
                "must be a string"},
        Mistake{"Pattern", "pattern = \"round\"\n[rings]\nelevation_deg=[1]", kBad, "1", "pattern"},
        Mistake{"TextInList", "[rings]\nelevation_deg=[1,\n\"x\"]", kBad, "3", "numbers only"},
        Mistake{"Lengths", "[rings]\nelevation_deg=[2,1]\nazimuth_offset_deg=[1]", kBad, "3",
                "there are 2 rings"},
        Mistake{"BothUnits", "[rings]\nelevation_deg=[1]\nelevation_rad=[1]", kBad, "3",
                "not both"},
        Mistake{"BothKinds", "fov_up_deg=1\nfov_down_deg=0\n[rings]\nelevation_deg=[1]\nuniform=4",
                kBad, "5", "not both"},
        Mistake{"UniformOfNothing", "[rings]\nuniform=4", kBad, "1", "fov_up_deg"},
        Mistake{"TooManyUniform", "fov_up_deg=1\nfov_down_deg=0\n[rings]\nuniform=1000000000000",
                kBad, "4", "1024"},
        Mistake{"Columns", "columns = 1e9\n[rings]\nelevation_deg=[1]", kBad, "1", "columns"},
        Mistake{"Ascending", "[rings]\nelevation_deg=[1,2]", kBad, "1", "descend"},
        Mistake{"Nan", "[rings]\nelevation_deg=[nan]", kBad, "1", "elevation"},
        Mistake{"Inf", "max_range_m = inf\n[rings]\nelevation_deg=[1]", kBad, "2", "ranges"},
        Mistake{"Steep", "[rings]\nelevation_deg=[91]", kBad, "1", "90 degrees"}),
    [](const auto& param) { return std::string(param.param.name); });

TEST(SensorToml, TakesCharactersOfAllLanguages) {
  const auto sensor = parse_sensor_toml(
      "# Gr\xc3\xbc\xc3\x9f"
      "e \xe6\xbf\x80\xe5\x85\x89 \xf0\x9f\x9a\x97\nname = \"\xc3\xa9\xe5\x85\x89"
      "\xf0\x9f\x9a\x97\"\n[rings]\nelevation_deg = [1]\n",
      "utf8.toml");
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->name, "\xc3\xa9\xe5\x85\x89\xf0\x9f\x9a\x97");
}

TEST(SensorToml, RefusesStrayAndMalformedCharacters) {
  // Outside strings: é, a Cyrillic letter, an Ethiopic one, U+2010, an emoji.
  for (const char* stray :
       {"\xc3\xa9", "\xd0\xb6", "\xe1\x8d\xa0", "\xe2\x80\x90", "\xf0\x9f\x9a\x97"}) {
    const auto sensor = parse_sensor_toml("[rings]\n" + std::string(stray) + " = 1", "stray");
    ASSERT_FALSE(sensor);
    EXPECT_THAT(sensor.error().message, HasSubstr("line 2"));
    EXPECT_FALSE(parse_sensor_toml("a = [1, " + std::string(stray) + "2]", "stray"));
  }
  // Truncated, overlong, surrogate, beyond the last, a lone continuation.
  for (const char* malformed : {"\xc3", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80",
                                "\xf4\x90\x80\x80", "\x80", "\xff", "\xe2\x80"}) {
    const auto sensor = parse_sensor_toml("name = \"" + std::string(malformed), "bytes");
    ASSERT_FALSE(sensor);
    EXPECT_THAT(sensor.error().message, HasSubstr("not UTF-8"));
  }
}

TEST(SensorToml, SurvivesAnyDamage) {
  const std::string good = sensor_to_toml(*builtin_sensor("pandar40p"));
  test::Random random(33);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text = good.substr(0, random.below(good.size()) + 1);
    for (std::size_t i = random.below(8); i > 0; --i) {
      text[random.below(text.size())] = static_cast<char>(random.below(256));
    }
    const auto sensor = parse_sensor_toml(text, "damaged");
    if (sensor) {
      EXPECT_TRUE(validate(*sensor));
    } else {
      EXPECT_FALSE(sensor.error().message.empty());
    }
  }
  EXPECT_FALSE(parse_sensor_toml(std::string(100000, '['), "deep"));
  EXPECT_FALSE(parse_sensor_toml("a = " + std::string(100000, '['), "deep"));
  EXPECT_FALSE(parse_sensor_toml(std::string("\0\0\0", 3), "zeros"));
}

}  // namespace
}  // namespace curlidar
