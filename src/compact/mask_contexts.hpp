// SPDX-License-Identifier: BSD-3-Clause
// What a mask's models look at. The numbers are part of the format.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "compact/mask_window.hpp"

namespace curlidar::compact {

inline constexpr std::size_t kMaskModels = 8;       ///< predictions by adaptive contexts
inline constexpr std::size_t kMaskContexts = 1024;  ///< of each of them
inline constexpr std::size_t kMaskCells = 40;       ///< single cells that take part in the mix
inline constexpr std::size_t kMaskInputs = kMaskModels + kMaskCells;
inline constexpr std::array<std::size_t, 3> kMaskWeightSets = {32, 64, 32};

namespace mask_detail {

/// Classes of how many cells in a row are alike.
inline constexpr std::array<std::uint8_t, 17> kRunClass = {0, 1, 2, 3, 4, 4, 5, 5, 5,
                                                           6, 6, 6, 6, 6, 6, 6, 7};
/// The same with finer steps at greater lengths.
inline constexpr std::array<std::uint8_t, 17> kReachClass = {0, 1, 2, 3, 4, 4, 4, 5, 5,
                                                             5, 5, 6, 6, 6, 6, 6, 7};

inline std::uint32_t count(std::uint32_t bits) {
  return static_cast<std::uint32_t>(std::popcount(bits));
}
inline std::uint32_t changes(std::uint32_t bits) {
  return bits ^ (bits >> 1);
}
/// How many cells follow bit 0 that are like it, at most 16.
inline std::uint32_t run_of(std::uint32_t bits) {
  return static_cast<std::uint32_t>(std::countr_zero(changes(bits) | 1u << 16));
}
/// How many cells to the right of the middle of a row up are like it, at most 16.
inline std::uint32_t reach_of(std::uint32_t row) {
  const std::uint32_t from_middle = row << 15;
  const std::uint32_t unlike = (from_middle >> 31 != 0 ? ~from_middle : from_middle) | 1u << 14;
  return static_cast<std::uint32_t>(std::countl_zero(unlike)) - 1;
}

}  // namespace mask_detail

/// What several contexts share.
struct MaskFeatures {
  std::uint32_t left, here, second;  ///< nearest cells: W, N, NN
  std::uint32_t left_run, up_run;    ///< lengths of the runs that W and N end
  std::uint32_t above_changes, left_changes;

  explicit MaskFeatures(const MaskWindow& w)
      : left(w.left & 1),
        here(MaskWindow::at(w.above, 0)),
        second(MaskWindow::at(w.second, 0)),
        left_run(mask_detail::run_of(w.left)),
        up_run(mask_detail::run_of(w.up)),
        above_changes(mask_detail::count(mask_detail::changes(w.above) >> 10 & 0xfff)),
        left_changes(mask_detail::count(mask_detail::changes(w.left) & 0xff)) {}
};

/// The context of each model, below kMaskContexts.
inline std::array<std::uint32_t, kMaskModels> mask_contexts(const MaskWindow& w,
                                                            const MaskFeatures& f) {
  using namespace mask_detail;
  using W = MaskWindow;
  const std::uint32_t above_reach = reach_of(w.above), second_reach = reach_of(w.second);
  const std::uint32_t next = W::at(w.above, 1), before = W::at(w.above, -1);
  const std::uint32_t beside = f.left + before + f.here + next;
  const std::uint32_t near = count(w.left >> 1 & 3) + W::at(w.above, -2) +
                             count(W::cut(w.above, 2, 3)) + count(W::cut(w.second, -1, 1));
  const std::uint32_t far = count(W::cut(w.second, -5, -2)) + count(W::cut(w.second, 2, 5)) +
                            count(W::cut(w.third, -3, 3));
  return {
      kRunClass[f.left_run] | f.left << 3 | kRunClass[f.up_run] << 4 | f.here << 7 | next << 8 |
          f.second << 9,
      kRunClass[above_reach] | f.here << 3 | kRunClass[f.left_run] << 4 | f.left << 7 |
          f.second << 8 | W::at(w.second, 1) << 9,
      std::min(f.above_changes, 7u) | std::min(f.left_changes, 3u) << 3 |
          std::min(count(W::cut(w.above ^ w.second, -4, 4)), 7u) << 5 | f.left << 8 | f.here << 9,
      W::cut(w.second, -2, 3) | W::cut(w.above, 0, 1) << 6 | (w.left & 3) << 8,
      kReachClass[above_reach] | kReachClass[second_reach] << 3 | f.here << 6 | f.second << 7 |
          f.left << 8 | std::min(f.left_run, 1u) << 9,
      count(w.left) * 7 / 32 | (count(w.above) * 7 / 32) << 3 | (count(w.second) * 3 / 32) << 6 |
          f.left << 8 | f.here << 9,
      (w.up & 0x7f) | f.left << 7 | next << 8 | before << 9,
      beside | near << 3 | std::min(far / 4, 3u) << 7 | f.left << 9,
  };
}

/// The weight set that each part of the mix takes. `scale` is mask_scale() of the turn's columns.
inline std::array<std::uint32_t, 3> mask_weight_sets(const MaskWindow& w, const MaskFeatures& f,
                                                     std::uint32_t scale) {
  const std::uint32_t up_class = f.up_run < 2 ? f.up_run : f.up_run < 5 ? 2 : 3;
  return {
      f.left | MaskWindow::cut(w.above, -1, 1) << 1 | f.second << 4,
      std::min(f.above_changes, 3u) | std::min(f.left_changes, 3u) << 2 | f.left << 4 | f.here << 5,
      scale | up_class << 2 | (f.here ^ f.left) << 4,
  };
}

/// How fine a turn's columns are: under 700, 1400, 2800, or more.
inline std::uint32_t mask_scale(std::size_t turn_columns) {
  return turn_columns < 700 ? 0 : turn_columns < 1400 ? 1 : turn_columns < 2800 ? 2 : 3;
}

/// The single cells of the mix, kMaskCells of them from bit 0 on; the last is always set.
inline std::uint64_t mask_cells(const MaskWindow& w) {
  using W = MaskWindow;
  return (w.left & 0xff) | std::uint64_t{W::cut(w.above, -6, 6)} << 8 |
         std::uint64_t{W::cut(w.second, -4, 4)} << 21 |
         std::uint64_t{W::cut(w.third, -3, 3)} << 30 | std::uint64_t{w.up >> 3 & 3} << 37 |
         std::uint64_t{1} << 39;
}

}  // namespace curlidar::compact
