// SPDX-License-Identifier: BSD-3-Clause
#include "records/walk_search.hpp"

#include <algorithm>
#include <limits>

namespace curlidar {
namespace {

/// A slot whose record lies in a cell.
struct Visit {
  std::uint64_t slot;
  std::uint32_t row, column;
};

std::vector<Visit> visits_of(const CloudOrder& order, const CellGrid& grid) {
  std::vector<std::uint32_t> cell_of;
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    if (grid.occupied[cell] != 0) cell_of.push_back(static_cast<std::uint32_t>(cell));
  }
  std::vector<Visit> visits;
  visits.reserve(cell_of.size());
  std::size_t point = 0;
  for (std::uint64_t slot = 0; slot < order.slots(); ++slot) {
    if (order.kind[slot] != SlotKind::point) continue;
    const std::uint32_t record = order.record[point++];
    if (record >= cell_of.size()) continue;
    const std::uint32_t cell = cell_of[record];
    visits.push_back({slot, cell / grid.columns, cell % grid.columns});
  }
  return visits;
}

/// The most frequent of some values, the smallest of those; `fallback` if there are none.
std::int64_t mode(std::vector<std::int64_t>& values, std::int64_t fallback) {
  std::sort(values.begin(), values.end());
  std::size_t most = 0;
  for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
    while (end < values.size() && values[end] == values[begin]) ++end;
    if (end - begin <= most) continue;
    most = end - begin;
    fallback = values[begin];
  }
  return fallback;
}

class WalkSearch {
 public:
  WalkSearch(const CloudOrder& order, const CellGrid& grid)
      : grid_(grid), order_(order), visits_(visits_of(order, grid)) {
    backward_ = goes_backward();
  }

  std::vector<Walk> walks() const {
    std::vector<Walk> walks{Walk::raster(grid_.rows)};
    const auto add = [&](Walk walk) {
      if (std::find(walks.begin(), walks.end(), walk) == walks.end()) {
        walks.push_back(std::move(walk));
      }
    };
    if (visits_.empty()) return walks;
    add(ring_by_ring());
    add(firing_by_firing(false));
    add(firing_by_firing(true));
    if (order_.height > 1 && order_.width > 0) {
      add(organised(order_.width, false));
      add(organised(order_.width, true));
    } else if (order_.slots() % grid_.rows == 0) {
      add(organised(order_.slots() / grid_.rows, false));
      add(organised(grid_.rows, true));
    }
    return walks;
  }

 private:
  std::int64_t columns() const { return grid_.columns; }
  /// Columns from `from` to `to` in the walk's direction, in [0, columns).
  std::int64_t ahead(std::int64_t from, std::int64_t to) const {
    const std::int64_t way = (backward_ ? from - to : to - from) % columns();
    return way < 0 ? way + columns() : way;
  }
  /// The column so many columns ahead.
  std::uint32_t column_ahead(std::int64_t column, std::int64_t by) const {
    const std::int64_t found = (column + (backward_ ? -by : by)) % columns();
    return static_cast<std::uint32_t>(found < 0 ? found + columns() : found);
  }

  /// Whether columns mostly fall from one point of a row to the next.
  bool goes_backward() const {
    std::vector<std::int64_t> last(grid_.rows, -1);
    std::int64_t rises = 0;
    for (const Visit& visit : visits_) {
      std::int64_t& before = last[visit.row];
      const std::int64_t way = (visit.column - before + columns()) % columns();
      if (before >= 0) rises += 2 * way <= columns() ? 1 : -1;
      before = visit.column;
    }
    return rises < 0;
  }

  Walk empty_walk(bool by_column) const {
    Walk walk = Walk::raster(grid_.rows);
    walk.by_column = by_column;
    walk.backward = backward_;
    return walk;
  }

