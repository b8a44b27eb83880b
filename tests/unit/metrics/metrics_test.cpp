// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/metrics.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "support/metric_clouds.hpp"

namespace curlidar {
namespace {

using test::brute_force;
using test::cloud_of;
using test::holey_cloud;
using test::kInf;
using test::kNan;
using test::nearest_slots;
using test::random_cloud;

double mean_of(const std::vector<double>& distances, double power) {
  double sum = 0;
  double count = 0;
  for (const double d : distances) {
    if (std::isnan(d)) continue;
    sum += std::pow(d, power);
    ++count;
  }
  return sum / count;
}

double share(const std::vector<double>& distances, double threshold) {
  double within = 0;
  double count = 0;
  for (const double d : distances) {
    if (std::isnan(d)) continue;
    if (d <= threshold) ++within;
    ++count;
  }
  return within / count;
}

/// Every pair of clouds that the brute force is tried on.
std::vector<std::pair<Cloud, Cloud>> pairs() {
  const Cloud one = cloud_of({{3, 4, 0}});
  const Cloud same = cloud_of(std::vector<Vec3>(50, Vec3{3, 4, 1}));
  return {{random_cloud(400, 1, 0.05), random_cloud(300, 2, 0.05)},
          {holey_cloud(500, 3, 0.02), holey_cloud(200, 4, 0.02)},
          {one, holey_cloud(100, 5, 0.1)},
          {holey_cloud(100, 6, 0.1), one},
          {one, one},
          {same, one},
          {same, random_cloud(60, 7, 0.1)}};
}

TEST(Measure, AgreesWithBruteForce) {
  MetricsSettings settings;
  settings.thresholds = {0, 0.03, 0.1, 1, 10};
  settings.peak = 7;
  for (const auto& [a, b] : pairs()) {
    const std::vector<double> forth = brute_force(a, b);
    const std::vector<double> back = brute_force(b, a);
    const auto metrics = measure(a, b, settings);
    ASSERT_TRUE(metrics);
    EXPECT_EQ(metrics->directed.points_a, count_returns(a));
    EXPECT_EQ(metrics->directed.points_b, count_returns(b));
    EXPECT_NEAR(metrics->directed.a_to_b.mean, mean_of(forth, 1), 1e-12);
    EXPECT_NEAR(metrics->directed.b_to_a.rms, std::sqrt(mean_of(back, 2)), 1e-12);
    EXPECT_NEAR(metrics->symmetric_mean, std::max(mean_of(forth, 1), mean_of(back, 1)), 1e-12);
    EXPECT_NEAR(metrics->symmetric_rms, std::sqrt(std::max(mean_of(forth, 2), mean_of(back, 2))),
                1e-12);
    EXPECT_NEAR(metrics->chamfer, (mean_of(forth, 1) + mean_of(back, 1)) / 2, 1e-12);
    EXPECT_NEAR(metrics->chamfer_squared, mean_of(forth, 2) + mean_of(back, 2), 1e-11);
    EXPECT_NEAR(metrics->point_to_point.a_to_b_mse, mean_of(forth, 2), 1e-11);
    EXPECT_NEAR(metrics->point_to_point.b_to_a_mse, mean_of(back, 2), 1e-11);
    const double mse = std::max(mean_of(forth, 2), mean_of(back, 2));
    EXPECT_NEAR(metrics->point_to_point.mse, mse, 1e-11);
    EXPECT_NEAR(metrics->point_to_point.rms, std::sqrt(mse), 1e-12);
    if (mse > 0) {
      EXPECT_NEAR(metrics->point_to_point.psnr, 10 * std::log10(3 * 49 / mse), 1e-9);
    }
    EXPECT_FALSE(metrics->point_to_plane);
    EXPECT_TRUE(metrics->quantiles_a_to_b.empty());
    ASSERT_EQ(metrics->matches.size(), settings.thresholds.size());
    for (std::size_t t = 0; t < settings.thresholds.size(); ++t) {
      const Match& match = metrics->matches[t];
      const double precision = share(back, settings.thresholds[t]);
      const double recall = share(forth, settings.thresholds[t]);
      EXPECT_EQ(match.threshold, settings.thresholds[t]);
      EXPECT_DOUBLE_EQ(match.precision, precision);
      EXPECT_DOUBLE_EQ(match.recall, recall);
      if (precision + recall == 0) {
        EXPECT_EQ(match.f_score, 0);
      } else {
        EXPECT_DOUBLE_EQ(match.f_score, 2 * precision * recall / (precision + recall));
      }
    }
  }
}

TEST(Measure, ByHand) {
  // a misses nothing but its far point; b invents nothing.
  const Cloud a = cloud_of({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {10, 0, 0}});
  const Cloud b = cloud_of({{1, 0.03, 0}, {2, 0, 0}, {3, 0, 0.3}});
  MetricsSettings settings;
  settings.thresholds = {0.02, 0.05, 0.5};
  settings.quantiles = 3;
  const auto metrics = measure(a, b, settings);
  ASSERT_TRUE(metrics);
  const double far = std::sqrt(49.09);
  EXPECT_DOUBLE_EQ(metrics->symmetric_mean, (0.33 + far) / 4);
  EXPECT_DOUBLE_EQ(metrics->chamfer, ((0.33 + far) / 4 + 0.11) / 2);
  EXPECT_DOUBLE_EQ(metrics->point_to_point.mse, (0.0009 + 0.09 + 49.09) / 4);
  EXPECT_DOUBLE_EQ(metrics->point_to_point.b_to_a_mse, 0.0909 / 3);
  EXPECT_DOUBLE_EQ(metrics->matches[0].precision, 1.0 / 3);
  EXPECT_DOUBLE_EQ(metrics->matches[0].recall, 0.25);
  EXPECT_DOUBLE_EQ(metrics->matches[0].f_score, 2.0 / 7);
  EXPECT_DOUBLE_EQ(metrics->matches[1].precision, 2.0 / 3);
  EXPECT_DOUBLE_EQ(metrics->matches[1].recall, 0.5);
  EXPECT_DOUBLE_EQ(metrics->matches[2].precision, 1);
  EXPECT_DOUBLE_EQ(metrics->matches[2].recall, 0.75);
  ASSERT_EQ(metrics->quantiles_b_to_a.size(), 3u);
  EXPECT_DOUBLE_EQ(metrics->quantiles_b_to_a[0], 0);
  EXPECT_DOUBLE_EQ(metrics->quantiles_b_to_a[1], 0.03);
  EXPECT_DOUBLE_EQ(metrics->quantiles_b_to_a[2], 0.3);
  EXPECT_DOUBLE_EQ(metrics->quantiles_a_to_b[1], (0.03 + 0.3) / 2);
}

/// pc_error's way, point by point: `normals` are a's.
std::pair<double, double> plane_errors_of(const Cloud& a, const Cloud& b,
                                          const std::vector<Vec3>& normals) {
  const std::vector<std::size_t> forth = nearest_slots(a, b);
  const std::vector<std::size_t> back = nearest_slots(b, a);
  const auto error = [](const Vec3& d, const Vec3& n) {
    return std::isnan(n.x) ? dot(d, d) : dot(d, n) * dot(d, n);
  };
  double sum_a = 0;
  double sum_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_return(a.positions[i])) continue;
    // The normal of the neighbour: the mean over all that are nearest to it, i among them.
    Vec3 sum;
    double count = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (forth[k] != forth[i] || std::isnan(normals[k].x)) continue;
      sum = sum + normals[k];
      ++count;
    }
    const Vec3 normal = count > 0 ? sum * (1 / count) : normals[back[forth[i]]];
    sum_a += error(a.positions[i] - b.positions[forth[i]], normal);
  }
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (!is_return(b.positions[i])) continue;
    sum_b += error(b.positions[i] - a.positions[back[i]], normals[back[i]]);
  }
  return {sum_a / static_cast<double>(count_returns(a)),
          sum_b / static_cast<double>(count_returns(b))};
}

