// SPDX-License-Identifier: BSD-3-Clause
// As many points on every square metre as wished, counted by brute force in discs on planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/scene_field.hpp"

namespace curlidar {
namespace {

using test::BoxScene;

struct Counts {
  std::size_t discs = 0;
  double least = 1e300, most = 0;  ///< counted / wished
};

/// Counts the points in discs on the box's floor, left wall and wall ahead that lie inside of what
/// the sensor sees, `off_edges` away from the edges. Points may lie somewhat beside the plane.
/// Lengths are those of the box, `density` is of its square metres, the cloud is `scale` times it.
Counts count_in_discs(const Cloud& cloud, double density, double off_edges, double scale = 1) {
  constexpr double kWished = 50;  // points in a disc
  constexpr double kBeside_m = 0.3;
  const double radius = std::sqrt(kWished / (density * 3.14159265));
  const double edge = std::max(radius, off_edges);
  Counts counts;
  const auto count = [&](const Vec3& centre, const Vec3& normal) {
    // The disc must lie within the rings' band of elevations.
    const double above = elevation_of(centre) + radius / norm(centre);
    const double below = elevation_of(centre) - radius / norm(centre);
    if (above > 9 * test::kDegree || below < -19 * test::kDegree) return;
    double found = 0;
    for (const Vec3& p : cloud.positions) {
      const Vec3 from = p * (1 / scale) - centre;
      const double beside = dot(from, normal);
      if (std::abs(beside) < kBeside_m && norm(from - normal * beside) <= radius) ++found;
    }
    ++counts.discs;
    counts.least = std::min(counts.least, found / kWished);
    counts.most = std::max(counts.most, found / kWished);
  };
  for (double a = -0.95; a < 0.96; a += 0.19) {
    for (double b = -0.9; b < 0.95; b += 0.15) {
      const double x = a * BoxScene::kHalfX, y = b * BoxScene::kHalfY, z = b * 1.2;
      const bool off_x = std::abs(x) + edge < BoxScene::kHalfX;
      const bool off_y = std::abs(y) + edge < BoxScene::kHalfY;
      const bool off_z = z - edge > BoxScene::kFloor && z + edge < BoxScene::kCeiling;
      if (off_x && off_y) count({x, y, BoxScene::kFloor}, {0, 0, 1});
      if (off_x && off_z) count({x, BoxScene::kHalfY, z}, {0, 1, 0});
      if (off_y && off_z) count({BoxScene::kHalfX, y, z}, {1, 0, 0});
    }
  }
  return counts;
}

TEST(ReconstructDensity, IsKeptEverywhereOnPlanesOfAnExactField) {
  // The wish on a square metre of the scene, the scale of the scene.
  for (const auto& [density, scale] :
       {std::pair{1.0, 8.0}, {20.0, 1.0}, {100.0, 1.0}, {1000.0, 1.0}, {4000.0, 0.8}}) {
    const DecodedScan scan =
        test::exact_scan(std::make_shared<BoxScene>(false, scale), test::small_sensor());
    const Cloud cloud = reconstruct_density(scan, density).value();
    const Counts counts = count_in_discs(cloud, density * scale * scale, 0, scale);
    EXPECT_GT(counts.discs, density == 20 ? 5u : 50u);
    EXPECT_GT(counts.least, 0.7) << density;
    EXPECT_LT(counts.most, 1.35) << density;
  }
}

TEST(ReconstructDensity, TenThousandOnASquareMetreOfAPart) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(), test::small_sensor());
  ReconstructSettings ahead;
  ahead.region = ScanRegion{.azimuth_begin = -0.15, .azimuth_end = 0.15};
  const Cloud cloud = reconstruct_density(scan, 10'000, ahead).value();
  for (double y = -1; y < 1.05; y += 0.1) {
    for (double z = -1.2; z < 1.25; z += 0.1) {
      const Vec3 centre{BoxScene::kHalfX, y, z};
      const auto found = std::count_if(cloud.positions.begin(), cloud.positions.end(),
                                       [&](const Vec3& p) { return norm(p - centre) <= 0.05; });
      ASSERT_GT(found, 50) << y << " " << z;  // 79 are wished
      ASSERT_LT(found, 110) << y << " " << z;
    }
  }
}

TEST(ReconstructDensity, PointsOfAnExactFieldAreOnItsSurfaces) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(true), test::small_sensor());
  const BoxScene scene(true);
  const Cloud cloud = reconstruct_density(scan, 50).value();
  EXPECT_GT(cloud.size(), 2000u);
  for (const Vec3& p : cloud.positions) {
    Hit hit;
    scene.cast({}, p * (1 / norm(p)), hit);
    ASSERT_NEAR(norm(p), hit.range_m, 1e-9);
  }
}

