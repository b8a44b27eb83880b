// SPDX-License-Identifier: BSD-3-Clause
// Which cells hold a return, as a bilevel image coder would write it: an adaptive binary range
// coder (the carry-free kind of Schindler's, 32-bit range) under a context of ten neighbours.
#include <array>

#include "peers.hpp"

namespace curlidar::bench {
namespace {

constexpr std::uint32_t kHalf = 1u << 15;

/// Probability of a 1 in 2^-16: the mean of a fast and a slow estimate, so that contexts seen
/// rarely learn quickly and those seen often become precise.
class Bit {
 public:
  std::uint32_t p1() const { return (fast_ + slow_) >> 1; }
  void update(bool bit) {
    adapt(fast_, bit, 4);
    adapt(slow_, bit, seen_ < 7 ? seen_ / 2 + 2 : 7);
    if (seen_ < 255) ++seen_;
  }

 private:
  static void adapt(std::uint32_t& p, bool bit, std::uint32_t rate) {
    const std::uint32_t target = bit ? 65535 - 64 : 64;
    p = target > p ? p + ((target - p) >> rate) : p - ((p - target) >> rate);
  }
  std::uint32_t fast_ = kHalf, slow_ = kHalf, seen_ = 0;
};

/// Bit by bit, encoder and decoder alike: low and range as in the LZMA coder.
class Encoder {
 public:
  void code(std::uint32_t p1, bool bit) {
    const std::uint32_t bound = static_cast<std::uint32_t>((std::uint64_t{range_} * p1) >> 16);
    if (bit) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    while (range_ < (1u << 24)) {
      shift();
      range_ <<= 8;
    }
  }
  Bytes finish() {
    for (int i = 0; i < 5; ++i) shift();
    while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
    return std::move(bytes_);
  }

 private:
  void put(std::uint64_t value) { bytes_.push_back(static_cast<std::byte>(value & 0xff)); }
  void shift() {
    if (low_ < 0xff000000u || low_ > 0xffffffffu) {
      const std::uint64_t carry = low_ >> 32;
      if (started_) put(cache_ + carry);
      for (; pending_ > 0; --pending_) put(0xff + carry);
      cache_ = (low_ >> 24) & 0xff;
      started_ = true;
    } else {
      ++pending_;
    }
    low_ = (low_ & 0x00ffffff) << 8;
  }
  std::uint64_t low_ = 0, cache_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  std::size_t pending_ = 0;
  bool started_ = false;
  Bytes bytes_;
};

class Decoder {
 public:
  explicit Decoder(const Bytes& bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
  }
  bool code(std::uint32_t p1) {
    const std::uint32_t bound = static_cast<std::uint32_t>((std::uint64_t{range_} * p1) >> 16);
    const bool bit = code_ < bound;
    if (bit) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    while (range_ < (1u << 24)) {
      code_ = code_ << 8 | next();
      range_ <<= 8;
    }
    return bit;
  }

 private:
  // Zeros at the end of the stream are not written.
  std::uint32_t next() {
    return at_ < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[at_++]) : 0;
  }
  const Bytes& bytes_;
  std::size_t at_ = 0;
  std::uint32_t code_ = 0, range_ = 0xffffffffu;
};

struct Offset {
  int row, column;
};
// More neighbours cost more on the scans we have: a mask is too small to fill their contexts.
constexpr std::array<Offset, 10> kTemplate = {
    {{0, -1}, {0, -2}, {0, -3}, {-1, -2}, {-1, -1}, {-1, 0}, {-1, 1}, {-1, 2}, {-2, 0}, {-2, 1}}};
constexpr std::size_t kContexts = 1u << kTemplate.size();

/// The known neighbours of a cell as a number; the turn closes, rows above the first are empty.
std::size_t context(const Mask& mask, std::size_t i, std::size_t j) {
  std::size_t bits = 0;
  const std::size_t here = i * mask.columns + j;
  for (const Offset& o : kTemplate) {
    bits <<= 1;
    const auto row = static_cast<std::ptrdiff_t>(i) + o.row;
    if (row < 0) continue;
    const auto width = static_cast<std::ptrdiff_t>(mask.columns);
    const auto column = (static_cast<std::ptrdiff_t>(j) + o.column + width) % width;
    const auto at = static_cast<std::size_t>(row * width + column);
    if (at < here) bits |= mask.occupied[at];
  }
  return bits;
}

}  // namespace

Bytes pack_mask(const Mask& mask) {
  std::vector<Bit> model(kContexts);
  Encoder encoder;
  for (std::size_t i = 0; i < mask.rows; ++i) {
    for (std::size_t j = 0; j < mask.columns; ++j) {
      Bit& bit = model[context(mask, i, j)];
      const bool value = mask.occupied[i * mask.columns + j] != 0;
      encoder.code(bit.p1(), value);
      bit.update(value);
    }
  }
  return encoder.finish();
}

Mask unpack_mask(const Bytes& bytes, std::size_t rows, std::size_t columns) {
  std::vector<Bit> model(kContexts);
  Mask mask{rows, columns, std::vector<std::uint8_t>(rows * columns, 0)};
  Decoder decoder(bytes);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      Bit& bit = model[context(mask, i, j)];
      const bool value = decoder.code(bit.p1());
      mask.occupied[i * columns + j] = value ? 1 : 0;
      bit.update(value);
    }
  }
  return mask;
}

}  // namespace curlidar::bench
