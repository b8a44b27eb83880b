// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "curlidar/metrics.hpp"
#include "support/metric_clouds.hpp"

namespace curlidar {
namespace {

using test::cloud_of;
using test::holey_cloud;
using test::kNan;
using test::returns_by_distance;

/// Sum of squared distances of the points to the plane through their mean.
double off_plane(const Cloud& cloud, const std::vector<std::size_t>& slots, const Vec3& normal) {
  Vec3 mean;
  for (const std::size_t slot : slots) mean = mean + cloud.positions[slot];
  mean = mean * (1 / static_cast<double>(slots.size()));
  double sum = 0;
  for (const std::size_t slot : slots) {
    const double d = dot(cloud.positions[slot] - mean, normal);
    sum += d * d;
  }
  return sum;
}

TEST(SurfaceNormals, NoOtherPlaneIsNearerToTheNeighbours) {
  Cloud cloud = holey_cloud(300, 21, 0.5);
  for (Vec3& p : cloud.positions) p.z = std::round(p.z);
  const std::vector<Vec3> normals = surface_normals(cloud);
  ASSERT_EQ(normals.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(std::isnan(normals[i].x), !is_return(cloud.positions[i])) << "slot " << i;
    if (!is_return(cloud.positions[i])) continue;
    EXPECT_NEAR(norm(normals[i]), 1, 1e-12);
    EXPECT_LE(dot(normals[i], cloud.positions[i]), 0);
    std::vector<std::size_t> near = returns_by_distance(cloud, cloud.positions[i]);
    near.resize(12);
    const double least = off_plane(cloud, near, normals[i]);
    for (int e = -6; e <= 6; ++e) {
      for (int h = 0; h < 24; ++h) {
        ASSERT_LE(least, off_plane(cloud, near, direction_of(e * 0.25, h * 0.25)) + 1e-9);
      }
    }
  }
}

TEST(SurfaceNormals, OfAPlane) {
  const Vec3 across = direction_of(0.4, 2.0);
  const Vec3 along = cross(across, {0, 0, 1});
  const Vec3 up = cross(across, along);
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back(across * 7 + along * (i % 10) + up * (i / 10));
  for (const Vec3& normal : surface_normals(cloud_of(points), 9, 2)) {
    EXPECT_NEAR(norm(normal + across), 0, 1e-9);
  }
}

TEST(SurfaceNormals, NoPlaneNoNormal) {
  std::vector<Vec3> line;
  for (int i = 1; i <= 20; ++i) line.push_back({1.0 * i, 2.0 * i, -0.5 * i});
  const std::vector<Vec3> same(20, Vec3{1, 2, 3});
  for (const Cloud& cloud : {cloud_of(line), cloud_of(same), cloud_of({{1, 0, 0}}),
                             cloud_of({{1, 0, 0}, {0, 1, 0}}), cloud_of({{0, 0, 0}})}) {
    for (const Vec3& normal : surface_normals(cloud)) EXPECT_TRUE(std::isnan(normal.x));
  }
  EXPECT_TRUE(surface_normals(cloud_of({})).empty());
}

TEST(SurfaceNormals, ThoseOfTheCloudComeFirst) {
  Cloud cloud = cloud_of({{1, 0, 0}, {0, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  cloud.attributes.push_back({"normal_x", 1, std::vector<float>{3, 1, 0, 1}});
  cloud.attributes.push_back({"normal_y", 1, std::vector<float>{0, 1, 0, 0}});
  EXPECT_FALSE(has_normals(cloud));
  cloud.attributes.push_back(
      {"normal_z", 1, std::vector<double>{4, 1, 0, std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_TRUE(has_normals(cloud));
  const std::vector<Vec3> normals = surface_normals(cloud);
  EXPECT_NEAR(norm(normals[0] - Vec3{0.6, 0, 0.8}), 0, 1e-15);
  for (const std::size_t slot : {1u, 2u, 3u}) EXPECT_TRUE(std::isnan(normals[slot].x)) << slot;
}

}  // namespace
}  // namespace curlidar
