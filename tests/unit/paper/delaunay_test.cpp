// SPDX-License-Identifier: BSD-3-Clause
#include "paper/delaunay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "support/clouds.hpp"

namespace curlidar {
namespace {

__extension__ typedef __int128 Int128;
using Points = std::vector<GridPoint>;

Int128 cross_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return Int128{b.x - Int128{a.x}} * (c.y - Int128{a.y}) -
         Int128{b.y - Int128{a.y}} * (c.x - Int128{a.x});
}

Int128 lift(const GridPoint& p) {
  return Int128{p.x} * p.x + Int128{p.y} * p.y;
}

/// The determinant of the lifted points, expanded by their heights over the origin: another form
/// than that under test.
Int128 lifted_determinant(const GridPoint& a, const GridPoint& b, const GridPoint& c,
                          const GridPoint& d) {
  return lift(a) * cross_of(b, c, d) - lift(b) * cross_of(a, c, d) + lift(c) * cross_of(a, b, d) -
         lift(d) * cross_of(a, b, c);
}

/// Points on the boundary of the convex hull (those inside its edges too), counter-clockwise.
Points boundary(Points points) {
  std::sort(points.begin(), points.end());
  Points hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t begin = hull.size();
    for (const GridPoint& p : points) {
      while (hull.size() >= begin + 2 && cross_of(hull[hull.size() - 2], hull.back(), p) < 0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// Everything that makes a triangulation of points, not all on a line, a Delaunay one.
void expect_delaunay(const Points& points) {
  const Triangulation t = delaunay(points);
  const Points hull = boundary(points);
  ASSERT_EQ(t.triangles(), 2 * points.size() - 2 - hull.size());
  ASSERT_EQ(t.twin.size(), t.corner.size());
  Int128 area = 0, hull_area = 0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) {
    hull_area += cross_of(hull[0], hull[i], hull[i + 1]);
  }
  std::size_t open = 0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> directed;
  for (std::uint32_t h = 0; h < t.corner.size(); ++h) {
    const std::uint32_t from = t.corner[h], to = t.corner[next_half_edge(h)];
    EXPECT_EQ(previous_half_edge(next_half_edge(h)), h);
    EXPECT_TRUE(directed.insert({from, to}).second);
    if (t.twin[h] == kNoTwin) {
      ++open;
      continue;
    }
    ASSERT_LT(t.twin[h], t.corner.size());
    EXPECT_EQ(t.twin[t.twin[h]], h);
    EXPECT_EQ(t.corner[t.twin[h]], to);
    EXPECT_EQ(t.corner[next_half_edge(t.twin[h])], from);
  }
  EXPECT_EQ(open, hull.size());
  for (std::size_t i = 0; i < t.corner.size(); i += 3) {
    const GridPoint &a = points[t.corner[i]], &b = points[t.corner[i + 1]],
                    &c = points[t.corner[i + 2]];
    const Int128 twice = cross_of(a, b, c);
    ASSERT_TRUE(twice > 0);
    area += twice;
    for (const GridPoint& d : points) {
      ASSERT_FALSE(lifted_determinant(a, b, c, d) > 0) << "a point lies inside a circle";
    }
  }
  EXPECT_TRUE(area == hull_area) << "triangles do not cover the hull";
}

Points distinct(Points points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::int32_t coordinate(test::Random& random, std::int32_t limit) {
  return static_cast<std::int32_t>(random.below(2 * static_cast<std::uint64_t>(limit) + 1)) - limit;
}

Points random_points(std::size_t count, std::int32_t limit, std::uint64_t seed) {
  test::Random random(seed);
  Points points(count);
  for (GridPoint& p : points) p = {coordinate(random, limit), coordinate(random, limit)};
  return distinct(points);
}

TEST(Predicates, AreExactAtTheLimits) {
  constexpr std::int32_t m = kMaxCoordinate;
  EXPECT_EQ(orientation({-m, -m}, {m, m}, {m - 1, m - 1}), 0);
  EXPECT_EQ(orientation({-m, -m}, {m, m}, {m - 1, m}), 1);
  EXPECT_EQ(orientation({-m, -m}, {m, m}, {m, m - 1}), -1);
  EXPECT_EQ(in_circle({-m, -m}, {m, -m}, {m, m}, {-m, m}), 0);
  EXPECT_EQ(in_circle({-m, -m}, {m, -m}, {m, m}, {-m + 1, m}), 1);
  EXPECT_EQ(in_circle({-m + 1, -m}, {m, -m}, {m, m}, {-m, m}), -1);
}

TEST(Predicates, AgreeWithDeterminantsNearTies) {
  test::Random random(3);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    // Four points of one large circle, moved by at most one unit.
    GridPoint p[4];
    for (GridPoint& q : p) {
      const double angle = static_cast<double>(random.below(64)) * 2 * std::numbers::pi / 64;
      const double radius = kMaxCoordinate - 2;
      q = {
          static_cast<std::int32_t>(std::lround(radius * std::cos(angle))) + coordinate(random, 1),
          static_cast<std::int32_t>(std::lround(radius * std::sin(angle))) + coordinate(random, 1)};
    }
    const Int128 turn = cross_of(p[0], p[1], p[2]);
    ASSERT_EQ(orientation(p[0], p[1], p[2]), (turn > 0) - (turn < 0));
    const Int128 in = lifted_determinant(p[0], p[1], p[2], p[3]);
    ASSERT_EQ(in_circle(p[0], p[1], p[2], p[3]), (in > 0) - (in < 0));
    zeros += in == 0;
  }
  EXPECT_GT(zeros, 0);
}

TEST(Delaunay, RandomPoints) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    expect_delaunay(random_points(3 + seed * 13, kMaxCoordinate, seed));
    expect_delaunay(random_points(40 + seed * 10, 12, seed + 100));  // many ties and lines
  }
}

TEST(Delaunay, IntegerGrids) {
  for (const std::int32_t step : {1, 1000003}) {
    Points points;
    for (std::int32_t x = -6; x <= 6; ++x) {
      for (std::int32_t y = -5; y <= 5; ++y) points.push_back({x * step, y * step});
    }
    expect_delaunay(points);
  }
}

TEST(Delaunay, ConcentricRings) {
  for (const int ring_points : {3, 4, 16, 45}) {
    Points points;
    for (int ring = 1; ring <= 6; ++ring) {
      for (int i = 0; i < ring_points; ++i) {
        const double angle = 2 * std::numbers::pi * i / ring_points;
        const double radius = ring * (kMaxCoordinate / 6.0);
        points.push_back({static_cast<std::int32_t>(std::lround(radius * std::cos(angle))),
                          static_cast<std::int32_t>(std::lround(radius * std::sin(angle)))});
      }
    }
    expect_delaunay(distinct(points));
  }
}

TEST(Delaunay, NearlyCocircularPointsAtTheLimits) {
  test::Random random(4);
  Points points;
  for (int i = 0; i < 150; ++i) {
    const double angle = 2 * std::numbers::pi * i / 150;
    points.push_back({static_cast<std::int32_t>(std::lround(kMaxCoordinate * std::cos(angle))),
                      static_cast<std::int32_t>(std::lround(kMaxCoordinate * std::sin(angle)))});
  }
  for (int i = 0; i < 10; ++i) points.push_back({coordinate(random, 2), coordinate(random, 2)});
  for (const std::int32_t x : {-kMaxCoordinate, kMaxCoordinate}) {
    for (const std::int32_t y : {-kMaxCoordinate, kMaxCoordinate}) points.push_back({x, y});
  }
  expect_delaunay(distinct(points));
}

TEST(Delaunay, PointsOnALineHaveNoTriangles) {
  EXPECT_EQ(delaunay({}).triangles(), 0u);
  EXPECT_EQ(delaunay({{1, 2}}).triangles(), 0u);
  EXPECT_EQ(delaunay({{1, 2}, {5, 5}}).triangles(), 0u);
  for (const GridPoint& step : {GridPoint{1, 0}, {0, 1}, {3, -7}, {100000, 99999}}) {
    Points points;
    for (std::int32_t i = -20; i <= 20; ++i) points.push_back({i * step.x, i * step.y});
    EXPECT_EQ(delaunay(points).triangles(), 0u);
    points.push_back({step.x + 1, step.y + 2});  // one beside the line
    expect_delaunay(points);
  }
}

TEST(Delaunay, DoesNotDependOnTheOrderOfPoints) {
  Points points = random_points(80, 1000000, 5);
  const auto triangles = [](const Points& from) {
    std::set<std::set<GridPoint>> out;
    const Triangulation t = delaunay(from);
    for (std::size_t i = 0; i < t.corner.size(); i += 3) {
      out.insert({from[t.corner[i]], from[t.corner[i + 1]], from[t.corner[i + 2]]});
    }
    return out;
  };
  const auto sorted = triangles(points);
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(triangles(points), sorted);
}

TEST(Delaunay, IsTheDualOfBoostsVoronoiDiagram) {
  const Points points = random_points(600, 1 << 20, 6);
  std::vector<boost::polygon::point_data<int>> sites;
  for (const GridPoint& p : points) sites.emplace_back(p.x, p.y);
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
  std::set<std::pair<std::size_t, std::size_t>> expected, found;
  for (const auto& edge : diagram.edges()) {
    const std::size_t a = edge.cell()->source_index(), b = edge.twin()->cell()->source_index();
    expected.insert({std::min(a, b), std::max(a, b)});
  }
  const Triangulation t = delaunay(points);
  for (std::uint32_t h = 0; h < t.corner.size(); ++h) {
    const std::size_t a = t.corner[h], b = t.corner[next_half_edge(h)];
    found.insert({std::min(a, b), std::max(a, b)});
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace curlidar
