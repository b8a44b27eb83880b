// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/render.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "render/colours.hpp"

namespace curlidar {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Cloud cloud_of(std::vector<Vec3> positions) {
  Cloud cloud;
  cloud.width = static_cast<std::uint32_t>(positions.size());
  cloud.positions = std::move(positions);
  return cloud;
}

int brightness(const Image& image, int x, int y) {
  const auto i = 3 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x));
  return image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2];
}

/// Whether a pixel differs clearly from the background of its row's far right end.
bool is_drawn(const Image& image, int x, int y) {
  return brightness(image, x, y) > brightness(image, static_cast<int>(image.width) - 1, y) + 60;
}

TEST(Render, PerspectivePutsPointsWhereAPinholeDoes) {
  RenderSettings settings;
  settings.width = 400;
  settings.height = 300;
  settings.yaw_deg = 0;  // seen from +x: +y is to the right
  settings.pitch_deg = 0;
  settings.distance_m = 10;
  settings.point_size_px = 3;
  const Cloud cloud = cloud_of({{0, 2, 0}, {0, -1, 0}, {5, 0, 0}, {0, 0, 1}});
  const auto image = render(cloud, settings);
  ASSERT_TRUE(image);
  const double focal = 200 / std::tan(24 * std::numbers::pi / 180);
  const auto x = [&](double right, double depth) {
    return static_cast<int>(200 + focal * right / depth);
  };
  EXPECT_TRUE(is_drawn(*image, x(2, 10), 150));
  EXPECT_TRUE(is_drawn(*image, x(-1, 10), 150));
  EXPECT_TRUE(is_drawn(*image, 200, 150));
  EXPECT_TRUE(is_drawn(*image, 200, static_cast<int>(150 - focal / 10)));
  EXPECT_FALSE(is_drawn(*image, x(2, 10) + 6, 150));
  EXPECT_FALSE(is_drawn(*image, x(2, 10), 158));
}

TEST(Render, PerspectiveFromAboveShowsHeightUpwards) {
  RenderSettings settings;
  settings.width = 400;
  settings.height = 400;
  settings.distance_m = 10;
  settings.yaw_deg = 180;  // from behind: left is left
  settings.pitch_deg = 60;
  settings.point_size_px = 4;
  const auto image = render(cloud_of({{0, 1, 0}, {0, 0.001, 0}, {0, 0, -0.001}}), settings);
  ASSERT_TRUE(image);
  const double focal = 200 / std::tan(24 * std::numbers::pi / 180);
  EXPECT_TRUE(is_drawn(*image, static_cast<int>(200 - focal / 10), 200));
}

TEST(Render, PointsBehindTheCameraAreLeftOut) {
  RenderSettings settings;
  settings.yaw_deg = 0;
  settings.pitch_deg = 0;
  settings.distance_m = 10;
  settings.width = 64;
  EXPECT_TRUE(render(cloud_of({{11, 0, 0}, {10, 0, 0}, {1e30, 0, 0}, {-1e30, 1e30, 0}}), settings));
}

TEST(Render, BirdsEyeHasForwardUpAndLeftLeft) {
  RenderSettings settings;
  settings.view = View::birds_eye;
  settings.width = 200;
  settings.extent_m = 10;  // 10 pixels a metre
  settings.point_size_px = 3;
  const auto image = render(cloud_of({{5.05, 0, 0}, {0, 7.05, 1}}), settings);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->height, 200u);
  EXPECT_TRUE(is_drawn(*image, 100, 49));
  EXPECT_TRUE(is_drawn(*image, 29, 100));
  EXPECT_FALSE(is_drawn(*image, 100, 140));
  EXPECT_TRUE(is_drawn(*image, 103, 100));  // the sensor's cross
}

/// 4 x 8 cells whose columns turn left or right and rows go down or up, range 5 but one cell of 9.
Cloud organised(bool leftwards, bool upwards, Vec3 far_cell) {
  Cloud cloud;
  cloud.width = 8;
  cloud.height = 4;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 8; ++j) {
      const double azimuth = (leftwards ? 1 : -1) * (-2.8 + 0.8 * j);
      const double elevation = (upwards ? -1 : 1) * (0.15 - 0.1 * i);
      const Vec3 d = direction_of(elevation, azimuth);
      const bool far = dot(d, far_cell) > 0.995 * norm(far_cell);
      cloud.positions.push_back(d * (far ? 9 : 5));
    }
  }
  return cloud;
}

