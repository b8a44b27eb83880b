// SPDX-License-Identifier: BSD-3-Clause
// How the targets of fuzzing read what they are given. A target takes any bytes and says which
// promise of the library they broke; empty if none. The same targets run under libFuzzer (fuzz/)
// and over the corpus that is kept (corpus_test.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"

namespace curlidar::test {

/// Numbers from the front of an input, 0 behind its end.
class FuzzInput {
 public:
  explicit FuzzInput(ByteSpan bytes) : bytes_(bytes) {}

  std::uint32_t byte() {
    if (bytes_.empty()) return 0;
    const auto value = static_cast<std::uint32_t>(bytes_.front());
    bytes_ = bytes_.subspan(1);
    return value;
  }
  std::uint32_t two_bytes() {
    const std::uint32_t low = byte();
    return low | byte() << 8;
  }
  std::uint32_t three_bytes() {
    const std::uint32_t low = two_bytes();
    return low | byte() << 16;
  }
  bool empty() const { return bytes_.empty(); }
  /// The next `size` bytes, or fewer at the end.
  ByteSpan take(std::size_t size) {
    const ByteSpan taken = bytes_.first(size < bytes_.size() ? size : bytes_.size());
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  ByteSpan rest() { return take(bytes_.size()); }

 private:
  ByteSpan bytes_;
};

/// Ways to fill a plane of flags: all set, from the input, about half, few.
enum class Fill : std::uint8_t { all, input, half, few };

inline std::uint32_t mixed(std::size_t number) {
  std::uint32_t x = static_cast<std::uint32_t>(number) * 0x9e3779b9u;
  x = (x ^ (x >> 15)) * 0x85ebca6bu;
  return x ^ (x >> 13);
}

inline std::vector<std::uint8_t> fill_flags(FuzzInput& input, std::size_t count, Fill fill) {
  std::vector<std::uint8_t> flags(count, 1);
  const ByteSpan bits = input.take(fill == Fill::input ? (count + 7) / 8 : 0);
  for (std::size_t i = 0; fill != Fill::all && i < count; ++i) {
    const std::uint32_t bit =
        fill == Fill::input
            ? (i / 8 < bits.size() ? static_cast<std::uint32_t>(bits[i / 8]) >> (i % 8) & 1u : 0u)
            : (mixed(i) % (fill == Fill::half ? 2 : 16) == 0 ? 1u : 0u);
    flags[i] = static_cast<std::uint8_t>(bit);
  }
  return flags;
}

}  // namespace curlidar::test
