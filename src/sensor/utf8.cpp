// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/utf8.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace curlidar {
namespace {

/// Reads the character at the front of `text` and removes it; nothing if it is malformed.
std::optional<std::uint32_t> take_character(std::string_view& text) {
  const auto first = static_cast<unsigned char>(text[0]);
  std::size_t length = 1;
  std::uint32_t value = first, smallest = 0;
  if (first >= 0x80) {
    if (first < 0xc0 || first >= 0xf8) return std::nullopt;
    length = first < 0xe0 ? 2 : (first < 0xf0 ? 3 : 4);
    smallest = length == 2 ? 0x80 : (length == 3 ? 0x800 : 0x10000);
    value = first & (0x7fu >> length);
  }
  if (text.size() < length) return std::nullopt;
  for (std::size_t i = 1; i < length; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xc0) != 0x80) return std::nullopt;
    value = (value << 6) | (next & 0x3fu);
  }
  const bool surrogate = value >= 0xd800 && value < 0xe000;
  if (value < smallest || value > 0x10ffff || surrogate) return std::nullopt;
  text.remove_prefix(length);
  return value;
}

}  // namespace

std::optional<std::string> escape_non_ascii(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const auto character = take_character(text);
    if (!character) return std::nullopt;
    if (*character < 0x80) {
      out.push_back(static_cast<char>(*character));
    } else if (*character < 0x10000) {
      out += fmt::format("\\u{:04X}", *character);
    } else {
      out += fmt::format("\\U{:08X}", *character);
    }
  }
  return out;
}

}  // namespace curlidar