TEST(Render, RangeImagesShowWhatTheSensorSees) {
  RenderSettings settings;
  settings.view = View::range_image;
  settings.colour = ColourBy::range;
  settings.width = 80;
  settings.value_min = 5;
  settings.value_max = 9;
  const Vec3 upper_left = direction_of(0.15, 1.2);
  for (const bool leftwards : {true, false}) {
    for (const bool upwards : {true, false}) {
      const auto image = render(organised(leftwards, upwards, upper_left), settings);
      ASSERT_TRUE(image);
      // Azimuth 1.2 is the third of eight columns from the left; the top row is the first.
      EXPECT_GT(brightness(*image, 25, 2), 600) << leftwards << upwards;
      EXPECT_LT(brightness(*image, 55, 2), 400) << leftwards << upwards;
      EXPECT_LT(brightness(*image, 25, 17), 400) << leftwards << upwards;
    }
  }
}

TEST(Render, RangeImageOfAnUnorganisedScanUsesItsRings) {
  Cloud cloud;
  std::vector<std::uint16_t> ring;
  for (std::uint16_t r = 0; r < 16; ++r) {
    for (int j = 0; j < 360; ++j) {
      const double azimuth = std::numbers::pi * (j - 180 + 0.5) / 180;
      const bool left_top = azimuth > 0.2 && r < 8;
      cloud.positions.push_back(direction_of(0.26 - 0.03 * r, azimuth) * (left_top ? 20 : 5));
      ring.push_back(r);
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  cloud.attributes.push_back({"ring", 1, ring});
  RenderSettings settings;
  settings.view = View::range_image;
  settings.colour = ColourBy::range;
  settings.width = 360;
  const auto image = render(cloud, settings);
  ASSERT_TRUE(image);
  EXPECT_GT(brightness(*image, 90, 10), 600);
  EXPECT_LT(brightness(*image, 270, 10), 400);
  EXPECT_LT(brightness(*image, 90, 70), 400);
}

TEST(Render, HeightsAreAsAsked) {
  RenderSettings settings;
  settings.width = 128;
  settings.height = 100;
  for (const View view : {View::range_image, View::birds_eye, View::perspective}) {
    settings.view = view;
    for (const char* title : {"", "a title"}) {
      settings.title = title;
      const auto image = render(organised(true, false, {}), settings);
      ASSERT_TRUE(image);
      EXPECT_EQ(image->width, 128u);
      EXPECT_EQ(image->height, 100u);
      EXPECT_EQ(image->rgb.size(), 128u * 100 * 3);
    }
  }
}

TEST(Render, ErrorsAreShownByTheGivenValues) {
  RenderSettings settings;
  settings.view = View::birds_eye;
  settings.colour = ColourBy::error;
  settings.width = 100;
  settings.extent_m = 10;
  settings.point_size_px = 6;
  settings.value_max = 1;
  const auto image = render(cloud_of({{5, 5, 0}, {5, -5, 0}}), settings, {0, 1});
  ASSERT_TRUE(image);
  const drawing::Colour good = drawing::map_error(0), bad = drawing::map_error(1);
  EXPECT_NEAR(image->rgb[3 * (25 * 100 + 25)], good.r * 255, 1.5);
  EXPECT_NEAR(image->rgb[3 * (25 * 100 + 75)], bad.r * 255, 1.5);
}

TEST(Render, ClippingTakesTheCeilingOff) {
  RenderSettings settings;
  settings.view = View::birds_eye;
  settings.width = 100;
  settings.extent_m = 10;
  settings.clip_above_m = 2;
  const auto image = render(cloud_of({{5, 5, 0}, {5, -5, 3}}), settings);
  ASSERT_TRUE(image);
  EXPECT_TRUE(is_drawn(*image, 25, 25));
  EXPECT_FALSE(is_drawn(*image, 75, 25));
  EXPECT_FALSE(render(cloud_of({{5, -5, 3}}), settings));
}

TEST(Render, SameInputSamePicture) {
  const Cloud cloud = organised(true, false, {});
  EXPECT_EQ(render(cloud, {})->rgb, render(cloud, {})->rgb);
}

TEST(Render, CloudsWithoutReturnsAreErrors) {
  for (const Cloud& cloud : {cloud_of({}), cloud_of({{0, 0, 0}, {kNaN, 1, 2}})}) {
    for (const View view : {View::range_image, View::birds_eye, View::perspective}) {
      RenderSettings settings;
      settings.view = view;
      const auto image = render(cloud, settings);
      ASSERT_FALSE(image);
      EXPECT_EQ(image.error().code, ErrorCode::invalid_argument);
    }
  }
}

TEST(Render, OneReturnAmongNoneIsDrawn) {
  for (const View view : {View::range_image, View::birds_eye, View::perspective}) {
    RenderSettings settings;
    settings.view = view;
    settings.width = 64;
    EXPECT_TRUE(render(cloud_of({{kNaN, kNaN, kNaN}, {3, 2, 1}, {0, 0, 0}}), settings));
  }
}

TEST(Render, BadSettingsAreErrors) {
  const Cloud cloud = cloud_of({{1, 2, 3}});
  const auto refused = [&](auto change) {
    RenderSettings settings;
    change(settings);
    return !render(cloud, settings);
  };
  EXPECT_TRUE(refused([](auto& s) { s.width = 0; }));
  EXPECT_TRUE(refused([](auto& s) { s.width = 100000; }));
  EXPECT_TRUE(refused([](auto& s) { s.height = 3; }));
  EXPECT_TRUE(refused([](auto& s) { s.point_size_px = -1; }));
  EXPECT_TRUE(refused([](auto& s) { s.yaw_deg = kNaN; }));
  EXPECT_TRUE(refused([](auto& s) { s.extent_m = kNaN; }));
  EXPECT_TRUE(refused([](auto& s) { s.value_min = 2, s.value_max = 1; }));
  EXPECT_TRUE(refused([](auto& s) { s.value_min = kNaN; }));
  EXPECT_TRUE(refused([](auto& s) { s.colour = ColourBy::error; }));
  EXPECT_TRUE(refused([](auto& s) { s.colour = ColourBy::intensity; }));
  EXPECT_FALSE(refused([](auto& s) { s.value_max = -50; }));  // only one end given
  EXPECT_FALSE(refused([](auto&) {}));
}

TEST(Render, NamesAreKnown) {
  EXPECT_EQ(*view_by_name("birds-eye"), View::birds_eye);
  EXPECT_EQ(*view_by_name("range-image"), View::range_image);
  EXPECT_EQ(*view_by_name("perspective"), View::perspective);
  EXPECT_EQ(*colour_by_name("error"), ColourBy::error);
  EXPECT_EQ(*colour_by_name("intensity"), ColourBy::intensity);
  EXPECT_NE(view_by_name("top").error().message.find("birds-eye"), std::string::npos);
  EXPECT_FALSE(colour_by_name(""));
}

TEST(SideBySide, KeepsPicturesApartAndInOrder) {
  const Image red{2, 3, std::vector<std::uint8_t>(18, 200)};
  const Image dark{4, 1, std::vector<std::uint8_t>(12, 10)};
  const Image both = side_by_side({red, dark});
  EXPECT_EQ(both.width, 10u);
  EXPECT_EQ(both.height, 3u);
  EXPECT_EQ(both.rgb.size(), 90u);
  EXPECT_EQ(both.rgb[3 * 1], 200);
  EXPECT_EQ(both.rgb[3 * 6], 10);
  EXPECT_NE(both.rgb[3 * 3], 200);        // the gap
  EXPECT_NE(both.rgb[3 * (10 + 6)], 10);  // below the lower picture
  EXPECT_EQ(side_by_side({red}).rgb, red.rgb);
  EXPECT_EQ(side_by_side({}).width, 0u);
}

}  // namespace
}  // namespace curlidar
