// SPDX-License-Identifier: BSD-3-Clause
// The syntax of a tile, written down once for range encoder, range decoder and cost counters.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "map/tile_models.hpp"
#include "map/tile_state.hpp"

namespace curlidar::tile {

inline constexpr std::int32_t kMaxValue = 1 << 15;

/// Which of the numbers of a leaf.
enum class TileValue : std::uint32_t {
  height_corrected,
  height_new,
  slope_corrected,
  slope_new,
  curve,
  intensity,
  height_with_slope
};

template <class Sink>
bool code_occupied(Sink& sink, const CubeContext& c, std::uint32_t siblings, bool occupied) {
  const std::uint32_t l = c.cube.level;
  const std::uint32_t best = c.crossing[0];
  return sink.bit(
      {kOccupied,
       {(l * 64 + c.around) * 3 + best, (l * 64 + c.around) * 4 + c.contact, l * 27 + c.crossings(),
        (l * 8 + siblings) * 12 + best * 4 + c.contact, l * 64 + c.around},
       l},
      occupied);
}

template <class Sink>
bool code_split(Sink& sink, const CubeContext& c, bool split) {
  const std::uint32_t l = c.cube.level;
  return sink.bit(
      {kSplitCube,
       {(l * 3 + c.finer) * 3 + c.crossing[0], l * 27 + c.crossings(), l * 64 + c.around,
        l * 16 + c.contact * 4 + c.count, (l * 3 + c.finer) * 4 + c.contact},
       l},
      split);
}

/// A number of steps, with its sign. `energy`: class of the numbers of the leaf before it, 0..3.
template <class Sink>
std::int32_t code_value(Sink& sink, TileValue what, std::uint32_t level, std::uint32_t crossing,
                        std::uint32_t energy, std::int32_t value) {
  const auto w = static_cast<std::uint32_t>(what);
  const std::uint32_t wl = w * 6 + level;
  if (!sink.bit({kValueZero, {wl, wl * 3 + crossing, w, wl * 4 + energy, w}, w}, value != 0))
    return 0;
  const bool negative = sink.bit({kValueSign, {w, wl, w * 3 + crossing, w, w}, 0}, value < 0);
  const auto target = static_cast<std::uint32_t>(std::abs(value)) - (value != 0);
  const auto target_size = static_cast<std::uint32_t>(std::bit_width(target));
  std::uint32_t size = 0;
  for (; size < 16; ++size) {
    if (!sink.bit(
            {kValueClass,
             {w * 24 + size, wl * 24 + size, w * 24 + size, (w * 4 + energy) * 24 + size, size},
             size == 0 ? 0u : 1u},
            target_size > size)) {
      break;
    }
  }
  std::uint32_t magnitude = size > 0 ? 1 : 0;
  for (std::uint32_t place = size > 0 ? size - 1 : 0; place-- > 0;) {
    const bool bit = (target >> place & 1) != 0;
    const bool coded =
        place + 2 == size
            ? sink.bit({kValueBits, {w * 24 + size, w * 24 + size, size, size, w * 24 + size}, 0},
                       bit)
            : sink.plain(bit);
    magnitude = magnitude << 1 | (coded ? 1 : 0);
  }
  const std::int32_t found = std::min(static_cast<std::int32_t>(magnitude + 1), kMaxValue);
  return negative ? -found : found;
}

/// Which plane a leaf starts from.
template <class Sink>
void code_candidate(Sink& sink, const CubeContext& c, TileLeafCode& leaf) {
  const std::uint32_t l = c.cube.level;
  bool fresh = true;
  if (c.count > 0) {
    fresh = sink.bit(
        {kNewPlane,
         {l * 4 + c.crossing[0] + (c.crossing[0] > 0 && c.contact == 3 ? 1u : 0u),
          l * 27 + c.crossings(), l * 12 + c.contact * 3 + c.finer, c.around, l * 3 + c.count - 1},
         c.crossing[0]},
        leaf.candidate == 0);
  }
  if (fresh) {
    leaf.candidate = 0;
    const bool upright = sink.bit({kAxis, {0, l, c.around, 0, 0}, 0}, leaf.axis != 2);
    if (!upright) {
      leaf.axis = 2;
    } else {
      leaf.axis = sink.bit({kAxis, {1, 6 + l, 64 + c.around, 1, 1}, 1}, leaf.axis == 1) ? 1 : 0;
    }
    return;
  }
  std::uint32_t k = 1;
  for (; k < c.count; ++k) {
    if (sink.bit({kCandidate,
                  {l * 3 + c.crossing[k - 1], l * 9 + c.crossing[k - 1] * 3 + c.crossing[k],
                   (k - 1) * 27 + c.crossings(), l * 4 + c.contact, k - 1},
                  k - 1},
                 leaf.candidate == k)) {
      break;
    }
  }
  leaf.candidate = k;
}

template <class Sink>
void code_numbers(Sink& sink, const CubeContext& c, const TileLayout& layout, TileLeafCode& leaf) {
  const std::uint32_t l = c.cube.level;
  const bool fresh = leaf.candidate == 0;
  const std::uint32_t crossing = fresh ? 0 : c.crossing[leaf.candidate - 1];
  // The height of a plane of its own is always told.
  std::uint32_t terms = fresh ? 1 : 0;
  for (; terms < 2; ++terms) {
    const std::uint32_t k = (fresh ? 2 : 0) + terms;
    const std::uint32_t lk = l * 4 + k;
    if (!sink.bit({kTerms,
                   {lk, lk * 3 + crossing, lk * 4 + c.contact, k * 3 + c.finer, lk * 3 + c.finer},
                   k},
                  terms == 0 ? leaf.terms > 0 : leaf.terms > 1)) {
      break;
    }
  }
  leaf.terms = terms == 2 ? 3 : terms;
  std::uint32_t energy = 0;
  const auto number = [&](TileValue what, std::int32_t value) {
    const std::int32_t found = code_value(sink, what, l, crossing, energy, value);
    energy = std::min(energy + std::min(static_cast<std::uint32_t>(std::abs(found)), 3u), 3u);
    return found;
  };
  for (std::size_t k = 0; k < leaf.terms; ++k) {
    const TileValue what = k == 0  ? fresh            ? TileValue::height_new
                                     : leaf.terms > 1 ? TileValue::height_with_slope
                                                      : TileValue::height_corrected
                           : fresh ? TileValue::slope_new
                                   : TileValue::slope_corrected;
    leaf.q[k] = number(what, leaf.q[k]);
  }
  for (std::size_t k = leaf.terms; k < 3; ++k) leaf.q[k] = 0;
  if (layout.curves) {
    leaf.curved =
        sink.bit({kCurved, {l, l * 2 + (fresh ? 1 : 0), l, l * 3 + crossing, l}, 0}, leaf.curved);
    energy = 0;
    for (std::int32_t& curve : leaf.curve) {
      curve = leaf.curved ? number(TileValue::curve, curve) : 0;
    }
  }
  if (layout.intensity) {
    const std::int32_t off =
        code_value(sink, TileValue::intensity, l, crossing, 0,
                   std::clamp(leaf.intensity - c.intensity, -kMaxValue, kMaxValue));
    leaf.intensity = std::clamp(c.intensity + off, -kMaxValue, kMaxValue);
  }
}

/// A walk over the cells of a leaf's footprint, row by row along u: which may be set, and what
/// tells about the next one.
class CellWalk {
 public:
  CellWalk(const TileState& state, const CubeContext& c, const TileLeafCode& leaf,
           const TilePlane& plane)
      : c_(c),
        plane_(plane),
        m_(state.layout().cells(c.cube.level)),
        kind_(leaf.candidate == 0 ? 0
              : leaf.terms > 0    ? 1
                                  : 2),
        open_(state.open_cells(c, plane)),
        around_(state.surroundings(c, plane)) {
    std::uint32_t known = 0, seen = 0;
    for (std::uint32_t i = 0; i < m_ + 2; ++i) {
      for (std::uint32_t j = 0; j < m_ + 2; ++j) {
        if (i > 0 && i <= m_ && j > 0 && j <= m_) continue;
        known += at(i, j) == 2 ? 0 : 1;
        seen += at(i, j) == 1 ? 1 : 0;
      }
    }
    border_ = known == 0 ? 5 : std::min(5 * seen / known, 4u);
  }

