// SPDX-License-Identifier: BSD-3-Clause
#include "compact/prediction.hpp"

#include <algorithm>
#include <cstdlib>

#include "compact/cell_finder.hpp"
#include "compact/ray_points.hpp"
#include "compact/row_offsets.hpp"

namespace curlidar::compact {
namespace {

constexpr std::int64_t kOne = std::int64_t{1} << 30;
constexpr std::int64_t kMostPlane = std::int64_t{1} << 38;
constexpr std::int64_t kFarthest = std::int64_t{1} << 28;

std::int64_t limited(std::int64_t x) {
  return std::clamp(x, -kFarthest, kFarthest);
}

std::int64_t turned_part(const Axis& row, std::int64_t x, std::int64_t y, std::int64_t z) {
  return mul_shift(row.x, x, 30) + mul_shift(row.y, y, 30) + mul_shift(row.z, z, 30);
}

std::int64_t length_of(const Place& p) {
  return static_cast<std::int64_t>(
      isqrt(static_cast<std::uint64_t>(p.x * p.x + p.y * p.y + p.z * p.z)));
}

/// The plane square to the line from the centre to a place.
Plane facing(const Place& p) {
  const std::int64_t r = std::clamp(length_of(p), kMinRange, kMaxRange);
  const std::int64_t inverse = (std::int64_t{1} << 46) / r;
  const auto part = [&](std::int64_t x) { return (inverse * ((x * (1 << 14)) / r)) >> 14; };
  return {part(p.x), part(p.y), part(p.z)};
}

class Mover {
 public:
  Mover(const DecodedScan& reference, const RelativePose& pose)
      : reference_(reference),
        matrix_(matrix_of(pose)),
        sights_(reference.table, reference.parameters.rows, reference.parameters.columns) {}

  /// Where a return of the reference lies now.
  Place place(std::size_t cell) const {
    const Sight sight = sights_.at(cell);
    const auto row = static_cast<std::uint32_t>(cell / reference_.parameters.columns);
    const std::int64_t r =
        std::clamp(std::int64_t{reference_.range[cell]} - offset_of(reference_.table, row),
                   kMinRange, kMaxRange);
    const std::int64_t x = sight.origin.x + ((r * sight.direction.x) >> 22),
                       y = sight.origin.y + ((r * sight.direction.y) >> 22),
                       z = sight.origin.z + ((r * sight.direction.z) >> 22);
    const auto part = [&](std::size_t i) {
      return limited(turned_part(matrix_.row[i], x, y, z) + matrix_.move[i]);
    };
    return {part(0), part(1), part(2)};
  }

  /// The plane on which it lies: its surface's, moved into the return.
  Plane plane(std::size_t cell, const Place& place) const {
    if (reference_.surface[cell] < 0) return facing(place);
    const Plane n = surface_in(reference_, cell).plane;
    const auto part = [&](std::size_t i) { return turned_part(matrix_.row[i], n.x, n.y, n.z); };
    const Plane m{part(0), part(1), part(2)};
    const std::int64_t at =
        mul_shift(m.x, place.x, 16) + mul_shift(m.y, place.y, 16) + mul_shift(m.z, place.z, 16);
    if (at < kOne / 4 || at > 4 * kOne) return facing(place);
    const std::int64_t share = (std::int64_t{1} << 60) / at;
    const auto scaled = [&](std::int64_t x) {
      return std::clamp(mul_shift(x, share, 30), -kMostPlane, kMostPlane);
    };
    return {scaled(m.x), scaled(m.y), scaled(m.z)};
  }