TEST(ReconstructDensity, OfACompactFileWithNoise) {
  const SensorProfile sensor = test::small_sensor(40, 720);
  const DecodedScan scan = test::compact_scan(BoxScene(), sensor, 0.02);
  for (const double density : {100.0, 1000.0}) {  // the scan itself: some 100 to 1500
    const Cloud cloud = reconstruct_density(scan, density).value();
    const Counts counts = count_in_discs(cloud, density, 0.6);
    EXPECT_GT(counts.least, 0.6) << density;
    EXPECT_LT(counts.most, 1.6) << density;
  }
}

TEST(ReconstructDensity, OfASparseWishIsRightInAll) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(), test::small_sensor());
  const auto points = [&](double density) {
    return static_cast<double>(reconstruct_density(scan, density)->size());
  };
  const double many = points(1000);
  for (const double density : {0.1, 1.0, 10.0, 100.0}) {
    EXPECT_NEAR(points(density) / density, many / 1000, 0.1 * many / 1000 + 2 / density) << density;
  }
}

TEST(ReconstructDensity, OriginalsStayExactlyAndAreNotDoubled) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(), test::small_sensor());
  ReconstructSettings settings;
  settings.keep_originals = settings.original = true;
  const double density = 200, radius = 0.5 / std::sqrt(density);
  const Cloud cloud = reconstruct_density(scan, density, settings).value();
  ASSERT_GT(cloud.size(), scan.points.size() + 1000);
  const Attribute& original = *cloud.find("original");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(original.as_double(i), i < scan.points.size() ? 1 : 0);
    if (i < scan.points.size()) {
      ASSERT_EQ(cloud.positions[i], scan.points[i]);
    } else if (i % 16 == 0) {
      for (const Vec3& p : scan.points) ASSERT_GT(norm(p - cloud.positions[i]), radius);
    }
  }
}

TEST(ReconstructDensity, RefusesWhatIsNoneOrTooMuch) {
  const DecodedScan scan = test::exact_scan(std::make_shared<BoxScene>(), test::small_sensor());
  for (const double bad : {0.0, -1.0, std::nan(""), 1e12}) {
    EXPECT_EQ(reconstruct_density(scan, bad).error().code, ErrorCode::invalid_argument);
  }
  EXPECT_EQ(reconstruct_density(scan, 1e8, {.max_points = 100'000}).error().code,
            ErrorCode::limit_exceeded);
  EXPECT_EQ(reconstruct_density(scan, 100, {.max_points = 1000}).error().code,
            ErrorCode::limit_exceeded);
}

TEST(ReconstructDensity, IsTheSameForAnyNumberOfThreads) {
  const DecodedScan scan = test::compact_scan(BoxScene(true), test::small_sensor());
  const Cloud one = reconstruct_density(scan, 100, {.normals = true, .threads = 1}).value();
  const Cloud four = reconstruct_density(scan, 100, {.normals = true, .threads = 4}).value();
  EXPECT_EQ(one.positions, four.positions);
  ASSERT_EQ(one.attributes.size(), four.attributes.size());
}

}  // namespace
}  // namespace curlidar
