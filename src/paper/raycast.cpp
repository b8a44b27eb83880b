// SPDX-License-Identifier: BSD-3-Clause
#include "paper/raycast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Bound on the rounding error of dot(cross(a, b), d) / (|a| |b|) for a unit direction d.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
/// Triangles whose corners' directions span less volume are seen edge-on. The smallest cells of
/// the finest lattice over a usual field of view span a hundred times more.
constexpr double kEdgeOn = 1e-10;

/// The cone of directions that meet a triangle, and its plane.
struct Cone {
  Vec3 side[3];     ///< normals of the planes through the origin and an edge
  double slack[3];  ///< a direction this little outside of a side is on the edge
  Vec3 normal;      ///< of the triangle's plane
  double offset;    ///< dot(normal, any corner)
  bool edge_on;     ///< the origin lies in the triangle's plane

  Cone(const Vec3& a, const Vec3& b, const Vec3& c)
      : side{cross(a, b), cross(b, c), cross(c, a)},
        normal(cross(b - a, c - a)),
        offset(dot(normal, a)) {
    const double na = norm(a), nb = norm(b), nc = norm(c);
    slack[0] = kRounding * na * nb;
    slack[1] = kRounding * nb * nc;
    slack[2] = kRounding * nc * na;
    edge_on = std::abs(offset) <= kEdgeOn * na * nb * nc;
  }

  /// Distance along the unit direction, 0 if it does not meet the triangle. A triangle seen edge-on
  /// is left to its neighbours: its own distances would be rounding errors.
  double meet(const Vec3& d) const {
    if (edge_on) return 0;
    const double s0 = dot(side[0], d), s1 = dot(side[1], d), s2 = dot(side[2], d);
    const bool all_left = s0 >= -slack[0] && s1 >= -slack[1] && s2 >= -slack[2];
    const bool all_right = s0 <= slack[0] && s1 <= slack[1] && s2 <= slack[2];
    if (!all_left && !all_right) return 0;
    const double along = dot(normal, d);
    if (along == 0) return 0;
    const double t = offset / along;
    return t > 0 && std::isfinite(t) ? t : 0;
  }
};

/// Grid rows and (unwrapped) columns that a triangle may cover, both ends included.
struct Box {
  std::int64_t row_begin, row_end, column_begin, column_end;
};

struct Angles {
  double elevation, azimuth;
};

/// Largest elevation along the great-circle arc between two directions, as seen from above; for
/// the smallest one pass mirrored elevations.
double highest_on_arc(const Vec3& a, const Vec3& b, double elevation_a, double elevation_b) {
  const double ends = std::max(elevation_a, elevation_b);
  const Vec3 n = cross(a, b);
  const double horizontal2 = n.x * n.x + n.y * n.y;
  if (horizontal2 == 0) return ends;
  // The arc's circle is highest where its direction is (-n.x n.z, -n.y n.z, n.x^2 + n.y^2).
  const Vec3 top{-n.x * n.z, -n.y * n.z, horizontal2};
  const bool on_arc = dot(cross(a, top), n) > 0 && dot(cross(top, b), n) > 0;
  return on_arc ? elevation_of(top) : ends;
}

double wrap(double angle) {
  return angle - kTurn * std::round(angle / kTurn);
}