  /// Rows sorted by a key, those with equal keys as they are.
  template <class Key>
  static void sort_rows(Walk& walk, const std::vector<Key>& key) {
    std::stable_sort(walk.rows.begin(), walk.rows.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
  }

  /// Rows as they first appear, each from where it starts: the first column but for a few early
  /// ones that lie a little before it.
  Walk ring_by_ring() const {
    constexpr std::size_t kEarly = 16;
    constexpr std::int64_t kLittle = 64;
    Walk walk = empty_walk(false);
    std::vector<std::uint64_t> appears(grid_.rows, order_.slots());
    std::vector<std::size_t> points(grid_.rows);
    for (const Visit& visit : visits_) {
      std::uint32_t& first = walk.first[visit.row];
      if (points[visit.row]++ == 0) {
        appears[visit.row] = visit.slot;
        first = visit.column;
      } else if (points[visit.row] <= kEarly && ahead(visit.column, first) < kLittle) {
        first = visit.column;
      }
    }
    sort_rows(walk, appears);
    return walk;
  }

  /// Each row against one row of reference: the usual way from its last point, in columns and in
  /// slots. `from_first`: firings begin with the row of the first point, else with the reference.
  Walk firing_by_firing(bool from_first) const {
    const std::uint32_t reference = fullest_row();
    std::vector<std::vector<std::int64_t>> ways(grid_.rows), gaps(grid_.rows);
    const Visit* last = nullptr;
    for (const Visit& visit : visits_) {
      if (visit.row == reference) last = &visit;
      if (last == nullptr) continue;
      ways[visit.row].push_back(ahead(last->column, visit.column));
      gaps[visit.row].push_back(static_cast<std::int64_t>(visit.slot - last->slot));
    }
    Walk walk = empty_walk(true);
    std::vector<std::int64_t> way(grid_.rows), gap(grid_.rows);
    for (std::uint32_t row = 0; row < grid_.rows; ++row) {
      std::vector<std::int64_t> sorted = ways[row];
      way[row] = mode(sorted, 0);
      gap[row] = mean_gap(ways[row], gaps[row], way[row]);
    }
    sort_rows(walk, gap);
    const Visit& start = visits_.front();
    if (from_first) {
      const auto at = std::find(walk.rows.begin(), walk.rows.end(), start.row);
      for (auto row = walk.rows.begin(); row != at; ++row) ++way[*row];
      std::rotate(walk.rows.begin(), at, walk.rows.end());
    }
    for (std::uint32_t row = 0; row < grid_.rows; ++row) {
      walk.first[row] = column_ahead(start.column, way[row] - way[start.row]);
    }
    return walk;
  }

  /// The mean, in 1/256, of those gaps whose way is the usual one: rows that come later in a firing
  /// have larger ones.
  static std::int64_t mean_gap(const std::vector<std::int64_t>& ways,
                               const std::vector<std::int64_t>& gaps, std::int64_t usual) {
    std::int64_t sum = 0, count = 0;
    for (std::size_t i = 0; i < ways.size(); ++i) {
      if (ways[i] != usual) continue;
      sum += 256 * gaps[i];
      ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<std::int64_t>::max();
  }

  std::uint32_t fullest_row() const {
    std::vector<std::size_t> points(grid_.rows);
    for (const Visit& visit : visits_) ++points[visit.row];
    return static_cast<std::uint32_t>(
        std::distance(points.begin(), std::max_element(points.begin(), points.end())));
  }

  /// Slots of cells in lines of `width`: a line is a row, or one firing of all rows.
  Walk organised(std::uint64_t width, bool by_column) const {
    std::vector<std::vector<std::int64_t>> places(grid_.rows), firsts(grid_.rows);
    for (const Visit& visit : visits_) {
      const auto line = static_cast<std::int64_t>(visit.slot / width);
      const auto within = static_cast<std::int64_t>(visit.slot % width);
      places[visit.row].push_back(by_column ? within : line);
      const std::int64_t steps = (by_column ? line : within) % columns();
      firsts[visit.row].push_back(column_ahead(visit.column, -steps));
    }
    Walk walk = empty_walk(by_column);
    std::vector<std::int64_t> place(grid_.rows);
    std::vector<std::uint32_t> unplaced;
    for (std::uint32_t row = 0; row < grid_.rows; ++row) {
      place[row] = mode(places[row], -1);
      walk.first[row] = static_cast<std::uint32_t>(mode(firsts[row], 0));
    }
    fill_places(place);
    sort_rows(walk, place);
    return walk;
  }

  /// Gives rows without points, at -1, the places that no other row has.
  void fill_places(std::vector<std::int64_t>& place) const {
    std::vector<std::uint8_t> taken(grid_.rows);
    for (const std::int64_t at : place) {
      if (at >= 0 && at < grid_.rows) taken[static_cast<std::size_t>(at)] = 1;
    }
    std::size_t next = 0;
    for (std::int64_t& at : place) {
      if (at >= 0) continue;
      while (next < taken.size() && taken[next] != 0) ++next;
      at = static_cast<std::int64_t>(next++);
    }
  }

  const CellGrid& grid_;
  const CloudOrder& order_;
  std::vector<Visit> visits_;
  bool backward_ = false;
};

}  // namespace

std::vector<Walk> likely_walks(const CloudOrder& order, const CellGrid& grid) {
  return WalkSearch(order, grid).walks();
}

}  // namespace curlidar
