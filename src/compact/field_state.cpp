// SPDX-License-Identifier: BSD-3-Clause
#include "compact/field_state.hpp"

#include <algorithm>

namespace curlidar::compact {
namespace {

/// Looks for coded cells along short runs beside a block.
class ParentSearch {
 public:
  ParentSearch(const FieldState& state, const Block& block)
      : state_(state), row_(block.row), column_(block.column), h_(block.height), w_(block.width) {}

  /// Cells of the five neighbours, -1 where there is none.
  std::int64_t left() const {
    const std::int64_t middle = row_ + h_ / 2;
    std::int64_t cell = run(middle, column_ - 1, 1, 0, h_ - h_ / 2);
    if (cell < 0) cell = run(middle, column_ - 1, -1, 0, h_ / 2 + 1);
    if (cell < 0) cell = run(middle, column_ - 2, 0, -1, 3);
    return cell;
  }
  std::int64_t above() const {
    const std::int64_t middle = column_ + w_ / 2;
    std::int64_t cell = run(row_ - 1, middle, 0, 1, w_ - w_ / 2);
    if (cell < 0) cell = run(row_ - 1, middle, 0, -1, w_ / 2 + 1);
    if (cell < 0) cell = run(row_ - 2, middle, -1, 0, 2);
    return cell;
  }
  std::int64_t above_right() const { return run(row_ - 1, column_ + w_ - 1, 0, 1, 4); }
  std::int64_t left_top() const { return run(row_, column_ - 1, -1, 0, 3); }
  std::int64_t left_bottom() const { return run(row_ + h_ - 1, column_ - 1, -1, 0, 2); }

 private:
  std::int64_t run(std::int64_t row, std::int64_t column, int down, int right,
                   std::int64_t length) const {
    for (std::int64_t k = 0; k < length; ++k, row += down, column += right) {
      if (state_.surface_at(row, column) != kNoSurface) {
        return row * state_.geometry.columns() + column;
      }
    }
    return -1;
  }

  const FieldState& state_;
  std::int64_t row_, column_, h_, w_;
};

/// Range that a layer starts from when it has no neighbour at all: 15 m.
constexpr std::int64_t kLonelyRange = 15 * kRangeUnit;

}  // namespace

FieldState::FieldState(const Geometry& g, const std::vector<std::uint8_t>& mask,
                       const FieldSettings& field_settings, const Guide* field_guide)
    : geometry(g),
      occupied(mask),
      settings(field_settings),
      guide(field_guide),
      range(g.cells(), 0),
      surface(g.cells(), kNoSurface),
      depth_class(g.cells(), 0) {}

void FieldState::clear() {
  std::fill(surface.begin(), surface.end(), kNoSurface);
  surfaces.clear();
}

void FieldState::forget(const Block& block, std::size_t kept) {
  surfaces.erase(surfaces.begin() + static_cast<std::ptrdiff_t>(kept), surfaces.end());
  for (std::uint32_t i = 0; i < block.height; ++i) {
    const std::size_t begin = cell(block.row + i, block.column);
    std::fill_n(surface.begin() + static_cast<std::ptrdiff_t>(begin), block.width, kNoSurface);
  }
}

const PatchShape& FieldState::shape(const Block& block) {
  const std::array<std::uint32_t, 3> key = {block.row, block.height, block.width};
  const auto found = shapes_.find(key);
  if (found != shapes_.end()) return found->second;
  return shapes_.emplace(key, make_shape(geometry, block)).first->second;
}

Parents FieldState::parents(const Block& block) const {
  const ParentSearch search(*this, block);
  const std::array<std::int64_t, 5> cells = {search.left(), search.above(), search.above_right(),
                                             search.left_top(), search.left_bottom()};
  Parents out;
  std::int64_t sum = 0, known = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] < 0) continue;
    const auto at = static_cast<std::size_t>(cells[k]);
    if (k < 2) {
      sum += range[at];
      ++known;
    }
    const auto end = out.surface.begin() + out.count;
    if (std::find(out.surface.begin(), end, surface[at]) == end) {
      out.surface[out.count++] = surface[at];
    }
  }
  out.range = known == 0 ? kLonelyRange : sum / known;
  return out;
}

std::vector<std::uint32_t> FieldState::cells_of(const Block& block) const {
  std::vector<std::uint32_t> cells;
  for (std::uint32_t i = 0; i < block.height; ++i) {
    const auto begin = static_cast<std::uint32_t>(cell(block.row + i, block.column));
    for (std::uint32_t p = begin; p < begin + block.width; ++p) {
      if (occupied[p]) cells.push_back(p);
    }
  }
  return cells;
}

}  // namespace curlidar::compact
