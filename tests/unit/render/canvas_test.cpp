// SPDX-License-Identifier: BSD-3-Clause
#include "render/canvas.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "render/font.hpp"
#include "render/scale.hpp"
#include "render/splats.hpp"

namespace curlidar::drawing {
namespace {

double lightness(const Colour& c) {
  return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

TEST(Colours, ValueMapGrowsLighterAllTheWay) {
  double last = lightness(kBackground) + 0.15;  // even the dark end shows
  for (int i = 0; i <= 100; ++i) {
    const double now = lightness(map_value(i / 100.0));
    EXPECT_GT(now, last - 1e-9) << i;
    last = now;
  }
}

TEST(Colours, EndsAreClampedAndNaNIsGrey) {
  EXPECT_EQ(map_value(-3), map_value(0));
  EXPECT_EQ(map_value(7), map_value(1));
  EXPECT_EQ(map_error(7), map_error(1));
  const Colour grey = map_value(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(grey.r, grey.g);
  EXPECT_EQ(grey.g, grey.b);
  EXPECT_GT(lightness(map_error(1)), 3 * lightness(map_error(0)));
}

TEST(Font, EveryPrintableCharacterHasItsOwnShape) {
  std::set<std::array<std::uint8_t, 7>> shapes;
  for (char c = 33; c < 127; ++c) {
    for (const std::uint8_t row : glyph(c)) EXPECT_LT(row, 32);
    EXPECT_TRUE(shapes.insert(glyph(c)).second) << c;
  }
  EXPECT_EQ(glyph('\n'), glyph(static_cast<char>(0xe9)));  // the box
  EXPECT_EQ(glyph(' '), (std::array<std::uint8_t, 7>{}));
}

TEST(Canvas, TextPutsTheGlyphsPixels) {
  Canvas canvas(40, 20);
  canvas.text(3, 4, "T", 2);
  EXPECT_EQ(canvas.at(3, 4), kInk);   // the bar's left end
  EXPECT_EQ(canvas.at(12, 5), kInk);  // its right end
  EXPECT_EQ(canvas.at(7, 17), kInk);  // the stem's foot
  EXPECT_NE(canvas.at(3, 10), kInk);
  EXPECT_EQ(text_width("T", 2), 10);
  EXPECT_EQ(text_width("TT", 1), 11);
  EXPECT_EQ(text_width("", 3), 0);
}

TEST(Canvas, DrawingOutsideIsIgnored) {
  Canvas canvas(8, 8, {});
  canvas.set(-1, 3, kInk);
  canvas.set(3, 8, kInk);
  canvas.blend(100, 100, kInk, 1);
  canvas.fill(-5, -5, 4, 4, kInk);
  canvas.text(-40, -40, "far away", 3);
  canvas.line(-1e6, -50, 1e6, -50, 2, kInk);
  canvas.circle(400, 400, 10, 2, kInk);
  for (const std::uint8_t byte : canvas.image().rgb) ASSERT_EQ(byte, 0);
}

TEST(Canvas, LineAndCircleCoverTheirPixels) {
  Canvas canvas(41, 41, {});
  canvas.circle(20.5, 20.5, 10, 1, {1, 1, 1});
  EXPECT_GT(canvas.at(30, 20).r, 0.9f);
  EXPECT_GT(canvas.at(20, 10).r, 0.4f);
  EXPECT_EQ(canvas.at(20, 20).r, 0);
  canvas.line(0, 20.5, 41, 20.5, 1, {0, 1, 0});
  EXPECT_GT(canvas.at(5, 20).g, 0.9f);
  EXPECT_EQ(canvas.at(5, 23).g, 0);
}

TEST(Canvas, ImageIsRowMajorEightBit) {
  Canvas canvas(3, 2, {});
  canvas.set(1, 1, {1, 0.5f, 0});
  const Image image = canvas.image();
  ASSERT_EQ(image.rgb.size(), 18u);
  EXPECT_EQ(image.rgb[12], 255);
  EXPECT_EQ(image.rgb[13], 128);
  EXPECT_EQ(image.rgb[14], 0);
}

TEST(Splats, NearestDotWinsInAnyOrder) {
  for (const bool near_first : {true, false}) {
    Splats splats(10, 10);
    splats.add(5, 5, 2, near_first ? 1.0f : 2.0f, near_first ? 0 : 1);
    splats.add(5, 5, 2, near_first ? 2.0f : 1.0f, near_first ? 1 : 0);
    Canvas canvas(10, 10, {});
    splats.compose(canvas, 1, [](std::uint32_t point) {
      return point == 0 ? Colour{1, 0, 0} : Colour{0, 1, 0};
    });
    EXPECT_EQ(canvas.at(5, 5), (Colour{1, 0, 0}));
    EXPECT_EQ(canvas.at(0, 0), (Colour{}));
  }
}

TEST(Splats, FlatSurfacesStayBrightAndStepsAreShaded) {
  Splats splats(20, 10);
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 10; ++y) splats.add(x + 0.5, y + 0.5, 1, x < 10 ? 1.0f : 2.0f, 0);
  }
  Canvas canvas(20, 10);
  splats.compose(canvas, 2, [](std::uint32_t) { return Colour{1, 1, 1}; });
  EXPECT_FLOAT_EQ(canvas.at(4, 5).r, 1);   // flat
  EXPECT_FLOAT_EQ(canvas.at(16, 5).r, 1);  // flat, behind
  EXPECT_LT(canvas.at(11, 5).r, 0.9f);     // behind the step
  EXPECT_FLOAT_EQ(canvas.at(8, 5).r, 1);   // before it
}

TEST(Splats, DotsBeyondTheBorderAreCutOrDropped) {
  Splats splats(10, 10);
  splats.add(1e300, 5, 2, 1, 0);
  splats.add(-1e300, -1e300, 2, 1, 0);
  splats.add(std::numeric_limits<double>::quiet_NaN(), 5, 2, 1, 0);
  Canvas empty(10, 10, {});
  splats.compose(empty, 1, [](std::uint32_t) { return Colour{1, 1, 1}; });
  for (const std::uint8_t byte : empty.image().rgb) ASSERT_EQ(byte, 0);
  splats.add(-0.5, 5, 2, 1, 0);
  splats.compose(empty, 1, [](std::uint32_t) { return Colour{1, 1, 1}; });
  EXPECT_GT(empty.at(0, 5).r, 0.5f);
}

TEST(ScaleBar, RunsFromTheLowToTheHighColour) {
  Scale scale;
  scale.low = -1.5;
  scale.high = 4;
  scale.label = "height [m]";
  Canvas canvas(640, 100);
  draw_scale(canvas, scale);
  int low_x = -1, high_x = -1;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 640; ++x) {
      if (canvas.at(x, y) == scale.colour(0)) low_x = x;
      if (canvas.at(x, y) == scale.colour(1)) high_x = x;
    }
  }
  EXPECT_GT(low_x, 0);
  EXPECT_GT(high_x, low_x + 100);
  EXPECT_EQ(scale.colour(0), map_value(0));
}

}  // namespace
}  // namespace curlidar::drawing
