// SPDX-License-Identifier: BSD-3-Clause
#include "paper/polar_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace curlidar {
namespace {

/// Flips diagonals of cocircular quadrilaterals until each is the shorter one in space.
class TieBreaker {
 public:
  TieBreaker(PolarMesh& mesh, std::uint32_t columns) : mesh_(mesh), columns_(columns) {}

  void run() {
    auto& twin = mesh_.surface.twin;
    std::vector<std::uint32_t> pending;
    for (std::uint32_t h = 0; h < twin.size(); ++h) {
      if (twin[h] != kNoTwin && h < twin[h]) pending.push_back(h);
    }
    // Every flip shortens the sum of all edges (or keeps it and lowers a vertex number): it ends.
    while (!pending.empty()) {
      const std::uint32_t h = pending.back();
      pending.pop_back();
      if (twin[h] == kNoTwin || !should_flip(h)) continue;
      const std::uint32_t other = twin[h];
      flip(h);
      for (const std::uint32_t e : {h, next_half_edge(h), previous_half_edge(h), other,
                                    next_half_edge(other), previous_half_edge(other)}) {
        pending.push_back(e);
      }
    }
  }

 private:
  std::uint32_t corner(std::uint32_t h) const { return mesh_.surface.corner[h]; }
  std::uint32_t row(std::uint32_t v) const { return mesh_.cells[v] / columns_; }
  std::uint32_t column(std::uint32_t v) const { return mesh_.cells[v] % columns_; }

  /// Whether two pairs, each on one ring, share their axis of symmetry.
  bool same_axis(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    return (column(a) + column(b)) % columns_ == (column(c) + column(d)) % columns_;
  }

  /// Four lattice points lie on one circle if they share a ring or form a symmetric trapezoid.
  bool cocircular(const std::array<std::uint32_t, 4>& v) const {
    std::array<std::uint32_t, 4> r{row(v[0]), row(v[1]), row(v[2]), row(v[3])};
    if (r[0] == r[1] && r[2] == r[3]) return r[0] == r[2] || same_axis(v[0], v[1], v[2], v[3]);
    if (r[0] == r[2] && r[1] == r[3]) return same_axis(v[0], v[2], v[1], v[3]);
    if (r[0] == r[3] && r[1] == r[2]) return same_axis(v[0], v[3], v[1], v[2]);
    return false;
  }

  double length2(std::uint32_t a, std::uint32_t b) const {
    const Vec3 d = mesh_.vertices[a] - mesh_.vertices[b];
    return dot(d, d);
  }

  bool should_flip(std::uint32_t h) const {
    const std::uint32_t other = mesh_.surface.twin[h];
    const std::uint32_t a = corner(h), b = corner(other);
    const std::uint32_t c = corner(previous_half_edge(h)), d = corner(previous_half_edge(other));
    if (!cocircular({a, b, c, d})) return false;
    const double now = length2(a, b), then = length2(c, d);
    return then < now || (then == now && std::min(c, d) < std::min(a, b));
  }

  /// Turns the edge a-b of the triangles abc and bad into c-d.
  void flip(std::uint32_t h) {
    auto& [corner, twin] = mesh_.surface;
    const std::uint32_t o = twin[h];
    const std::uint32_t hn = next_half_edge(h), hp = previous_half_edge(h);
    const std::uint32_t on = next_half_edge(o), op = previous_half_edge(o);
    const std::uint32_t outer_bc = twin[hn], outer_ad = twin[on];
    // Triangle of h becomes d, c, a (h: d->c, hn: c->a keeps hp's neighbour, hp: a->d).
    const std::uint32_t a = corner[h], b = corner[o], c = corner[hp], d = corner[op];
    const std::uint32_t outer_ca = twin[hp], outer_db = twin[op];
    corner[h] = d, corner[hn] = c, corner[hp] = a;
    corner[o] = c, corner[on] = d, corner[op] = b;
    link(hn, outer_ca);
    link(hp, outer_ad);
    link(on, outer_db);
    link(op, outer_bc);
  }
  void link(std::uint32_t h, std::uint32_t neighbour) {
    mesh_.surface.twin[h] = neighbour;
    if (neighbour != kNoTwin) mesh_.surface.twin[neighbour] = h;
  }

  PolarMesh& mesh_;
  std::uint32_t columns_;
};

/// Vertices of the hull in counter-clockwise order, starting at the lowest vertex number.
std::vector<std::uint32_t> hull_of(const Triangulation& surface, std::size_t vertices) {
  std::vector<std::uint32_t> after(vertices, kNoTwin);
  std::uint32_t first = kNoTwin;
  for (std::uint32_t h = 0; h < surface.twin.size(); ++h) {
    if (surface.twin[h] != kNoTwin) continue;
    after[surface.corner[h]] = surface.corner[next_half_edge(h)];
    first = std::min(first, surface.corner[h]);
  }
  std::vector<std::uint32_t> hull;
  if (first == kNoTwin) return hull;
  for (std::uint32_t v = first; hull.empty() || v != first; v = after[v]) hull.push_back(v);
  return hull;
}

std::vector<std::uint32_t> triangulate_cap(const std::vector<GridPoint>& points,
                                           const std::vector<std::uint32_t>& hull) {
  std::vector<GridPoint> rim;
  rim.reserve(hull.size());
  for (const std::uint32_t v : hull) rim.push_back(points[v]);
  std::vector<std::uint32_t> cap;
  for (const std::uint32_t corner : delaunay(rim).corner) cap.push_back(hull[corner]);
  for (std::size_t t = 0; t + 2 < cap.size(); t += 3) std::swap(cap[t + 1], cap[t + 2]);
  return cap;
}

}  // namespace

GridPoint polar_grid_point(const Lattice& lattice, std::size_t row, std::size_t column) {
  // The outermost ring takes all of the allowed coordinates: 65536 columns on the first of 4096
  // rings, the finest lattice there is, still lie on points of their own.
  const double unit = static_cast<double>(kMaxCoordinate) / lattice.rows();
  const double radius = static_cast<double>(row + 1) * unit;
  const double azimuth = lattice.azimuth(static_cast<double>(column));
  return {static_cast<std::int32_t>(std::lround(radius * std::cos(azimuth))),
          static_cast<std::int32_t>(std::lround(radius * std::sin(azimuth)))};
}

PolarMesh make_polar_mesh(const RangeImage& image) {
  PolarMesh mesh;
  std::vector<GridPoint> points;
  for (std::size_t row = 0; row < image.lattice.rows(); ++row) {
    for (std::size_t column = 0; column < image.lattice.columns(); ++column) {
      const std::size_t cell = image.index(row, column);
      if (!image.occupied(cell)) continue;
      mesh.vertices.push_back(image.point(row, column));
      mesh.cells.push_back(static_cast<std::uint32_t>(cell));
      points.push_back(polar_grid_point(image.lattice, row, column));
    }
  }
  mesh.surface = delaunay(points);
  TieBreaker(mesh, image.lattice.columns()).run();
  mesh.cap = triangulate_cap(points, hull_of(mesh.surface, points.size()));
  return mesh;
}

}  // namespace curlidar