TEST(Measure, PointToPlaneAgreesWithBruteForce) {
  MetricsSettings settings;
  settings.planes = true;
  for (auto& [a, b] : pairs()) {
    const std::vector<Vec3> normals = surface_normals(a);
    const auto [forth, back] = plane_errors_of(a, b, normals);
    const auto metrics = measure(a, b, settings);
    ASSERT_TRUE(metrics && metrics->point_to_plane);
    EXPECT_FALSE(metrics->normals_given);
    EXPECT_NEAR(metrics->point_to_plane->a_to_b_mse, forth, 1e-11);
    EXPECT_NEAR(metrics->point_to_plane->b_to_a_mse, back, 1e-11);
    EXPECT_EQ(metrics->point_to_plane->mse,
              std::max(metrics->point_to_plane->a_to_b_mse, metrics->point_to_plane->b_to_a_mse));
    EXPECT_LE(metrics->point_to_plane->a_to_b_mse, metrics->point_to_point.a_to_b_mse + 1e-12);
    EXPECT_LE(metrics->point_to_plane->b_to_a_mse, metrics->point_to_point.b_to_a_mse + 1e-12);
  }
}

void give_normals(Cloud& cloud, const std::vector<Vec3>& normals) {
  std::array<std::vector<float>, 3> columns;
  for (const Vec3& n : normals) {
    columns[0].push_back(static_cast<float>(n.x));
    columns[1].push_back(static_cast<float>(n.y));
    columns[2].push_back(static_cast<float>(n.z));
  }
  cloud.attributes.push_back({"normal_x", 1, columns[0]});
  cloud.attributes.push_back({"normal_y", 1, columns[1]});
  cloud.attributes.push_back({"normal_z", 1, columns[2]});
}