 private:
  const DecodedScan& reference_;
  PoseMatrix matrix_;
  Sights sights_;
};

std::int64_t range_in(const Plane& plane, const Sight& sight) {
  return range_of(plane.at(sight.direction), kOne - plane.beside(sight.origin));
}

/// Extends planes to the cells beside those that have one, a cell further each time; of several
/// neighbours the farthest, which is what comes to light where something near moved away.
void extend(const Sights& sights, bool closed, Prediction& out) {
  std::vector<std::uint32_t> edge, next;
  for (std::uint32_t cell = 0; cell < out.source.size(); ++cell) {
    if (out.source[cell] >= 0) edge.push_back(cell);
  }
  const std::uint32_t columns = out.columns;
  std::vector<std::int32_t> taken(out.source.size(), -1);
  for (std::uint8_t level = 1; level < Prediction::kLevels && !edge.empty(); ++level) {
    next.clear();
    const auto offer = [&](std::uint32_t from, std::uint32_t to) {
      if (out.source[to] >= 0) return;
      const std::int32_t before = taken[to];
      if (before < 0) next.push_back(to);
      if (before < 0 || out.range[static_cast<std::size_t>(before)] < out.range[from]) {
        taken[to] = static_cast<std::int32_t>(from);
      }
    };
    for (const std::uint32_t cell : edge) {
      const std::uint32_t row = cell / columns, column = cell % columns;
      if (column > 0 || closed) offer(cell, column > 0 ? cell - 1 : cell + columns - 1);
      if (column + 1 < columns || closed) {
        offer(cell, column + 1 < columns ? cell + 1 : cell + 1 - columns);
      }
      if (row > 0) offer(cell, cell - columns);
      if (row + 1 < out.rows) offer(cell, cell + columns);
    }
    std::sort(next.begin(), next.end());
    for (const std::uint32_t cell : next) {
      out.source[cell] = out.source[static_cast<std::size_t>(taken[cell])];
      out.level[cell] = level;
      out.range[cell] = static_cast<std::int32_t>(
          range_in(out.planes[static_cast<std::size_t>(out.source[cell])], sights.at(cell)));
    }
    edge.swap(next);
  }
}

/// Marks the cells that look where the reference had a return: the same row, the nearest column.
void mark_was_there(const DecodedScan& reference, const RowTable& table, Prediction& out) {
  if (reference.parameters.rows != out.rows ||
      reference.table.rays.has_value() != table.rays.has_value()) {
    return;
  }
  const CellFinder finder(reference.table, reference.parameters.rows, reference.parameters.columns);
  for (std::uint32_t row = 0; row < out.rows; ++row) {
    for (std::uint32_t column = 0; column < out.columns; ++column) {
      const std::uint32_t angle =
          table.rays
              ? table.rays->encoder_angle(table.rays->firings[table.rays->firing_of(row, column)])
              : azimuth_of_column(table.first_column + column, table.turn_columns);
      const std::int64_t there = finder.column_at(row, angle);
      if (there < 0) continue;
      const std::size_t from =
          std::size_t{row} * reference.parameters.columns + static_cast<std::size_t>(there);
      out.was_there[std::size_t{row} * out.columns + column] = reference.range[from] > 0 ? 1 : 0;
    }
  }
}

}  // namespace

PoseMatrix matrix_of(const RelativePose& pose) {
  PoseMatrix out;
  std::array<std::int64_t, 3> turn{};
  for (std::size_t i = 0; i < 3; ++i) {
    turn[i] = std::int64_t{pose.turn[i]} << (30 - RelativePose::kTurnBits);
    out.move[i] = std::int64_t{pose.move[i]} << (16 - RelativePose::kMoveBits);
  }
  const FixedPoint x = turned(turn, {kOne, 0, 0}), y = turned(turn, {0, kOne, 0}),
                   z = turned(turn, {0, 0, kOne});
  out.row = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
  return out;
}

Prediction predict(const DecodedScan& reference, const RelativePose& pose, const RowTable& table,
                   std::uint32_t rows, std::uint32_t columns) {
  const std::size_t cells = std::size_t{rows} * columns;
  Prediction out;
  out.rows = rows;
  out.columns = columns;
  out.source.assign(cells, Prediction::kNone);
  out.range.assign(cells, 0);
  out.level.assign(cells, Prediction::kLevels);
  out.was_there.assign(cells, 0);

  const Mover mover(reference, pose);
  const CellFinder finder(table, rows, columns);
  const Sights sights(table, rows, columns);
  std::vector<std::int32_t> nearest(cells, INT32_MAX), from(cells, -1);
  for (std::size_t cell = 0; cell < reference.range.size(); ++cell) {
    if (reference.range[cell] <= 0) continue;
    const Place place = mover.place(cell);
    const std::int64_t to = finder.cell_of(place);
    if (to < 0) continue;
    const auto at = static_cast<std::size_t>(to);
    const auto range = static_cast<std::int32_t>(length_of(place));
    if (range >= nearest[at]) continue;
    nearest[at] = range;
    from[at] = static_cast<std::int32_t>(cell);
  }
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (from[cell] < 0) continue;
    const auto cell_before = static_cast<std::size_t>(from[cell]);
    const Place place = mover.place(cell_before);
    const Sight sight = sights.at(cell);
    Plane plane = mover.plane(cell_before, place);
    std::int64_t range = range_in(plane, sight);
    // Planes seen along themselves say little beside the line of sight.
    if (4 * range < 3 * std::int64_t{nearest[cell]} ||
        3 * range > 4 * std::int64_t{nearest[cell]}) {
      plane = facing(place);
      range = range_in(plane, sight);
    }
    out.source[cell] = static_cast<std::int32_t>(out.planes.size());
    out.planes.push_back(plane);
    out.range[cell] = static_cast<std::int32_t>(range);
    out.level[cell] = 0;
  }
  extend(sights, columns == table.turn_columns, out);
  mark_was_there(reference, table, out);
  out.learnt = reference.learnt;
  return out;
}

Guide guide_of(const Prediction& prediction, const SegmentPlace& place) {
  Guide out;
  out.planes = &prediction.planes;
  const auto cut = [&](const auto& from, auto& to) {
    to.reserve(place.cells());
    for (std::uint32_t i = 0; i < place.rows; ++i) {
      const auto begin =
          from.begin() + static_cast<std::ptrdiff_t>(
                             std::size_t{place.row + i} * prediction.columns + place.column);
      to.insert(to.end(), begin, begin + place.columns);
    }
  };
  cut(prediction.source, out.source);
  cut(prediction.range, out.range);
  cut(prediction.level, out.level);
  cut(prediction.was_there, out.was_there);
  if (place.rows == prediction.rows && place.columns == prediction.columns) {
    out.learnt = prediction.learnt.get();
  }
  return out;
}

}  // namespace curlidar::compact
