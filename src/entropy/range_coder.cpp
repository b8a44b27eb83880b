// SPDX-License-Identifier: BSD-3-Clause
#include "entropy/range_coder.hpp"

namespace curlidar {

std::vector<std::byte> RangeEncoder::finish() && {
  // Any value in [low, low + range) decodes; take the one with the most zero bits at its end.
  for (int zeros = 32; zeros-- > 0;) {
    const std::uint64_t mask = (std::uint64_t{1} << zeros) - 1;
    const std::uint64_t value = (low_ + mask) & ~mask;
    if (value - low_ >= range_) continue;
    if (value >> 32 != 0) carry();
    low_ = static_cast<std::uint32_t>(value);
    break;
  }
  const std::size_t written = bytes_.size();
  for (int i = 0; i < 4; ++i) {
    bytes_.push_back(static_cast<std::byte>(low_ >> 24));
    low_ <<= 8;
  }
  // Zeros written earlier stay: RangeDecoder::exhausted() counts on at most four left out.
  while (bytes_.size() > written && bytes_.back() == std::byte{0}) bytes_.pop_back();
  return std::move(bytes_);
}

}  // namespace curlidar
