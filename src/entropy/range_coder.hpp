// SPDX-License-Identifier: BSD-3-Clause
// Binary range coder with carry propagation: 32-bit range, 16-bit probabilities. Integers only.
// (G. N. N. Martin, "Range encoding", 1979; the carry kept in the output instead of a cache.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"

namespace curlidar {

/// Probabilities of a one, in 1/65536, lie in [kMinProbability, 65536 - kMinProbability].
inline constexpr std::uint32_t kMinProbability = 32;

/// Below this the range is widened by a byte.
inline constexpr std::uint32_t kRangeFloor = 1u << 24;

/// Writes bits. Encoder and decoder have the same face, `code(probability_of_one, bit)`, so that
/// every syntax element is written down once for both.
class RangeEncoder {
 public:
  static constexpr bool kDecodes = false;

  bool code(std::uint32_t probability_of_one, bool bit) {
    const std::uint32_t bound = (range_ >> 16) * probability_of_one;
    if (bit) {
      range_ = bound;
    } else {
      const std::uint32_t sum = low_ + bound;
      if (sum < low_) carry();
      low_ = sum;
      range_ -= bound;
    }
    while (range_ < kRangeFloor) {
      bytes_.push_back(static_cast<std::byte>(low_ >> 24));
      low_ <<= 8;
      range_ <<= 8;
    }
    return bit;
  }

  /// Ends the stream with as few bytes as tell the last interval apart, zeros beyond them being
  /// implied, and gives its bytes.
  std::vector<std::byte> finish() &&;

 private:
  void carry() {
    std::size_t i = bytes_.size();
    while (i-- > 0) {
      bytes_[i] = static_cast<std::byte>(static_cast<unsigned>(bytes_[i]) + 1);
      if (bytes_[i] != std::byte{0}) break;
    }
  }

  std::vector<std::byte> bytes_;
  std::uint32_t low_ = 0;
  std::uint32_t range_ = 0xffffffff;
};

/// Reads what RangeEncoder wrote. Past the end it reads zeros: whoever decodes asks `exhausted()`
/// where that matters. Never fails, whatever the bytes.
class RangeDecoder {
 public:
  static constexpr bool kDecodes = true;

  explicit RangeDecoder(ByteSpan bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next();
  }

  bool code(std::uint32_t probability_of_one, bool /*bit*/ = false) {
    const std::uint32_t bound = (range_ >> 16) * probability_of_one;
    const bool bit = value_ < bound;
    if (bit) {
      range_ = bound;
    } else {
      value_ -= bound;
      range_ -= bound;
    }
    while (range_ < kRangeFloor) {
      value_ = value_ << 8 | next();
      range_ <<= 8;
    }
    return bit;
  }

  /// Whether bits were decoded that depend on more than the given bytes and the four bytes of
  /// zeros that the encoder may leave out.
  bool exhausted() const { return position_ > bytes_.size() + 4; }
  /// Whether bits were decoded that depend on more than the given bytes. Of a stream that was cut,
  /// these may be wrong.
  bool past_end() const { return position_ > bytes_.size(); }
  /// Whether nothing that the encoder would have written is left unread.
  bool finished() const { return position_ >= bytes_.size(); }

 private:
  std::uint32_t next() {
    const std::size_t i = position_++;
    return i < bytes_.size() ? static_cast<std::uint32_t>(bytes_[i]) : 0;
  }

  ByteSpan bytes_;
  std::size_t position_ = 0;
  std::uint32_t value_ = 0;
  std::uint32_t range_ = 0xffffffff;
};

}  // namespace curlidar
