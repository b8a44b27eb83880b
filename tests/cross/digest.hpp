// SPDX-License-Identifier: BSD-3-Clause
// Digests of what a program computed, printed as lines that two builds of it can compare.
#pragma once

#include <bit>
#include <cinttypes>
#include <cstdint>
#include <cstdio>

#include "base/bytes.hpp"

namespace curlidar::test {

/// FNV-1a, 64 bits, of numbers as their eight little-endian bytes.
class Digest {
 public:
  void add(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) add_byte(static_cast<std::uint8_t>((value >> (8 * i)) & 0xff));
  }
  void add(std::int64_t value) { add(static_cast<std::uint64_t>(value)); }
  void add(std::int32_t value) { add(static_cast<std::int64_t>(value)); }
  void add(std::uint32_t value) { add(static_cast<std::uint64_t>(value)); }
  /// The bits of the number, so that -0 and 0 differ.
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(ByteSpan bytes) {
    add(static_cast<std::uint64_t>(bytes.size()));
    for (const std::byte b : bytes) add_byte(static_cast<std::uint8_t>(b));
  }
  void print(const char* name) const { std::printf("%s %016" PRIx64 "\n", name, state_); }

 private:
  void add_byte(std::uint8_t byte) { state_ = (state_ ^ byte) * 0x100000001b3u; }

  std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// Numbers without a pattern, of all sizes (D. Knuth's linear congruence, high bits first).
class Numbers {
 public:
  std::uint32_t next32() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>(state_ >> 32);
  }
  std::uint64_t next64() {
    const std::uint64_t high = next32();
    return high << 32 | next32();
  }
  /// Of up to 64 bits, every length as likely.
  std::int64_t next_of_any_size() {
    const auto wide = static_cast<std::int64_t>(next64());
    return wide >> (next32() % 64);
  }

 private:
  std::uint64_t state_ = 1;
};

}  // namespace curlidar::test
