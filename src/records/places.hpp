// SPDX-License-Identifier: BSD-3-Clause
// The places of a walk: each visited once, records among them counted and found by rank.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curlidar {

/// Places 0 .. size - 1 in a circle, some of which hold records. A place is open until it is
/// closed; a record is left until its place is closed.
class Places {
 public:
  /// `holds[place]`: not 0 if it holds a record.
  explicit Places(const std::vector<std::uint8_t>& holds)
      : next_(holds.size() + 1), count_(holds.size() + 1) {
    for (std::size_t i = 0; i < next_.size(); ++i) next_[i] = static_cast<std::uint32_t>(i);
    for (std::size_t i = 1; i < count_.size(); ++i) {
      count_[i] += holds[i - 1] != 0 ? 1 : 0;
      left_ += holds[i - 1] != 0 ? 1 : 0;
      const std::size_t parent = i + (i & (~i + 1));
      if (parent < count_.size()) count_[parent] += count_[i];
    }
  }

  std::size_t size() const { return next_.size() - 1; }
  /// Records left.
  std::size_t left() const { return left_; }

  /// The first open place from `place` on; size() if none.
  std::size_t first_open(std::size_t place) {
    while (next_[place] != place) {
      next_[place] = next_[next_[place]];
      place = next_[place];
    }
    return place;
  }
  /// The same round the circle.
  std::size_t open_from(std::size_t place) {
    const std::size_t found = first_open(place);
    return found < size() ? found : first_open(0);
  }
  /// Closes an open place without a record.
  void close(std::size_t place) { next_[place] = static_cast<std::uint32_t>(place + 1); }
  /// Closes an open place that holds a record.
  void take(std::size_t place) {
    close(place);
    --left_;
    for (std::size_t i = place + 1; i < count_.size(); i += i & (~i + 1)) --count_[i];
  }

  /// Records left before a place. O(log size).
  std::size_t rank(std::size_t place) const {
    std::size_t sum = 0;
    for (std::size_t i = place; i > 0; i &= i - 1) sum += count_[i];
    return sum;
  }
  /// The place of the record left with that rank. O(log size).
  std::size_t select(std::size_t rank) const {
    std::size_t at = 0;
    for (std::size_t step = std::bit_floor(size()); step > 0; step /= 2) {
      if (at + step < count_.size() && count_[at + step] <= rank) {
        at += step;
        rank -= count_[at];
      }
    }
    return at;
  }

 private:
  std::vector<std::uint32_t> next_;   ///< itself where open; else leads towards the next open one
  std::vector<std::uint32_t> count_;  ///< Fenwick tree of the records left
  std::size_t left_ = 0;
};

}  // namespace curlidar
