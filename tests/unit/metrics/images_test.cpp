// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "curlidar/metrics.hpp"
#include "support/metric_clouds.hpp"

namespace curlidar {
namespace {

using test::cloud_of;
using test::holey_cloud;
using test::kInf;
using test::kNan;

Cloud image_of(std::vector<Vec3> positions, std::uint32_t height) {
  Cloud cloud = cloud_of(std::move(positions));
  cloud.width = static_cast<std::uint32_t>(cloud.size()) / height;
  cloud.height = height;
  return cloud;
}

TEST(CompareImages, ByHand) {
  // Valid in both (off by 1 and by 3), missed, invented, empty in both, valid in both.
  const Cloud a =
      image_of({{3, 4, 0}, {0, 0, 10}, {0, 2, 0}, {0, 0, 0}, {kNan, 1, 1}, {8, 0, 0}}, 2);
  const Cloud b = image_of({{6, 0, 0}, {0, 7, 0}, {0, 0, 0}, {0, 0, 4}, {0, 0, 0}, {0, 0, 8}}, 2);
  const auto metrics = compare_images(a, b);
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->pixels, 6u);
  EXPECT_EQ(metrics->valid_a, 4u);
  EXPECT_EQ(metrics->valid_b, 4u);
  EXPECT_EQ(metrics->valid_both, 3u);
  EXPECT_EQ(metrics->missed, 1u);
  EXPECT_EQ(metrics->invented, 1u);
  EXPECT_DOUBLE_EQ(metrics->mask_iou, 0.6);
  EXPECT_DOUBLE_EQ(metrics->mae_all, (1 + 3 + 2 + 4 + 0 + 0) / 6.0);
  EXPECT_DOUBLE_EQ(metrics->mae_both, 4.0 / 3);
  EXPECT_DOUBLE_EQ(metrics->rmse_both, std::sqrt(10.0 / 3));
}

TEST(CompareImages, RangesOutsideTheLimitsAreEmpty) {
  const Cloud a = image_of({{1, 0, 0}, {5, 0, 0}, {9, 0, 0}, {8, 0, 0}}, 2);
  const Cloud b = image_of({{5, 0, 0}, {5, 0, 0}, {7, 0, 0}, {2, 0, 0}}, 2);
  ImageSettings settings;
  settings.min_range = 2;
  settings.max_range = 8;
  const auto metrics = compare_images(a, b, settings);
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->valid_a, 2u);
  EXPECT_EQ(metrics->valid_b, 4u);
  EXPECT_DOUBLE_EQ(metrics->mae_all, (5 + 0 + 7 + 6) / 4.0);
  EXPECT_DOUBLE_EQ(metrics->mae_both, 3);
}

TEST(CompareImages, AgreesWithTheDefinition) {
  Cloud a = holey_cloud(640, 31, 0.3);
  Cloud b = holey_cloud(640, 32, 0.3);
  for (std::size_t i = 0; i < b.size(); i += 9) b.positions[i] = {0, 0, 0};
  a.height = b.height = 16;
  a.width = b.width = 40;
  double sum = 0;
  double both = 0;
  double either = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double range_a = is_return(a.positions[i]) ? norm(a.positions[i]) : 0;
    const double range_b = is_return(b.positions[i]) ? norm(b.positions[i]) : 0;
    sum += std::abs(range_a - range_b);
    both += range_a > 0 && range_b > 0 ? 1 : 0;
    either += range_a > 0 || range_b > 0 ? 1 : 0;
  }
  const auto metrics = compare_images(a, b);
  ASSERT_TRUE(metrics);
  EXPECT_NEAR(metrics->mae_all, sum / 640, 1e-12);
  EXPECT_DOUBLE_EQ(metrics->mask_iou, both / either);
}

/// The Chamfer distance of all pixels, the origin standing for the empty ones.
double chamfer_of(const Cloud& a, const Cloud& b) {
  const auto point = [](const Vec3& p) { return is_return(p) ? p : Vec3{}; };
  double sum = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    for (const Vec3& p : from->positions) {
      double best = kInf;
      for (const Vec3& q : to->positions) {
        const Vec3 d = point(p) - point(q);
        best = std::min(best, dot(d, d));
      }
      sum += best;
    }
  }
  return sum / static_cast<double>(a.size());
}

TEST(CompareImages, ChamferOfAllPixelsAgreesWithBruteForce) {
  const Cloud far = image_of(std::vector<Vec3>(4, Vec3{3, 4, 0}), 2);
  const Cloud none = image_of(std::vector<Vec3>(4, Vec3{}), 2);
  EXPECT_DOUBLE_EQ(compare_images(far, none)->chamfer_squared_all, 50);
  EXPECT_EQ(compare_images(none, none)->chamfer_squared_all, 0);
  Cloud a = holey_cloud(640, 33, 0.3);
  Cloud b = holey_cloud(640, 34, 0.1);
  Cloud full = test::random_cloud(640, 35, 0.3);
  for (Vec3& p : full.positions) p.z += 5;
  a.height = b.height = full.height = 16;
  a.width = b.width = full.width = 40;
  for (const auto& [first, second] :
       {std::pair{&a, &b}, std::pair{&full, &b}, std::pair{&a, &full}, std::pair{&full, &full}}) {
    const auto metrics = compare_images(*first, *second);
    const auto threaded = compare_images(*first, *second, {}, 3);
    ASSERT_TRUE(metrics && threaded);
    EXPECT_NEAR(metrics->chamfer_squared_all, chamfer_of(*first, *second), 1e-9);
    EXPECT_EQ(metrics->chamfer_squared_all, threaded->chamfer_squared_all);
  }
}

TEST(CompareImages, MeansOverNoPixelAreNotNumbers) {
  const Cloud none = image_of({{0, 0, 0}, {0, 0, 0}}, 2);
  const auto empty = compare_images(none, none);
  ASSERT_TRUE(empty);
  EXPECT_EQ(empty->mae_all, 0);
  EXPECT_TRUE(std::isnan(empty->mask_iou));
  EXPECT_TRUE(std::isnan(empty->mae_both));
  EXPECT_TRUE(std::isnan(empty->rmse_both));
  const auto missed = compare_images(image_of({{3, 0, 0}, {0, 0, 0}}, 2), none);
  ASSERT_TRUE(missed);
  EXPECT_EQ(missed->mask_iou, 0);
  EXPECT_DOUBLE_EQ(missed->mae_all, 1.5);
}

TEST(CompareImages, Refusals) {
  const Cloud image = image_of(std::vector<Vec3>(12, Vec3{1, 0, 0}), 3);
  EXPECT_TRUE(compare_images(image, image));
  EXPECT_FALSE(compare_images(image, image_of(image.positions, 4)));
  EXPECT_FALSE(compare_images(image, cloud_of(image.positions)));
  EXPECT_FALSE(compare_images(cloud_of(image.positions), cloud_of(image.positions)));
  for (const ImageSettings& wrong : {ImageSettings{-1, 5}, ImageSettings{5, 5},
                                     ImageSettings{kNan, 5}, ImageSettings{kInf, kInf}}) {
    EXPECT_FALSE(compare_images(image, image, wrong));
  }
}

}  // namespace
}  // namespace curlidar
