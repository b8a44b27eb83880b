// SPDX-License-Identifier: BSD-3-Clause
#include "paper/polar_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "unit/paper/images.hpp"

namespace curlidar {
namespace {

using test::make_image;
using test::random_image;
using test::small_lattice;

using Cells = std::array<std::uint32_t, 3>;

/// Corners as cells, rotated so that the lowest comes first.
Cells cells_of(const PolarMesh& mesh, std::size_t t) {
  Cells out{mesh.cells[mesh.corner(t, 0)], mesh.cells[mesh.corner(t, 1)],
            mesh.cells[mesh.corner(t, 2)]};
  std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  return out;
}

bool has_edge(const PolarMesh& mesh, std::uint32_t cell_a, std::uint32_t cell_b) {
  for (std::size_t t = 0; t < mesh.surface.triangles(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.cells[mesh.corner(t, k)],
                          b = mesh.cells[mesh.corner(t, (k + 1) % 3)];
      if ((a == cell_a && b == cell_b) || (a == cell_b && b == cell_a)) return true;
    }
  }
  return false;
}

/// Every directed edge is met as often as its reverse.
void expect_watertight(const PolarMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
      ASSERT_NE(a, b);
      ++balance[{a, b}];
      --balance[{b, a}];
    }
  }
  for (const auto& [edge, count] : balance) {
    ASSERT_EQ(count, 0) << edge.first << " " << edge.second;
  }
}

void expect_consistent_twins(const Triangulation& s) {
  for (std::uint32_t h = 0; h < s.corner.size(); ++h) {
    if (s.twin[h] == kNoTwin) continue;
    ASSERT_EQ(s.twin[s.twin[h]], h);
    ASSERT_EQ(s.corner[s.twin[h]], s.corner[next_half_edge(h)]);
    ASSERT_EQ(s.corner[next_half_edge(s.twin[h])], s.corner[h]);
  }
}

struct Plane {
  long double x, y;
};

/// Where the paper puts a cell, without rounding to integers: radius n, azimuth of the column.
Plane ideal(const RangeImage& image, std::uint32_t cell) {
  const long double n = cell / image.lattice.columns() + 1;
  const long double azimuth = 2 * std::numbers::pi_v<long double> *
                              (cell % image.lattice.columns()) / image.lattice.columns();
  return {n * std::cos(azimuth), n * std::sin(azimuth)};
}

/// Positive if d lies inside the circle through a, b, c.
long double ideal_in_circle(const Plane& a, const Plane& b, const Plane& c, const Plane& d) {
  const auto from = [&](const Plane& p) { return Plane{p.x - d.x, p.y - d.y}; };
  const auto square = [](const Plane& p) { return p.x * p.x + p.y * p.y; };
  const auto cross = [](const Plane& p, const Plane& q) { return p.x * q.y - p.y * q.x; };
  const Plane p = from(a), q = from(b), r = from(c);
  return square(p) * cross(q, r) + square(q) * cross(r, p) + square(r) * cross(p, q);
}

/// No neighbour's far corner lies inside a triangle's circle; among cocircular groups the shorter
/// diagonal was taken.
void expect_delaunay_with_ties(const RangeImage& image, const PolarMesh& mesh) {
  const auto& s = mesh.surface;
  for (std::uint32_t h = 0; h < s.corner.size(); ++h) {
    if (s.twin[h] == kNoTwin) continue;
    const std::uint32_t a = s.corner[h], b = s.corner[next_half_edge(h)],
                        c = s.corner[previous_half_edge(h)],
                        d = s.corner[previous_half_edge(s.twin[h])];
    const long double in =
        ideal_in_circle(ideal(image, mesh.cells[a]), ideal(image, mesh.cells[b]),
                        ideal(image, mesh.cells[c]), ideal(image, mesh.cells[d]));
    ASSERT_LE(in, 1e-6L) << h;
    if (std::abs(in) < 1e-13L) {
      EXPECT_LE(norm(mesh.vertices[a] - mesh.vertices[b]),
                norm(mesh.vertices[c] - mesh.vertices[d]));
    }
  }
}

