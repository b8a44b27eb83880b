// SPDX-License-Identifier: BSD-3-Clause
// The surfaces between the points of a dense grid.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "reconstruct/surface.hpp"
#include "reconstruct/view.hpp"

namespace curlidar {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Steps in a surface that are no cliff: coarse files have such between their blocks.
constexpr double kStep_m = 0.1;
/// Grids with fewer columns know nothing of what lies between them.
constexpr std::uint64_t kFewestColumns = 8;
constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

/// A row of the grid at its columns and half way to the next ones: 2 * columns points.
std::vector<Vec3> fine_row(const ScanView& view, const DenseGrid& grid, double row) {
  std::vector<double> columns(2 * grid.columns);
  for (std::size_t j = 0; j < columns.size(); ++j) {
    columns[j] = static_cast<double>(j) * grid.column_step / 2;
  }
  std::vector<Vec3> points(columns.size());
  std::vector<float> confidence(columns.size());
  view.look_along_row(row, columns, points, confidence);
  return points;
}

/// The fine points between two rows of the grid.
struct Strip {
  const std::vector<Vec3>& top;
  const std::vector<Vec3>& middle;
  const std::vector<Vec3>& bottom;
};

/// Corners of a quad: top left, top right, bottom right, bottom left.
struct Quad {
  std::array<Vec3, 4> corner;
  std::array<Vec3, 4> side;  ///< half way from each corner to the next
  Vec3 middle;

  bool joined(std::size_t i) const {
    return is_straight(corner[i], side[i], corner[(i + 1) % 4], kStep_m);
  }
  bool across(std::size_t i) const {
    return is_straight(corner[i], middle, corner[i + 2], kStep_m);
  }
  double length(std::size_t i) const { return norm(corner[i] - corner[i + 2]); }
};

Quad quad_of(const Strip& strip, std::size_t column) {
  const std::size_t left = 2 * column, right = (left + 2) % strip.top.size();
  return {{strip.top[left], strip.top[right], strip.bottom[right], strip.bottom[left]},
          {strip.top[left + 1], strip.middle[right], strip.bottom[left + 1], strip.middle[left]},
          strip.middle[left + 1]};
}

/// The triangles of a quad, as numbers of its corners, counter-clockwise for the sensor: to whom
/// azimuth grows to the left.
void add_triangles(const Quad& quad, std::vector<Triangle>& triangles) {
  const std::array<bool, 2> across{quad.across(0), quad.across(1)};
  const bool second = across[1] && (!across[0] || quad.length(1) < quad.length(0));
  if (!across[0] && !across[1]) return;
  const std::uint32_t from = second ? 1 : 0;
  for (const std::uint32_t start : {from, from + 2}) {
    const std::uint32_t next = (start + 1) % 4;
    if (quad.joined(start % 4) && quad.joined(next)) {
      triangles.push_back({start % 4, next, (start + 2) % 4});
    }
  }
}

/// All triangles of a grid, with the points of the grid as vertices.
std::vector<Triangle> triangulate(const ScanView& view, const DenseGrid& grid,
                                  const std::vector<std::vector<Vec3>>& rows,
                                  const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 64;
  const auto width = static_cast<std::uint32_t>(grid.columns);
  std::vector<Triangle> all;
  in_batches(rows.size() - 1, kBatch, progress, [&](std::size_t begin, std::size_t end) {
    std::vector<std::vector<Triangle>> strips(end - begin);
    parallel_for(strips.size(), view.settings().threads, [&](std::size_t k) {
      const std::size_t i = begin + k;
      const std::vector<Vec3> middle = fine_row(view, grid, (grid.row(i) + grid.row(i + 1)) / 2);
      const Strip strip{rows[i], middle, rows[i + 1]};
      std::vector<Triangle> local;
      for (std::uint32_t j = 0; j < width; ++j) {
        const std::uint32_t top = static_cast<std::uint32_t>(i) * width, right = (j + 1) % width;
        const std::array<std::uint32_t, 4> number{top + j, top + right, top + width + right,
                                                  top + width + j};
        local.clear();
        add_triangles(quad_of(strip, j), local);
        for (const Triangle& t : local) {
          strips[k].push_back({number[t[0]], number[t[1]], number[t[2]]});
        }
      }
    });
    for (const auto& strip : strips) all.insert(all.end(), strip.begin(), strip.end());
  });
  return all;
}

/// Keeps the vertices that triangles use.
SurfaceMesh compact_mesh(const std::vector<std::vector<Vec3>>& rows, std::size_t width,
                         std::vector<Triangle> triangles) {
  SurfaceMesh mesh;
  std::vector<std::uint32_t> number(rows.size() * width, kUnused);
  for (Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) number[corner] = 0;
  }
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kUnused) continue;
    number[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(rows[i / width][2 * (i % width)]);
  }
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& corner : triangle) corner = number[corner];
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

/// Means of the triangles around each vertex, weighted by their areas.
std::vector<Vec3> vertex_normals(const SurfaceMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 normal = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    for (const std::uint32_t corner : t) normals[corner] = normals[corner] + normal;
  }
  for (Vec3& normal : normals) {
    const double length = norm(normal);
    normal = length > 0 ? normal * (1 / length) : kNowherePoint;
  }
  return normals;
}

}  // namespace

Result<SurfaceMesh> reconstruct_mesh(const DecodedScan& scan, const ReconstructSettings& settings,
                                     const ProgressCallback& progress) {
  CURLIDAR_TRY_ASSIGN(view, ScanView::make(scan, settings));
  const DenseGrid grid(view.field().lattice(), settings.rows, settings.columns);
  CURLIDAR_TRY(check_points(grid.rows, grid.columns, "a grid", settings));
  if (grid.rows * grid.columns >= kUnused) {
    return Error{ErrorCode::limit_exceeded, "meshes have fewer than 2^32 - 1 vertices"};
  }
  if (settings.keep_originals || settings.organised) {
    return Error{ErrorCode::invalid_argument,
                 "a mesh has no places for original returns or empty cells"};
  }
  if (grid.columns < kFewestColumns) return SurfaceMesh{};
  std::vector<std::vector<Vec3>> rows(grid.rows);
  parallel_for(rows.size(), settings.threads,
               [&](std::size_t i) { rows[i] = fine_row(view, grid, grid.row(i)); });
  SurfaceMesh mesh = compact_mesh(rows, grid.columns, triangulate(view, grid, rows, progress));
  if (settings.normals) mesh.normals = vertex_normals(mesh);
  return mesh;
}

}  // namespace curlidar
