// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_state.hpp"

#include <algorithm>
#include <cstdlib>

namespace curlidar::tile {
namespace {

/// How many of the latest planes are asked whether they cross a cube that touches none.
constexpr std::size_t kRecent = 24;

struct Vote {
  std::uint32_t plane = 0, votes = 0, crossing = 0;
};

}  // namespace

void TileState::begin_pass() {
  before_.lay_on(now_);
  now_ = FineCubes(layout_);
  later_ = true;
}

void TileState::forget(const TileCube& cube, const Mark& mark) {
  now_.fill(cube, kUnknown);
  leaves_.resize(mark.leaves);
  planes_.resize(mark.planes);
  cells_.resize(mark.cells);
}

std::uint32_t TileState::crossing_of(const CubeContext& c, const TilePlane& plane) const {
  const std::int32_t u = c.centre[u_axis(plane.axis)], v = c.centre[v_axis(plane.axis)];
  const std::int32_t middle = c.centre[plane.axis], q = c.half / 2;
  std::uint32_t inside = 0;
  for (const auto& [du, dv] : {std::array{0, 0}, {-q, -q}, {-q, q}, {q, -q}, {q, q}}) {
    inside += std::abs(std::int64_t{plane.at(u + du, v + dv)} - middle) <= c.half ? 1 : 0;
  }
  return inside == 0 ? 0 : inside < 4 ? 1 : 2;
}

bool TileState::any_in(const TileCube& cube, int dx, int dy, int dz) const {
  const auto f = static_cast<std::int32_t>(layout_.fine(cube.level));
  const std::int32_t x = (static_cast<std::int32_t>(cube.at[0]) + dx) * f;
  const std::int32_t y = (static_cast<std::int32_t>(cube.at[1]) + dy) * f;
  const std::int32_t z = (static_cast<std::int32_t>(cube.at[2]) + dz) * f;
  // The half of the neighbour that touches tells most of it.
  const std::int32_t x0 = dx < 0 ? f / 2 : 0, x1 = dx > 0 ? (f + 1) / 2 : f;
  const std::int32_t y0 = dy < 0 ? f / 2 : 0, y1 = dy > 0 ? (f + 1) / 2 : f;
  const std::int32_t z0 = dz < 0 ? f / 2 : 0, z1 = dz > 0 ? (f + 1) / 2 : f;
  const std::array<std::int32_t, 3> low = {x + x0, y + y0, z + z0}, high = {x + x1, y + y1, z + z1};
  return now_.any_leaf(low, high) || (later_ && before_.any_leaf(low, high));
}

void TileState::gather_planes(CubeContext& c, bool touching_any) const {
  const auto f = static_cast<std::int32_t>(layout_.fine(c.cube.level));
  const std::int32_t x0 = static_cast<std::int32_t>(c.cube.at[0]) * f;
  const std::int32_t y0 = static_cast<std::int32_t>(c.cube.at[1]) * f;
  const std::int32_t z0 = static_cast<std::int32_t>(c.cube.at[2]) * f;
  std::vector<Vote> votes;
  std::uint32_t touching = 0, smaller = 0;
  std::int32_t last = kUnknown;
  std::size_t last_vote = 0;
  const auto ask = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    const std::int32_t leaf = fine_at(x, y, z);
    if (leaf < 0) return;
    const PlacedLeaf& placed = leaves_[static_cast<std::size_t>(leaf)];
    ++touching;
    smaller += placed.cube.level > c.cube.level ? 1 : 0;
    if (leaf != last) {
      last = leaf;
      last_vote = 0;
      while (last_vote < votes.size() && votes[last_vote].plane != placed.plane) ++last_vote;
      if (last_vote == votes.size()) votes.push_back({placed.plane, 0, 0});
    }
    ++votes[last_vote].votes;
  };
  for (std::int32_t x = -1; touching_any && x <= f; ++x) {
    for (std::int32_t y = -1; y <= f; ++y) {
      const bool side = x < 0 || x == f || y < 0 || y == f;
      // What was coded before may lie in the cube itself.
      for (std::int32_t z = -1; z <= f; z += side || later_ ? 1 : f + 1) {
        ask(x0 + x, y0 + y, z0 + z);
      }
    }
  }
  if (votes.empty()) {
    const std::size_t n = std::min(planes_.size(), kRecent);
    for (std::size_t k = 1; k <= n; ++k) {
      const std::size_t plane = planes_.size() - k;
      if (crossing_of(c, planes_[plane]) > 0) {
        votes.push_back({static_cast<std::uint32_t>(plane), 0, 0});
      }
    }
  }
  for (Vote& vote : votes) vote.crossing = crossing_of(c, planes_[vote.plane]);
  std::sort(votes.begin(), votes.end(), [](const Vote& a, const Vote& b) {
    if (a.crossing != b.crossing) return a.crossing > b.crossing;
    return a.votes != b.votes ? a.votes > b.votes : a.plane > b.plane;
  });
  c.count = static_cast<std::uint32_t>(std::min<std::size_t>(votes.size(), kCandidates));
  for (std::uint32_t k = 0; k < c.count; ++k) {
    c.plane[k] = votes[k].plane;
    c.crossing[k] = votes[k].crossing;
  }
  if (c.count > 0) {
    const std::uint32_t reach = votes[0].votes, edge = static_cast<std::uint32_t>(f);
    c.contact = reach == 0 ? 0 : reach < edge ? 1 : reach < 2 * edge + 2 ? 2 : 3;
  }
  c.finer = smaller == 0 ? 0 : 2 * smaller < touching ? 1 : 2;
}

