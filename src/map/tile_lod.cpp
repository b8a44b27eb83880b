// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_lod.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "map/plane_fit.hpp"
#include "map/tile_points.hpp"

namespace curlidar::tile {
namespace {

using Coordinates = std::array<double, 3>;

Coordinates as_array(const Vec3& p) {
  return {p.x, p.y, p.z};
}

/// The middle of a set cell, and its area as seen along its leaf's axis.
struct CellMiddle {
  Coordinates at{};
  double area = 0;
};

/// The cube of a level that a place lies in: its corner.
Coordinates corner_of(const Vec3& centre, double edge) {
  Coordinates corner = as_array(centre);
  for (double& c : corner) c = std::floor(c / edge) * edge;
  return corner;
}

void add_cells(const MapTile& tile, const MapLeaf& leaf, std::vector<CellMiddle>& cells) {
  const double edge = leaf.size_m / leaf.cells;
  const std::uint32_t ua = u_axis(leaf.axis), va = v_axis(leaf.axis);
  for (std::uint32_t i = 0; i < leaf.cells; ++i) {
    for (std::uint32_t j = 0; j < leaf.cells; ++j) {
      if (tile.footprint[leaf.first_cell + std::size_t{i} * leaf.cells + j] == 0) continue;
      const double du = (i + 0.5) * edge - leaf.size_m / 2, dv = (j + 0.5) * edge - leaf.size_m / 2;
      CellMiddle cell{as_array(leaf.centre), edge * edge};
      const double middle = cell.at[leaf.axis];
      cell.at[ua] += du;
      cell.at[va] += dv;
      cell.at[leaf.axis] =
          std::clamp(leaf_height(leaf, du, dv), middle - leaf.size_m / 2, middle + leaf.size_m / 2);
      cells.push_back(cell);
    }
  }
}

/// One leaf for leaves that lie in one cube of the level.
void merge(const MapTile& tile, std::span<const std::size_t> leaves, const TileLayout& layout,
           std::uint32_t level, MapTile& out) {
  const double edge = static_cast<double>(layout.edge(level)) / kTicks;
  const Coordinates corner = corner_of(tile.leaves[leaves.front()].centre, edge);
  std::vector<CellMiddle> cells;
  std::array<double, 3> area{};
  double lit = 0, lit_area = 0;
  for (const std::size_t i : leaves) {
    const MapLeaf& leaf = tile.leaves[i];
    const std::size_t before = cells.size();
    add_cells(tile, leaf, cells);
    for (std::size_t k = before; k < cells.size(); ++k) {
      area[leaf.axis] += cells[k].area;
      if (!std::isfinite(leaf.intensity)) continue;
      lit += cells[k].area * static_cast<double>(leaf.intensity);
      lit_area += cells[k].area;
    }
  }
  if (cells.empty()) return;
  MapLeaf leaf;
  leaf.size_m = edge;
  leaf.level = static_cast<std::uint8_t>(level);
  leaf.axis = 2;
  if (area[0] > area[2]) leaf.axis = 0;
  if (area[1] > area[leaf.axis]) leaf.axis = 1;
  const std::uint32_t ua = u_axis(leaf.axis), va = v_axis(leaf.axis);
  const Coordinates centre = {corner[0] + edge / 2, corner[1] + edge / 2, corner[2] + edge / 2};
  leaf.centre = {centre[0], centre[1], centre[2]};
  leaf.cells = layout.cells(level);
  leaf.first_cell = out.footprint.size();
  out.footprint.resize(leaf.first_cell + std::size_t{leaf.cells} * leaf.cells, 0);
  FitMoments m;
  for (const CellMiddle& cell : cells) {
    const double u = (cell.at[ua] - centre[ua]) * 2 / edge,
                 v = (cell.at[va] - centre[va]) * 2 / edge;
    const double h = cell.at[leaf.axis] - centre[leaf.axis], w = cell.area;
    m.add(w, u, v, h);
    const auto place = [&](std::uint32_t axis) {
      const double cell_edge = edge / leaf.cells;
      return static_cast<std::size_t>(
          std::clamp((cell.at[axis] - corner[axis]) / cell_edge, 0.0, leaf.cells - 1.0));
    };
    out.footprint[leaf.first_cell + place(ua) * leaf.cells + place(va)] = 1;
  }
  const FittedPlane plane = plane_of_moments(m);
  leaf.height_m = centre[leaf.axis] + plane.height;
  leaf.slope = {plane.rise_u * 2 / edge, plane.rise_v * 2 / edge};
  if (lit_area > 0) leaf.intensity = static_cast<float>(lit / lit_area);
  out.leaves.push_back(leaf);
}

}  // namespace

MapTile coarser(const MapTile& tile, const TileLayout& layout, std::uint32_t max_level) {
  MapTile out;
  out.key = tile.key;
  out.origin = tile.origin;
  out.side_m = tile.side_m;
  const double edge = static_cast<double>(layout.edge(max_level)) / kTicks;
  std::vector<std::size_t> below;
  for (std::size_t i = 0; i < tile.leaves.size(); ++i) {
    const MapLeaf& leaf = tile.leaves[i];
    if (leaf.level > max_level) {
      below.push_back(i);
      continue;
    }
    out.leaves.push_back(leaf);
    out.leaves.back().first_cell = out.footprint.size();
    const auto cells = tile.footprint.begin() + static_cast<std::ptrdiff_t>(leaf.first_cell);
    out.footprint.insert(out.footprint.end(), cells,
                         cells + static_cast<std::ptrdiff_t>(std::size_t{leaf.cells} * leaf.cells));
  }
  const auto corner = [&](std::size_t i) { return corner_of(tile.leaves[i].centre, edge); };
  // Later passes put leaves into cubes of earlier ones.
  std::stable_sort(below.begin(), below.end(),
                   [&](std::size_t a, std::size_t b) { return corner(a) < corner(b); });
  for (std::size_t begin = 0, end = 0; begin < below.size(); begin = end) {
    while (end < below.size() && corner(below[end]) == corner(below[begin])) ++end;
    merge(tile, std::span(below).subspan(begin, end - begin), layout, max_level, out);
  }
  return out;
}

}  // namespace curlidar::tile