TEST(PolarMesh, IsWatertightAndDelaunay) {
  test::Random random(11);
  for (const double occupied : {0.05, 0.3, 0.7, 1.0}) {
    for (const auto& [rows, columns] :
         {std::pair<std::uint32_t, std::uint32_t>{16, 64}, {3, 100}, {40, 12}, {1, 30}}) {
      const RangeImage image = random_image(small_lattice(rows, columns), occupied, random);
      const PolarMesh mesh = make_polar_mesh(image);
      if (mesh.triangles() == 0) continue;
      EXPECT_GE(mesh.cap.size(), 3u);
      expect_watertight(mesh);
      expect_consistent_twins(mesh.surface);
      expect_delaunay_with_ties(image, mesh);
    }
  }
}

TEST(PolarMesh, VerticesAreThePointsOfTheCells) {
  test::Random random(12);
  const RangeImage image = random_image(small_lattice(8, 32), 0.5, random);
  const PolarMesh mesh = make_polar_mesh(image);
  ASSERT_EQ(mesh.vertices.size(), mesh.cells.size());
  std::set<std::uint32_t> used;
  for (std::size_t v = 0; v < mesh.cells.size(); ++v) {
    ASSERT_TRUE(image.occupied(mesh.cells[v]));
    EXPECT_NEAR(norm(mesh.vertices[v]), image.range[mesh.cells[v]], 1e-12);
  }
  for (const std::uint32_t v : mesh.surface.corner) used.insert(v);
  EXPECT_EQ(used.size(), mesh.vertices.size());
}

TEST(PolarMesh, TakesTheShorterDiagonalOfAQuad) {
  constexpr std::uint32_t kColumns = 8;
  for (const std::uint32_t left : {0u, 3u, 7u}) {  // the last one straddles the seam
    const std::uint32_t right = (left + 1) % kColumns;
    for (const bool falling : {false, true}) {
      const RangeImage image =
          make_image(small_lattice(2, kColumns), [&](std::size_t row, std::size_t column) {
            if (column != left && column != right) return 0.0;
            const bool on_falling = (row == 0) == (column == left);
            // Ends of one diagonal stay near each other, those of the other one do not.
            if (on_falling == falling) return 10.0;
            return row == 0 ? 5.0 : 25.0;
          });
      const PolarMesh mesh = make_polar_mesh(image);
      ASSERT_EQ(mesh.surface.triangles(), 2u);
      EXPECT_EQ(has_edge(mesh, left, kColumns + right), falling) << left;
      EXPECT_EQ(has_edge(mesh, right, kColumns + left), !falling) << left;
    }
  }
}

TEST(PolarMesh, EqualDiagonalsAreDecidedByNumber) {
  const RangeImage image = make_image(
      small_lattice(2, 8), [](std::size_t, std::size_t column) { return column < 2 ? 10.0 : 0.0; });
  const PolarMesh mesh = make_polar_mesh(image);
  const bool falling = has_edge(mesh, 0, 9), rising = has_edge(mesh, 1, 8);
  EXPECT_NE(falling, rising);
}

