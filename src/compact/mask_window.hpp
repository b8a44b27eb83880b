// SPDX-License-Identifier: BSD-3-Clause
// The cells around the one being coded that encoder and decoder both know.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compact/mask_coder.hpp"

namespace curlidar::compact {

/// Known cells as bits. In `above`, `second` and `third` (one, two, three rows up) bit 16 - k is
/// the cell k columns to the right, k from -15 to 16.
struct MaskWindow {
  std::uint32_t left = 0;  ///< bit k is the cell k + 1 columns to the left
  std::uint32_t above = 0, second = 0, third = 0;
  std::uint32_t up = 0;  ///< bit k is the cell k + 1 rows up, in the same column

  std::uint32_t left_at(std::uint32_t k) const { return left >> (k - 1) & 1; }
  /// Cells `from` .. `to` columns to the right of a row up; bit 0 is the rightmost.
  static std::uint32_t cut(std::uint32_t row, int from, int to) {
    return row >> (16 - to) & ((1u << (to - from + 1)) - 1);
  }
  static std::uint32_t at(std::uint32_t row, int k) { return row >> (16 - k) & 1; }
};

/// Moves a window over a segment, row by row, from left to right.
///
/// Rows above the segment are empty. Beside a segment that closes on itself lie its own columns
/// from the other side, beside any other its outermost cells again. What lies to the left of the
/// first cell of a row is taken from the row above.
class MaskScan {
 public:
  explicit MaskScan(const MaskShape& shape)
      : columns_(shape.columns),
        closed_(shape.columns == shape.turn_columns),
        stride_(shape.columns + kLeft + kRight),
        rows_(4 * stride_, 0),
        up_(shape.columns, 0) {}

  const MaskWindow& window() const { return window_; }

  void begin_row() {
    std::uint8_t* last = row(3);
    for (std::size_t k = 0; k < kLeft; ++k) {
      const std::size_t j = closed_ ? columns_ - 1 - k % columns_ : 0;
      last[kLeft - 1 - k] = last[kLeft + j];
    }
    for (std::size_t k = 0; k < kRight; ++k) {
      last[kLeft + columns_ + k] = last[kLeft + (closed_ ? k % columns_ : columns_ - 1)];
    }
    newest_ = (newest_ + 1) % 4;
    at_ = 0;
    window_ = MaskWindow{};
    for (std::size_t k = 0; k < kLeft; ++k) window_.left = window_.left << 1 | row(2)[k];
    for (std::size_t k = 0; k < kLeft + kRight; ++k) shift_in(k);
  }
  /// Steps to the next cell of the row; the first is the first.
  void begin_cell() {
    shift_in(at_ + kLeft + kRight);
    window_.up = up_[at_];
  }
  void end_cell(bool occupied) {
    row(3)[kLeft + at_] = occupied;
    window_.left = window_.left << 1 | static_cast<std::uint32_t>(occupied);
    up_[at_] = window_.up << 1 | static_cast<std::uint32_t>(occupied);
    ++at_;
  }

 private:
  static constexpr std::size_t kLeft = 32, kRight = 16;

  /// Row 3 is the newest, row 0 the oldest of four.
  std::uint8_t* row(std::size_t age) { return rows_.data() + (newest_ + age + 1) % 4 * stride_; }
  void shift_in(std::size_t k) {
    window_.above = window_.above << 1 | row(2)[k];
    window_.second = window_.second << 1 | row(1)[k];
    window_.third = window_.third << 1 | row(0)[k];
  }

  std::size_t columns_;
  bool closed_;
  std::size_t stride_;
  std::vector<std::uint8_t> rows_;
  std::vector<std::uint32_t> up_;
  std::size_t newest_ = 0, at_ = 0;
  MaskWindow window_;
};

}  // namespace curlidar::compact
