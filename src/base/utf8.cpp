// SPDX-License-Identifier: BSD-3-Clause
#include "base/utf8.hpp"

#include <cstddef>
#include <cstdint>

namespace curlidar {
namespace {

/// Length of a sequence and the range its second byte must lie in; length 0 for a bad lead byte.
/// The narrowed ranges are what excludes overlong forms, surrogates and too large code points.
struct Sequence {
  std::size_t length;
  std::uint8_t second_min = 0x80, second_max = 0xbf;
};

Sequence sequence_of(std::uint8_t lead) {
  if (lead < 0x80) return {1};
  if (lead < 0xc2) return {0};
  if (lead < 0xe0) return {2};
  if (lead == 0xe0) return {3, 0xa0, 0xbf};
  if (lead == 0xed) return {3, 0x80, 0x9f};
  if (lead < 0xf0) return {3};
  if (lead == 0xf0) return {4, 0x90, 0xbf};
  if (lead < 0xf4) return {4};
  if (lead == 0xf4) return {4, 0x80, 0x8f};
  return {0};
}

}  // namespace

bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const Sequence sequence = sequence_of(byte(i));
    if (sequence.length == 0 || sequence.length > text.size() - i) return false;
    for (std::size_t k = 1; k < sequence.length; ++k) {
      const std::uint8_t low = k == 1 ? sequence.second_min : std::uint8_t{0x80};
      const std::uint8_t high = k == 1 ? sequence.second_max : std::uint8_t{0xbf};
      if (byte(i + k) < low || byte(i + k) > high) return false;
    }
    i += sequence.length;
  }
  return true;
}

}  // namespace curlidar