  bool open(std::size_t k) const { return open_[k] != 0; }
  const std::vector<std::uint8_t>& all_open() const { return open_; }

  TileContexts full() const {
    const std::uint32_t l = c_.cube.level, b = std::min(border_, 4u);
    return {kFull,
            {l * 3 + kind_, l * 16 + b * 3 + kind_, l * 27 + c_.crossings(), l * 5 + b,
             l * 6 + border_},
            l};
  }

  TileContexts contexts(std::size_t k) const {
    const auto i = static_cast<std::uint32_t>(k) / m_ + 1,
               j = static_cast<std::uint32_t>(k) % m_ + 1;
    const std::uint32_t w = at(i, j - 1), n = at(i - 1, j);
    const std::uint32_t e = j == m_ ? at(i, j + 1) : 2, s = i == m_ ? at(i + 1, j) : 2;
    const std::uint32_t ww = j > 1 ? at(i, j - 2) : 2, nn = i > 1 ? at(i - 2, j) : 2;
    const std::uint32_t near = w + 4 * n + 16 * at(i - 1, j - 1) + 64 * at(i - 1, j + 1);
    const std::uint32_t wn = w + 4 * n;
    const std::uint32_t seen = asked_ == 0 ? 16 : std::min(set_ * 16 / asked_, 15u);
    const auto some = [](std::uint32_t state) { return std::min(state, 2u); };
    return {
        kCell,
        {near * 3 + std::min(c_.cube.level, 2u),
         near * 6 + std::min(static_cast<std::uint32_t>(std::bit_width(m_)), 5u),
         (wn + 16 * e + 64 * s) * 2 + (plane_.axis == 2 ? 1 : 0),
         (wn * 8 + reach(i - 1, j - 1)) * 3 + kind_, (wn + 16 * std::min(ww + nn, 3u)) * 17 + seen},
        (some(w) * 3 + some(n)) * 3 + kind_};
  }