TEST(Measure, PointToPlaneByHandWithNormalsOfTheCloud) {
  Cloud a = cloud_of({{1, 0, 0}, {5, 0, 0}, {9, 0, 0}});
  // Not of unit length, and one without a direction.
  give_normals(a, {{0, 0, 2}, {3, 0, 0}, {0, 0, 0}});
  const Cloud b = cloud_of({{1, 0.3, 0.4}, {5, 0.5, 0}, {9, 0.6, 0.8}});
  MetricsSettings settings;
  settings.planes = true;
  settings.peak = 1;
  const auto metrics = measure(a, b, settings);
  ASSERT_TRUE(metrics && metrics->point_to_plane);
  EXPECT_TRUE(metrics->normals_given);
  EXPECT_NEAR(metrics->point_to_plane->a_to_b_mse, (0.16 + 0 + 1) / 3, 1e-12);
  EXPECT_NEAR(metrics->point_to_plane->b_to_a_mse, (0.16 + 0 + 1) / 3, 1e-12);
  EXPECT_NEAR(metrics->point_to_plane->psnr, 10 * std::log10(3 * 3 / 1.16), 1e-9);
}

TEST(Measure, NormalsCarriedOverAreAveraged) {
  // Both returns of a are nearest to the one of b: its normal is their mean, not of unit length.
  Cloud a = cloud_of({{1, 1, 0}, {3, 1, 0}});
  give_normals(a, {{1, 0, 0}, {0, 1, 0}});
  const Cloud b = cloud_of({{2, 1.5, 0}});
  MetricsSettings settings;
  settings.planes = true;
  const auto metrics = measure(a, b, settings);
  ASSERT_TRUE(metrics && metrics->point_to_plane);
  // Projections on (1/2, 1/2, 0): (-1 - 1/2) / 2 and (1 - 1/2) / 2.
  EXPECT_DOUBLE_EQ(metrics->point_to_plane->a_to_b_mse, (0.5625 + 0.0625) / 2);
  // The first of the two equally near normals, (1, 0, 0): 2 - 1.
  EXPECT_DOUBLE_EQ(metrics->point_to_plane->b_to_a_mse, 1);
}

TEST(Measure, SlidingOnAPlaneIsNoErrorToIt) {
  std::vector<Vec3> grid;
  std::vector<Vec3> moved;
  for (int i = 0; i < 400; ++i) {
    grid.push_back({5 + 0.1 * (i % 20), 0.1 * (i / 20), -2});
    moved.push_back(grid.back() + Vec3{0.02, 0.03, 0});
  }
  MetricsSettings settings;
  settings.planes = true;
  const auto metrics = measure(cloud_of(grid), cloud_of(moved), settings);
  ASSERT_TRUE(metrics && metrics->point_to_plane);
  EXPECT_LT(metrics->point_to_plane->rms, 1e-12);
  EXPECT_NEAR(metrics->point_to_point.rms, std::hypot(0.02, 0.03), 1e-12);
}

TEST(Measure, SameForAnyThreadCount) {
  const Cloud a = holey_cloud(9000, 8, 0.37);
  const Cloud b = holey_cloud(7000, 9, 0.37);
  MetricsSettings settings;
  settings.planes = true;
  settings.quantiles = 11;
  const auto one = measure(a, b, settings, 1);
  for (const std::size_t threads : {3u, 0u}) {
    const auto more = measure(a, b, settings, threads);
    ASSERT_TRUE(one && more && one->point_to_plane && more->point_to_plane);
    EXPECT_EQ(one->chamfer_squared, more->chamfer_squared);
    EXPECT_EQ(one->point_to_plane->a_to_b_mse, more->point_to_plane->a_to_b_mse);
    EXPECT_EQ(one->point_to_plane->b_to_a_mse, more->point_to_plane->b_to_a_mse);
    EXPECT_EQ(one->quantiles_a_to_b, more->quantiles_a_to_b);
  }
}