class Rasteriser {
 public:
  Rasteriser(const PolarMesh& mesh, const Lattice& lattice, const DenseGrid& grid,
             const std::vector<std::uint8_t>& wanted)
      : mesh_(mesh), lattice_(lattice), grid_(grid), wanted_(wanted) {
    angles_.reserve(mesh.vertices.size());
    for (const std::uint32_t cell : mesh.cells) {
      angles_.push_back({lattice.elevation(static_cast<double>(cell / lattice.columns())),
                         lattice.azimuth(static_cast<double>(cell % lattice.columns()))});
    }
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const double azimuth = lattice.azimuth(grid.column(j));
      columns_.push_back({std::cos(azimuth), std::sin(azimuth)});
    }
    for (std::size_t i = 0; i < grid.rows; ++i) {
      const double elevation = lattice.elevation(grid.row(i));
      rows_.push_back({std::cos(elevation), std::sin(elevation)});
    }
    for (std::size_t t = 0; t < mesh.triangles(); ++t) boxes_.push_back(box_of(t));
  }

  /// Draws every triangle into the rows [row_begin, row_end) of the grid.
  void draw(std::int64_t row_begin, std::int64_t row_end, RayHits& hits) const {
    for (std::size_t t = 0; t < boxes_.size(); ++t) {
      Box box = boxes_[t];
      box.row_begin = std::max(box.row_begin, row_begin);
      box.row_end = std::min(box.row_end, row_end - 1);
      if (box.row_begin <= box.row_end) draw_triangle(static_cast<std::uint32_t>(t), box, hits);
    }
  }

 private:
  struct CosSin {
    double cos, sin;
  };

  void draw_triangle(std::uint32_t t, const Box& box, RayHits& hits) const {
    const Cone cone(mesh_.vertices[mesh_.corner(t, 0)], mesh_.vertices[mesh_.corner(t, 1)],
                    mesh_.vertices[mesh_.corner(t, 2)]);
    const auto columns = static_cast<std::int64_t>(grid_.columns);
    for (std::int64_t i = box.row_begin; i <= box.row_end; ++i) {
      const CosSin& row = rows_[static_cast<std::size_t>(i)];
      const std::size_t line = static_cast<std::size_t>(i * columns);
      for (std::int64_t unwrapped = box.column_begin; unwrapped <= box.column_end; ++unwrapped) {
        const auto j = static_cast<std::size_t>(((unwrapped % columns) + columns) % columns);
        if (wanted_[line + j] == 0) continue;
        const Vec3 direction{row.cos * columns_[j].cos, row.cos * columns_[j].sin, row.sin};
        const double range = cone.meet(direction);
        double& best = hits.range[line + j];
        if (range > 0 && (best == 0 || range < best)) {
          best = range;
          hits.triangle[line + j] = t;
        }
      }
    }
  }

  Box box_of(std::size_t t) const {
    std::array<Angles, 3> corner;
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = angles_[mesh_.corner(t, k)];
      p[k] = direction_of(corner[k].elevation, corner[k].azimuth);
    }
    double top = -2, bottom = 2, turned = 0, west = 0, east = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3;
      top = std::max(top, highest_on_arc(p[k], p[l], corner[k].elevation, corner[l].elevation));
      const auto mirrored = [](const Vec3& v) { return Vec3{v.x, v.y, -v.z}; };
      bottom = std::min(bottom, -highest_on_arc(mirrored(p[k]), mirrored(p[l]),
                                                -corner[k].elevation, -corner[l].elevation));
      turned += wrap(corner[l].azimuth - corner[k].azimuth);
      west = std::min(west, turned);
      east = std::max(east, turned);
    }
    const bool around_pole = std::abs(turned) > 1;
    if (around_pole) {  // which of the poles does not matter: rows are bounded by the grid
      top = std::numbers::pi / 2;
      bottom = -top;
    }
    return to_grid(top, bottom, corner[0].azimuth + west, corner[0].azimuth + east, around_pole);
  }

  /// Cells whose directions lie in the given angles, one more on every side against rounding.
  Box to_grid(double top, double bottom, double west, double east, bool all_columns) const {
    const auto last_row = static_cast<std::int64_t>(grid_.rows) - 1;
    const auto row_index = [&](double elevation) {
      const double fine = lattice_.row_of(elevation);
      return static_cast<double>(last_row) - (grid_.last_row - fine) * grid_.row_factor;
    };
    Box box;
    box.row_begin = static_cast<std::int64_t>(
        std::clamp(std::floor(row_index(top)) - 1, 0.0, static_cast<double>(last_row) + 1));
    box.row_end = static_cast<std::int64_t>(
        std::clamp(std::ceil(row_index(bottom)) + 1, -1.0, static_cast<double>(last_row)));
    const double per_radian = static_cast<double>(grid_.columns) / kTurn;
    box.column_begin =
        static_cast<std::int64_t>(std::floor((west + std::numbers::pi) * per_radian)) - 1;
    box.column_end =
        static_cast<std::int64_t>(std::ceil((east + std::numbers::pi) * per_radian)) + 1;
    if (all_columns ||
        box.column_end - box.column_begin >= static_cast<std::int64_t>(grid_.columns)) {
      box.column_begin = 0;
      box.column_end = static_cast<std::int64_t>(grid_.columns) - 1;
    }
    return box;
  }

  const PolarMesh& mesh_;
  const Lattice& lattice_;
  const DenseGrid& grid_;
  const std::vector<std::uint8_t>& wanted_;
  std::vector<Angles> angles_;
  std::vector<CosSin> rows_, columns_;
  std::vector<Box> boxes_;
};

}  // namespace

RayHits cast_rays(const PolarMesh& mesh, const Lattice& lattice, const DenseGrid& grid,
                  const std::vector<std::uint8_t>& wanted, std::size_t threads) {
  RayHits hits{std::vector<double>(grid.rows * grid.columns, 0.0),
               std::vector<std::uint32_t>(grid.rows * grid.columns, kNoTwin)};
  const Rasteriser rasteriser(mesh, lattice, grid, wanted);
  const std::size_t bands = std::min<std::size_t>(resolve_threads(threads), grid.rows);
  parallel_for(bands, threads, [&](std::size_t band) {
    rasteriser.draw(static_cast<std::int64_t>(grid.rows * band / bands),
                    static_cast<std::int64_t>(grid.rows * (band + 1) / bands), hits);
  });
  return hits;
}

std::vector<std::uint8_t> largest_triangles(const PolarMesh& mesh, double share) {
  const std::size_t count = mesh.triangles();
  std::vector<double> area(count);
  std::vector<std::uint32_t> order(count);
  for (std::size_t t = 0; t < count; ++t) {
    const Vec3& a = mesh.vertices[mesh.corner(t, 0)];
    area[t] =
        norm(cross(mesh.vertices[mesh.corner(t, 1)] - a, mesh.vertices[mesh.corner(t, 2)] - a));
    order[t] = static_cast<std::uint32_t>(t);
  }
  const auto refused =
      static_cast<std::ptrdiff_t>(static_cast<double>(count) * std::clamp(share, 0.0, 1.0));
  const auto larger = [&](std::uint32_t a, std::uint32_t b) {
    return area[a] != area[b] ? area[a] > area[b] : a < b;
  };
  std::nth_element(order.begin(), order.begin() + refused, order.end(), larger);
  std::vector<std::uint8_t> marked(count, 0);
  for (std::ptrdiff_t i = 0; i < refused; ++i) marked[order[static_cast<std::size_t>(i)]] = 1;
  return marked;
}

}  // namespace curlidar