  void set(std::size_t k, bool on) {
    const std::size_t i = k / m_ + 1, j = k % m_ + 1;
    around_[i * (m_ + 2) + j] = on ? 1 : 0;
    ++asked_;
    set_ += on ? 1 : 0;
  }

 private:
  std::uint32_t at(std::uint32_t i, std::uint32_t j) const {
    return around_[std::size_t{i} * (m_ + 2) + j];
  }

  /// Class of how far from the cube's middle the plane is at a cell.
  std::uint32_t reach(std::uint32_t i, std::uint32_t j) const {
    const std::int32_t cell = 2 * c_.half / static_cast<std::int32_t>(m_);
    const std::int32_t u = c_.centre[u_axis(plane_.axis)] - c_.half + cell / 2;
    const std::int32_t v = c_.centre[v_axis(plane_.axis)] - c_.half + cell / 2;
    const std::int64_t height =
        plane_.at(u + static_cast<std::int32_t>(i) * cell, v + static_cast<std::int32_t>(j) * cell);
    return static_cast<std::uint32_t>(
        std::min<std::int64_t>(std::abs(height - c_.centre[plane_.axis]) * 6 / c_.half, 7));
  }

  const CubeContext& c_;
  const TilePlane& plane_;
  std::uint32_t m_ = 1, kind_ = 0, border_ = 5, asked_ = 0, set_ = 0;
  std::vector<std::uint8_t> open_, around_;
};

template <class Sink>
void code_footprint(Sink& sink, const TileState& state, const CubeContext& c, TileLeafCode& leaf) {
  const std::uint32_t m = state.layout().cells(c.cube.level);
  leaf.footprint.resize(std::size_t{m} * m);
  if (m == 1) {
    leaf.footprint[0] = 1;
    return;
  }
  const TilePlane plane = state.plane_of(c, leaf);
  CellWalk walk(state, c, leaf, plane);
  if (sink.bit(walk.full(), leaf.footprint == walk.all_open())) {
    leaf.footprint = walk.all_open();
    return;
  }
  for (std::size_t k = 0; k < leaf.footprint.size(); ++k) {
    const bool on = walk.open(k) && sink.bit(walk.contexts(k), leaf.footprint[k] != 0);
    leaf.footprint[k] = on ? 1 : 0;
    if (walk.open(k)) walk.set(k, on);
  }
}

template <class Sink>
void code_leaf(Sink& sink, const TileState& state, const CubeContext& c, TileLeafCode& leaf) {
  code_candidate(sink, c, leaf);
  code_numbers(sink, c, state.layout(), leaf);
  code_footprint(sink, state, c, leaf);
}

}  // namespace curlidar::tile