TEST(PolarMesh, TurningTheImageTurnsTheMesh) {
  constexpr std::uint32_t kRows = 6, kColumns = 48;
  test::Random random(13);
  const RangeImage image = random_image(small_lattice(kRows, kColumns), 1.0, random);
  const auto turned_by = [&](std::uint32_t k) {
    return make_image(image.lattice, [&](std::size_t row, std::size_t column) {
      return image.range[image.index(row, (column + kColumns - k) % kColumns)];
    });
  };
  // The polygon within the first ring is one cocircular group, where only single flips are ruled.
  const auto bands = [](const PolarMesh& mesh, std::uint32_t turn_back) {
    std::set<Cells> out;
    for (std::size_t t = 0; t < mesh.surface.triangles(); ++t) {
      Cells cells = cells_of(mesh, t);
      if (*std::max_element(cells.begin(), cells.end()) < kColumns) continue;
      for (std::uint32_t& cell : cells) {
        cell = cell / kColumns * kColumns + (cell % kColumns + kColumns - turn_back) % kColumns;
      }
      std::rotate(cells.begin(), std::min_element(cells.begin(), cells.end()), cells.end());
      out.insert(cells);
    }
    return out;
  };
  const std::set<Cells> expected = bands(make_polar_mesh(image), 0);
  EXPECT_EQ(expected.size(), 2u * (kRows - 1) * kColumns);
  for (const std::uint32_t k : {1u, 7u, 24u, 47u}) {
    EXPECT_EQ(bands(make_polar_mesh(turned_by(k)), k), expected) << k;
  }
}

TEST(PolarMesh, CapFacesTheOtherWay) {
  const RangeImage image =
      make_image(small_lattice(4, 16), [](std::size_t, std::size_t) { return 10.0; });
  const PolarMesh mesh = make_polar_mesh(image);
  EXPECT_EQ(mesh.cap.size() / 3, 14u);  // a polygon of 16 corners
  EXPECT_EQ(mesh.surface.triangles(), 2 * 64u - 2 - 16u);
  double surface = 0, cap = 0;
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    const Plane a = ideal(image, mesh.cells[mesh.corner(t, 0)]),
                b = ideal(image, mesh.cells[mesh.corner(t, 1)]),
                c = ideal(image, mesh.cells[mesh.corner(t, 2)]);
    const auto twice = static_cast<double>((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    EXPECT_EQ(twice > 0, t < mesh.surface.triangles());
    (t < mesh.surface.triangles() ? surface : cap) += twice;
  }
  EXPECT_NEAR(surface, -cap, 1e-9);
}

TEST(PolarMesh, CopesWithFewPoints) {
  const Lattice lattice = small_lattice(4, 16);
  const auto mesh_of = [&](const std::vector<std::uint32_t>& cells) {
    return make_polar_mesh(make_image(lattice, [&](std::size_t row, std::size_t column) {
      const auto cell = static_cast<std::uint32_t>(row * 16 + column);
      return std::count(cells.begin(), cells.end(), cell) > 0 ? 7.0 : 0.0;
    }));
  };
  EXPECT_EQ(mesh_of({}).triangles(), 0u);
  EXPECT_EQ(mesh_of({5}).triangles(), 0u);
  EXPECT_EQ(mesh_of({5, 40}).triangles(), 0u);
  const PolarMesh three = mesh_of({5, 9, 40});
  EXPECT_EQ(three.surface.triangles(), 1u);
  EXPECT_EQ(three.cap.size(), 3u);
  expect_watertight(three);
  EXPECT_EQ(mesh_of({0, 16, 32, 48}).triangles(), 0u);  // one column, on an axis
  expect_watertight(mesh_of({1, 17, 33, 49}));          // one column, off the axes
}

TEST(PolarGridPoint, KeepsTheFinestLatticeApart) {
  // The largest sizes that settings allow: neighbours on the first ring lie nearest.
  const Lattice lattice = small_lattice(4096, 65536);
  for (const std::size_t around : {0u, 8192u, 5000u, 32768u, 61000u}) {
    for (std::size_t column = around; column < around + 200; ++column) {
      EXPECT_NE(polar_grid_point(lattice, 0, column), polar_grid_point(lattice, 0, column + 1))
          << column;
    }
  }
  const GridPoint rim = polar_grid_point(lattice, 4095, 0);
  EXPECT_LE(std::abs(rim.x), kMaxCoordinate);
}

}  // namespace
}  // namespace curlidar
