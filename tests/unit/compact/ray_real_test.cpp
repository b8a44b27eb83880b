// SPDX-License-Identifier: BSD-3-Clause
// Frozen beam tables against real scans: every return is a ray, a firing and a whole range.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>

#include "compact/ray_tables.hpp"
#include "compact/scan_points.hpp"
#include "curlidar/io.hpp"
#include "support/data.hpp"
#include "support/ray_tables.hpp"

namespace curlidar::compact {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double radians(std::int32_t angle) {
  return angle / 4294967296.0 * kTurn;
}

/// A return as the sensor counted it.
struct Count {
  std::uint32_t row = 0, position = 0;
  std::int32_t range = 0;
};

Count count_of(const Vec3& p, const BeamTable& table, std::uint32_t row) {
  const Ray& ray = table.rays[row];
  const double lateral = ray.lateral / 65536.0, rho = std::hypot(p.x, p.y);
  const double azimuth = std::atan2(p.y, p.x) - std::asin(lateral / rho);
  const double turns = (azimuth - radians(ray.azimuth_offset)) / kTurn + .5;
  const auto slot = std::llround((turns - std::floor(turns)) * table.slots);
  const double e = radians(table.elevation[row]);
  const double level = std::sqrt(rho * rho - lateral * lateral);
  const double t = level * std::cos(e) + (p.z - ray.height / 65536.0) * std::sin(e);
  const double unit = static_cast<double>(table.range_unit_q48) * 0x1p-48;
  const double range = std::round((t - ray.range_phase / 65536.0) / unit) * unit;
  return {row, static_cast<std::uint32_t>(slot) % table.slots,
          static_cast<std::int32_t>(std::llround(range * 65536))};
}

/// What rays and counts make of each point.
std::vector<Vec3> counted(const std::vector<Vec3>& points, const BeamTable& table,
                          const std::vector<std::uint32_t>& rows) {
  std::vector<Count> counts;
  std::set<std::uint32_t> positions;
  for (std::size_t i = 0; i < points.size(); ++i) {
    counts.push_back(count_of(points[i], table, rows[i]));
    positions.insert(counts.back().position);
  }
  const RowTable rays = test::frozen_rays(table.number, {positions.begin(), positions.end()});
  const std::vector<std::uint32_t>& firings = rays.rays->firings;
  const auto columns = static_cast<std::int64_t>(firings.size());
  const PointTable coder(rays, test::rows_of(rays), rays.turn_columns);
  std::vector<Vec3> out;
  for (const Count& count : counts) {
    const auto firing =
        std::lower_bound(firings.begin(), firings.end(), count.position) - firings.begin();
    const std::int64_t column = (firing + rays.rays->column_shift(count.row) + columns) % columns;
    out.push_back(coder.metres(count.row, static_cast<std::uint32_t>(column), count.range));
  }
  return out;
}

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

std::vector<Vec3> returns_of(const char* name) {
  std::vector<Vec3> points;
  const auto folder = test::data_directory();
  const auto cloud = folder ? read_cloud((*folder / name).string()) : Result<Cloud>(Cloud{});
  if (!cloud) return points;
  for (const Vec3& p : cloud->positions) {
    if (std::hypot(p.x, p.y, p.z) > .3) points.push_back(p);
  }
  return points;
}

TEST(RayReal, KittisCoordinatesComeBackToTheMillimetre) {
  for (const char* name : {"kitti_object/000000.bin", "kitti_raw/sfnd/data_1/0000000000.pcd"}) {
    const std::vector<Vec3> points = returns_of(name);
    if (points.empty()) GTEST_SKIP() << "no " << name;
    // The files are ring by ring, each beginning at azimuth 0.
    std::vector<std::uint32_t> rows(points.size(), 0);
    const auto turn = [&](std::size_t i) {
      const double turns = std::atan2(points[i].y, points[i].x) / kTurn;
      return turns < 0 ? turns + 1 : turns;
    };
    for (std::size_t i = 1; i < points.size(); ++i) {
      rows[i] = rows[i - 1] + (turn(i) < turn(i - 1) - .5 ? 1 : 0);
    }
    ASSERT_EQ(rows.back(), 63u);
    const std::vector<Vec3> found = counted(points, *beam_table("hdl64e-kitti"), rows);
    double sum = 0, worst = 0;
    std::size_t exact = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double off = distance(found[i], points[i]);
      sum += off;
      worst = std::max(worst, off);
      const auto same = [](double a, double b) {
        return std::abs(std::round(a * 1000) - b * 1000) < .2;
      };
      exact += same(found[i].x, points[i].x) + same(found[i].y, points[i].y) +
               same(found[i].z, points[i].z);
    }
    const auto count = static_cast<double>(points.size());
    EXPECT_LT(sum / count, 485e-6) << name;  // .48 mm is what rounding to a millimetre makes
    EXPECT_LT(worst, 1e-3) << name;
    EXPECT_GT(static_cast<double>(exact) / 3 / count, .99) << name;
  }
}

TEST(RayReal, Hdl32eFloatsComeBackBitForBit) {
  const char* name = "velodyne/ndt_omp_hdl32/251370668.pcd";
  const std::vector<Vec3> points = returns_of(name);
  if (points.empty()) GTEST_SKIP() << "no " << name;
  const BeamTable& table = *beam_table("hdl32e");
  std::vector<std::uint32_t> rows;
  for (const Vec3& p : points) {
    const double elevation = std::atan2(p.z, std::hypot(p.x, p.y));
    const auto nearest = std::min_element(
        table.elevation.begin(), table.elevation.end(), [&](std::int32_t a, std::int32_t b) {
          return std::abs(radians(a) - elevation) < std::abs(radians(b) - elevation);
        });
    rows.push_back(static_cast<std::uint32_t>(nearest - table.elevation.begin()));
  }
  const std::vector<Vec3> found = counted(points, table, rows);
  std::size_t exact = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT(distance(found[i], points[i]), 20e-6);
    const auto same = [](double a, double b) {
      return static_cast<float>(a) == static_cast<float>(b);
    };
    exact += same(found[i].x, points[i].x) + same(found[i].y, points[i].y) +
             same(found[i].z, points[i].z);
  }
  EXPECT_GT(static_cast<double>(exact) / 3, .945 * static_cast<double>(points.size()));
}

}  // namespace
}  // namespace curlidar::compact