bool TileState::alone(const TileCube& root) const {
  const auto edge = static_cast<std::int64_t>(layout_.side_roots);
  for (std::int64_t dx = -1; dx <= 1; ++dx) {
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dz = -1; dz <= 1; ++dz) {
        const std::int64_t x = root.at[0] + dx, y = root.at[1] + dy, z = root.at[2] + dz;
        if (x < 0 || y < 0 || z < 0 || x >= edge || y >= edge || z >= layout_.rows) continue;
        const auto ux = static_cast<std::uint32_t>(x), uy = static_cast<std::uint32_t>(y),
                   uz = static_cast<std::uint32_t>(z);
        if (now_.may_hold(ux, uy, uz) || (later_ && before_.may_hold(ux, uy, uz))) return false;
      }
    }
  }
  return true;
}

CubeContext TileState::context(const TileCube& cube) const {
  CubeContext c;
  c.cube = cube;
  c.centre = centre_of(layout_, cube);
  c.half = layout_.edge(cube.level) / 2;
  const bool empty_around = cube.level == 0 && alone(cube);
  gather_planes(c, !empty_around);
  if (!leaves_.empty()) c.intensity = leaves_.back().intensity;
  if (empty_around) return c;
  constexpr std::array<std::array<int, 3>, 6> kBeside = {
      {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {-1, 0, 1}, {0, -1, 1}, {-1, -1, 0}}};
  for (std::uint32_t k = 0; k < kBeside.size(); ++k) {
    const auto& [dx, dy, dz] = kBeside[k];
    c.around |= any_in(cube, dx, dy, dz) ? 1u << k : 0;
  }
  return c;
}

TilePlane TileState::plane_of(const CubeContext& c, const TileLeafCode& leaf) const {
  TilePlane plane;
  if (leaf.candidate > 0) {
    plane = planes_[c.plane[leaf.candidate - 1]];
    if (leaf.terms == 0) return plane;
  } else {
    plane.axis = leaf.axis;
    plane.height = c.centre[leaf.axis];
    plane.u = c.centre[u_axis(leaf.axis)];
    plane.v = c.centre[v_axis(leaf.axis)];
  }
  const std::int32_t u = c.centre[u_axis(plane.axis)], v = c.centre[v_axis(plane.axis)];
  const std::int64_t height =
      plane.at(u, v) + std::int64_t{leaf.q[0]} * layout_.height_step(c.cube.level);
  plane.height =
      static_cast<std::int32_t>(std::clamp<std::int64_t>(height, -kMaxHeight, kMaxHeight));
  plane.u = u;
  plane.v = v;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::int64_t slope =
        plane.slope[k] + std::int64_t{leaf.q[k + 1]} * layout_.slope_step(c.cube.level);
    plane.slope[k] =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(slope, -kMaxSlope, kMaxSlope));
  }
  return plane;
}

std::array<std::int32_t, 3> TileState::curve_of(const CubeContext& c,
                                                const TileLeafCode& leaf) const {
  std::array<std::int32_t, 3> out{};
  if (!leaf.curved) return out;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t curve = std::int64_t{leaf.curve[k]} * layout_.curve_step(c.cube.level);
    out[k] = static_cast<std::int32_t>(std::clamp<std::int64_t>(curve, -kMaxCurve, kMaxCurve));
  }
  return out;
}