TEST(Measure, SettingsThatMakeNoSense) {
  const Cloud some = cloud_of({{1, 0, 0}});
  std::vector<MetricsSettings> wrong(8);
  wrong[0].thresholds = {0.1, -0.1};
  wrong[1].thresholds = {kNan};
  wrong[2].peak = 0;
  wrong[3].peak = kInf;
  wrong[4].voxel = 0;
  wrong[5].voxel = kNan;
  wrong[6].quantiles = 1;
  wrong[7].normal_neighbours = 2;
  for (const MetricsSettings& settings : wrong) {
    const auto metrics = measure(some, some, settings);
    ASSERT_FALSE(metrics);
    EXPECT_EQ(metrics.error().code, ErrorCode::invalid_argument);
  }
  EXPECT_TRUE(measure(some, some));
  EXPECT_FALSE(measure(some, cloud_of({{0, 0, 0}})));
  EXPECT_FALSE(measure(cloud_of({{kNan, 0, 0}}), some));
}

TEST(Psnr, ByHand) {
  EXPECT_NEAR(psnr(0.0003, 1), 40, 1e-12);
  EXPECT_NEAR(psnr(0.01, 59.70), 10 * std::log10(3 * 3564.09 / 0.01), 1e-12);
  EXPECT_EQ(psnr(0, 59.70), kInf);
}

TEST(ShareWithin, ByHand) {
  EXPECT_DOUBLE_EQ(share_within({1, 2, kNan, 3, 4}, 2), 0.5);
  EXPECT_EQ(share_within({1, 2}, 0.5), 0);
  EXPECT_EQ(share_within({kNan}, 1), 0);
}

TEST(Quantiles, AgreeWithPercentile) {
  std::vector<double> values = brute_force(random_cloud(173, 1, 0.3), random_cloud(90, 2, 0.3));
  const std::vector<double> found = quantiles(values, 101);
  ASSERT_EQ(found.size(), 101u);
  for (std::size_t i = 0; i <= 100; ++i) {
    EXPECT_NEAR(found[i], percentile(values, static_cast<double>(i) / 100), 1e-12);
  }
}

TEST(Quantiles, FewValues) {
  EXPECT_EQ(quantiles({kNan, 3}, 3), (std::vector<double>{3, 3, 3}));
  EXPECT_EQ(quantiles({5, 1}, 3), (std::vector<double>{1, 3, 5}));
  EXPECT_TRUE(quantiles({kNan}, 3).empty());
  EXPECT_TRUE(quantiles({1, 2}, 0).empty());
}

TEST(VoxelOverlap, AgreesWithSets) {
  for (const auto& [a, b] : pairs()) {
    for (const double voxel : {0.1, 1.0, 100.0}) {
      Vec3 origin{kInf, kInf, kInf};
      for (const Cloud* cloud : {&a, &b}) {
        for (const Vec3& p : cloud->positions) {
          if (!is_return(p)) continue;
          origin = {std::min(origin.x, p.x), std::min(origin.y, p.y), std::min(origin.z, p.z)};
        }
      }
      const auto cubes = [&](const Cloud& cloud) {
        std::set<std::tuple<long, long, long>> set;
        for (const Vec3& p : cloud.positions) {
          if (!is_return(p)) continue;
          const auto index = [&](double d) { return static_cast<long>(d / voxel); };
          set.emplace(index(p.x - origin.x), index(p.y - origin.y), index(p.z - origin.z));
        }
        return set;
      };
      const auto of_a = cubes(a);
      const auto of_b = cubes(b);
      std::size_t both = 0;
      for (const auto& cube : of_a) both += of_b.count(cube);
      const auto overlap = voxel_overlap(a, b, voxel);
      ASSERT_TRUE(overlap);
      EXPECT_EQ(overlap->occupied_a, of_a.size());
      EXPECT_EQ(overlap->occupied_b, of_b.size());
      EXPECT_EQ(overlap->occupied_both, both);
      const auto shared = static_cast<double>(both);
      const auto size_a = static_cast<double>(of_a.size());
      const auto size_b = static_cast<double>(of_b.size());
      EXPECT_DOUBLE_EQ(overlap->iou, shared / (size_a + size_b - shared));
      EXPECT_NEAR(overlap->f1, 2 * shared / (size_a + size_b), 1e-15);
      EXPECT_DOUBLE_EQ(overlap->precision, shared / size_b);
      EXPECT_DOUBLE_EQ(overlap->recall, shared / size_a);
    }
  }
}

TEST(VoxelOverlap, HugeCoordinatesAndTinyVoxels) {
  const Cloud far = cloud_of({{1e300, 0, 0}, {-1e300, 0, 0}});
  const auto overlap = voxel_overlap(far, far, 1e-300);
  ASSERT_TRUE(overlap);
  EXPECT_EQ(overlap->iou, 1);
}

}  // namespace
}  // namespace curlidar
