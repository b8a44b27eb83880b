// SPDX-License-Identifier: BSD-3-Clause
#include "paper/raycast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::make_image;
using test::random_image;
using test::small_lattice;

std::vector<std::uint8_t> all_of(const DenseGrid& grid) {
  return std::vector<std::uint8_t>(grid.rows * grid.columns, 1);
}

/// Moeller and Trumbore's test of a ray from the origin, its triangle widened by `margin`
/// (negative: narrowed) in barycentric coordinates.
std::optional<double> moeller_trumbore(const Vec3& direction, const Vec3& a, const Vec3& b,
                                       const Vec3& c, double margin) {
  const Vec3 e1 = b - a, e2 = c - a, p = cross(direction, e2);
  const double determinant = dot(e1, p);
  if (std::abs(determinant) < 1e-9 * norm(e1) * norm(e2)) return {};  // seen edge-on
  const Vec3 to_origin = a * -1.0;
  const double u = dot(to_origin, p) / determinant;
  const Vec3 q = cross(to_origin, e1);
  const double v = dot(direction, q) / determinant;
  if (u < -margin || v < -margin || u + v > 1 + margin) return {};
  const double t = dot(e2, q) / determinant;
  if (t <= 0) return {};
  return t;
}

struct Nearest {
  double strict = std::numeric_limits<double>::infinity();  ///< of triangles hit for certain
  double lenient = std::numeric_limits<double>::infinity();
};

Nearest nearest_hit(const PolarMesh& mesh, const Vec3& direction) {
  Nearest out;
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    const auto hit = [&](double margin) {
      return moeller_trumbore(direction, mesh.vertices[mesh.corner(t, 0)],
                              mesh.vertices[mesh.corner(t, 1)], mesh.vertices[mesh.corner(t, 2)],
                              margin);
    };
    if (const auto range = hit(-1e-7)) out.strict = std::min(out.strict, *range);
    if (const auto range = hit(1e-7)) out.lenient = std::min(out.lenient, *range);
  }
  return out;
}

void expect_as_brute_force(const RangeImage& image, double row_factor, double column_factor) {
  const PolarMesh mesh = make_polar_mesh(image);
  const DenseGrid grid(image.lattice, row_factor, column_factor);
  const RayHits hits = cast_rays(mesh, image.lattice, grid, all_of(grid), 1);
  std::size_t met = 0;
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3 direction = image.lattice.direction(grid.row(i), grid.column(j));
      const Nearest expected = nearest_hit(mesh, direction);
      const double range = hits.range[i * grid.columns + j];
      ASSERT_EQ(range > 0, hits.triangle[i * grid.columns + j] != kNoTwin);
      if (range == 0) {
        ASSERT_FALSE(std::isfinite(expected.strict)) << "lost ray " << i << " " << j;
        continue;
      }
      ++met;
      ASSERT_GE(range, expected.lenient * (1 - 1e-6)) << i << " " << j;
      ASSERT_LE(range, expected.strict * (1 + 1e-6)) << i << " " << j;
    }
  }
  if (mesh.triangles() > 0) {
    EXPECT_GT(met, 0u);
  }
}

TEST(CastRays, AgreeWithBruteForceOnSparseImages) {
  test::Random random(21);
  for (const double occupied : {0.15, 0.5, 0.9}) {
    const RangeImage image = random_image(small_lattice(8, 24), occupied, random);
    expect_as_brute_force(image, 2, 2);
    expect_as_brute_force(image, 4, 1);
    expect_as_brute_force(image, 3, 2);
  }
}

TEST(CastRays, AgreeWithBruteForceOnUnevenRings) {
  test::Random random(22);
  std::vector<double> elevations;
  for (int i = 0; i < 9; ++i) elevations.push_back((12 - i - 0.6 * i * i) * test::kDegree);
  expect_as_brute_force(random_image(Lattice::from_rings(elevations, 20), 0.6, random), 3, 3);
}

TEST(CastRays, AgreeWithBruteForceWhereTheScanIsNotAFullTurn) {
  // Hull edges run along columns: triangles there are slivers that the sensor sees edge-on.
  test::Random random(23);
  for (const std::size_t end : {7u, 11u}) {
    for (const std::size_t begin : {1u, 2u, 5u}) {
      const RangeImage image =
          make_image(small_lattice(12, 24), [&](std::size_t, std::size_t column) {
            const double range = 5 + 15 * test::unit(random);
            return column >= begin && column <= end ? range : 0.0;
          });
      expect_as_brute_force(image, 2, 2);
    }
  }
}

TEST(CastRays, OneColumnGivesNoInventedRanges) {
  test::Random random(24);
  for (std::size_t only = 0; only < 24; ++only) {
    const RangeImage image =
        make_image(small_lattice(12, 24), [&](std::size_t, std::size_t column) {
          const double range = 5 + 15 * test::unit(random);
          return column == only ? range : 0.0;
        });
    const PolarMesh mesh = make_polar_mesh(image);
    const DenseGrid grid(image.lattice, 4, 2);
    const RayHits hits = cast_rays(mesh, image.lattice, grid, all_of(grid), 1);
    for (const double range : hits.range) {
      if (range == 0) continue;
      ASSERT_GE(range, 4.5) << only;
      ASSERT_LE(range, 20.1) << only;
    }
  }
}