std::vector<std::uint8_t> TileState::open_cells(const CubeContext& c,
                                                const TilePlane& plane) const {
  const std::uint32_t m = layout_.cells(c.cube.level);
  std::vector<std::uint8_t> open(std::size_t{m} * m, 1);
  if (m == 1) return open;
  const std::int32_t cell = 2 * c.half / static_cast<std::int32_t>(m);
  const std::int64_t lean =
      (std::int64_t{std::abs(plane.slope[0])} + std::abs(plane.slope[1])) * cell >> 17;
  const std::int64_t reach = c.half + lean + kCellSlack;
  const std::int32_t u0 = c.centre[u_axis(plane.axis)] - c.half + cell / 2;
  const std::int32_t v0 = c.centre[v_axis(plane.axis)] - c.half + cell / 2;
  const std::int32_t middle = c.centre[plane.axis];
  for (std::uint32_t i = 0; i < m; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) {
      const std::int64_t height = plane.at(u0 + static_cast<std::int32_t>(i) * cell,
                                           v0 + static_cast<std::int32_t>(j) * cell);
      bool near = std::abs(height - middle) <= reach;
      if (near && later_) {
        near = cell_at(plane.axis, cell_middle(c, plane, static_cast<std::int32_t>(i),
                                               static_cast<std::int32_t>(j))) != 1;
      }
      open[std::size_t{i} * m + j] = near ? 1 : 0;
    }
  }
  return open;
}

std::uint8_t TileState::cell_at(std::uint32_t axis, const Ticks3& p) const {
  const std::uint32_t log2 = layout_.fine_log2();
  const std::int32_t base = layout_.first_row * layout_.edge(0);
  const std::int32_t found = fine_at(p[0] >> log2, p[1] >> log2, (p[2] - base) >> log2);
  if (found == kUnknown) return 2;
  if (found == kEmpty) return 0;
  const PlacedLeaf& leaf = leaves_[static_cast<std::size_t>(found)];
  if (planes_[leaf.plane].axis != axis) return 3;
  const std::uint32_t m = layout_.cells(leaf.cube.level);
  const std::int32_t cell = layout_.edge(leaf.cube.level) / static_cast<std::int32_t>(m);
  const auto place = [&](std::uint32_t k) {
    const std::int32_t corner =
        static_cast<std::int32_t>(leaf.cube.at[k]) * layout_.edge(leaf.cube.level) +
        (k == 2 ? base : 0);
    return static_cast<std::uint32_t>(p[k] - corner) / static_cast<std::uint32_t>(cell);
  };
  return cells_[leaf.first_cell + std::size_t{place(u_axis(axis))} * m + place(v_axis(axis))];
}

Ticks3 TileState::cell_middle(const CubeContext& c, const TilePlane& plane, std::int32_t i,
                              std::int32_t j) const {
  const std::int32_t cell = 2 * c.half / static_cast<std::int32_t>(layout_.cells(c.cube.level));
  const std::uint32_t ua = u_axis(plane.axis), va = v_axis(plane.axis);
  Ticks3 p{};
  p[ua] = c.centre[ua] - c.half + i * cell + cell / 2;
  p[va] = c.centre[va] - c.half + j * cell + cell / 2;
  p[plane.axis] = std::clamp(plane.at(p[ua], p[va]), c.centre[plane.axis] - c.half,
                             c.centre[plane.axis] + c.half - 1);
  return p;
}

std::vector<std::uint8_t> TileState::surroundings(const CubeContext& c,
                                                  const TilePlane& plane) const {
  const auto m = static_cast<std::int32_t>(layout_.cells(c.cube.level));
  std::vector<std::uint8_t> around(static_cast<std::size_t>((m + 2) * (m + 2)), 0);
  for (std::int32_t i = -1; i <= m; ++i) {
    const bool side = i < 0 || i == m;
    for (std::int32_t j = -1; j <= m; j += side || later_ ? 1 : m + 1) {
      const std::uint8_t state = cell_at(plane.axis, cell_middle(c, plane, i, j));
      const bool inside = !side && j >= 0 && j < m;
      around[static_cast<std::size_t>((i + 1) * (m + 2) + j + 1)] =
          inside && state != 1 ? 0 : state;
    }
  }
  return around;
}

void TileState::place(const CubeContext& c, const TileLeafCode& leaf) {
  PlacedLeaf placed{c.cube, 0, curve_of(c, leaf), leaf.intensity, cells_.size()};
  if (leaf.candidate > 0 && leaf.terms == 0) {
    placed.plane = c.plane[leaf.candidate - 1];
  } else {
    placed.plane = static_cast<std::uint32_t>(planes_.size());
    planes_.push_back(plane_of(c, leaf));
  }
  cells_.insert(cells_.end(), leaf.footprint.begin(), leaf.footprint.end());
  now_.fill(c.cube, static_cast<std::int32_t>(leaves_.size()));
  leaves_.push_back(placed);
}

}  // namespace curlidar::tile
