// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <filesystem>

#include "curlidar/io.hpp"
#include "curlidar/render.hpp"

namespace curlidar {
namespace {

Image picture() {
  Image image{37, 11, {}};
  for (std::uint32_t i = 0; i < 37 * 11 * 3; ++i) {
    image.rgb.push_back(static_cast<std::uint8_t>(i * i / 7 + i));
  }
  return image;
}

class Png : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = (std::filesystem::path(testing::TempDir()) /
             (std::string("curlidar_") + test->name() + ".png"))
                .string();
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::string path_;
};

TEST_F(Png, IsReadBackByLibpng) {
  const Image image = picture();
  ASSERT_TRUE(write_png(path_, image));
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, path_.c_str()), 0);
  EXPECT_EQ(header.width, 37u);
  EXPECT_EQ(header.height, 11u);
  header.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(header));
  ASSERT_NE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr), 0);
  EXPECT_EQ(rgb, image.rgb);
}

TEST_F(Png, SamePictureGivesSameBytes) {
  ASSERT_TRUE(write_png(path_, picture()));
  const auto first = read_file(path_);
  ASSERT_TRUE(write_png(path_, picture()));
  const auto second = read_file(path_);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
}

TEST_F(Png, ImpossiblePicturesAndPathsAreErrors) {
  Image image = picture();
  image.rgb.pop_back();
  EXPECT_FALSE(write_png(path_, image));
  EXPECT_FALSE(write_png(path_, Image{}));
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(write_png(path_ + ".missing/x.png", picture()));
}

}  // namespace
}  // namespace curlidar