TEST(CastRays, LoseNoRayOfAClosedMesh) {
  test::Random random(25);
  const auto smooth = make_image(small_lattice(16, 64), [](std::size_t row, std::size_t column) {
    return 10 + 0.1 * static_cast<double>(row) + std::sin(0.1 * static_cast<double>(column));
  });
  const auto constant =
      make_image(small_lattice(16, 64), [](std::size_t, std::size_t) { return 10.0; });
  for (const RangeImage& image :
       {smooth, constant, random_image(small_lattice(16, 64), 1.0, random)}) {
    const PolarMesh mesh = make_polar_mesh(image);
    for (const auto& [rows, columns] : {std::pair<double, double>{2, 2}, {4, 1}, {1, 4}, {3, 2}}) {
      const DenseGrid grid(image.lattice, rows, columns);
      const RayHits hits = cast_rays(mesh, image.lattice, grid, all_of(grid), 1);
      for (std::size_t cell = 0; cell < hits.range.size(); ++cell) {
        EXPECT_GT(hits.range[cell], 0) << "row " << grid.row(cell / grid.columns) << " column "
                                       << grid.column(cell % grid.columns);
      }
    }
  }
}

TEST(CastRays, RaysOnEdgesMeetTheEdge) {
  // Rays of a 4 x 1 grid lie exactly on the edges along a column, whose ends differ in range.
  const RangeImage image = make_image(small_lattice(8, 32), [](std::size_t row, std::size_t) {
    return 5 + static_cast<double>(row);
  });
  const PolarMesh mesh = make_polar_mesh(image);
  const DenseGrid grid(image.lattice, 4, 1);
  const RayHits hits = cast_rays(mesh, image.lattice, grid, all_of(grid), 1);
  for (std::size_t i = 4; i < grid.rows; ++i) {
    const double row = grid.row(i);
    const double above = std::floor(row), part = row - above;
    if (part == 0) continue;
    for (std::size_t j = 0; j < grid.columns; ++j) {
      // Where the ray crosses the segment between the two points of its column.
      const Vec3 a = image.lattice.direction(above, static_cast<double>(j)) * (5 + above);
      const Vec3 b = image.lattice.direction(above + 1, static_cast<double>(j)) * (6 + above);
      const Vec3 d = image.lattice.direction(row, static_cast<double>(j));
      const double expected = norm(cross(a, b - a)) / norm(cross(d, b - a));
      EXPECT_NEAR(hits.range[i * grid.columns + j], expected, 1e-9) << i << " " << j;
    }
  }
}

TEST(CastRays, SameForAnyNumberOfThreads) {
  test::Random random(26);
  const RangeImage image = random_image(small_lattice(16, 64), 0.6, random);
  const PolarMesh mesh = make_polar_mesh(image);
  const DenseGrid grid(image.lattice, 2, 2);
  const RayHits one = cast_rays(mesh, image.lattice, grid, all_of(grid), 1);
  for (const std::size_t threads : {2u, 4u, 64u}) {
    const RayHits many = cast_rays(mesh, image.lattice, grid, all_of(grid), threads);
    EXPECT_EQ(many.range, one.range);
    EXPECT_EQ(many.triangle, one.triangle);
  }
}

TEST(CastRays, OnlyWantedCells) {
  test::Random random(27);
  const RangeImage image = random_image(small_lattice(6, 16), 1.0, random);
  const DenseGrid grid(image.lattice, 2, 2);
  std::vector<std::uint8_t> wanted(grid.rows * grid.columns, 0);
  for (std::size_t cell = 0; cell < wanted.size(); cell += 3) wanted[cell] = 1;
  const RayHits hits = cast_rays(make_polar_mesh(image), image.lattice, grid, wanted, 1);
  for (std::size_t cell = 0; cell < wanted.size(); ++cell) {
    EXPECT_EQ(hits.range[cell] > 0, wanted[cell] != 0) << cell;
  }
}

TEST(CastRays, EmptyMeshMeetsNothing) {
  const RangeImage image =
      make_image(small_lattice(4, 8), [](std::size_t, std::size_t) { return 0.0; });
  const DenseGrid grid(image.lattice, 2, 2);
  const RayHits hits = cast_rays(make_polar_mesh(image), image.lattice, grid, all_of(grid), 2);
  EXPECT_EQ(std::count(hits.range.begin(), hits.range.end(), 0.0), 8 * 16);
}

TEST(LargestTriangles, MarksTheShareByArea) {
  test::Random random(28);
  const PolarMesh mesh = make_polar_mesh(random_image(small_lattice(6, 24), 0.8, random));
  const auto area = [&](std::size_t t) {
    const Vec3& a = mesh.vertices[mesh.corner(t, 0)];
    return norm(cross(mesh.vertices[mesh.corner(t, 1)] - a, mesh.vertices[mesh.corner(t, 2)] - a));
  };
  for (const double share : {0.0, 0.1, 0.5, 1.0}) {
    const auto marked = largest_triangles(mesh, share);
    ASSERT_EQ(marked.size(), mesh.triangles());
    const auto count = static_cast<std::size_t>(std::count(marked.begin(), marked.end(), 1));
    EXPECT_EQ(count, static_cast<std::size_t>(static_cast<double>(mesh.triangles()) * share));
    double smallest_marked = 1e300, largest_kept = 0;
    for (std::size_t t = 0; t < marked.size(); ++t) {
      if (marked[t]) smallest_marked = std::min(smallest_marked, area(t));
      if (!marked[t]) largest_kept = std::max(largest_kept, area(t));
    }
    EXPECT_GE(smallest_marked, largest_kept);
  }
}

}  // namespace
}  // namespace curlidar
