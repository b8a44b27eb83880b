// SPDX-License-Identifier: BSD-3-Clause
#include "io/notes.hpp"

#include <fmt/format.h>

#include <charconv>

#include "io/text.hpp"

namespace curlidar::io {
namespace {

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte == 0x7f || c == '%') {
      out += fmt::format("%{:02X}", byte);
    } else {
      out += c;
    }
  }
  return out;
}

std::string unescape(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> metadata_notes(const Metadata& metadata) {
  std::vector<std::string> notes;
  for (const auto& [key, value] : metadata) {
    notes.push_back(fmt::format("curlidar metadata {} {}", escape(key), escape(value)));
  }
  return notes;
}

bool read_metadata_note(std::string_view comment, Metadata& metadata) {
  const std::vector<std::string_view> words = split_words(comment);
  if (words.size() < 3 || words.size() > 4 || words[0] != "curlidar" || words[1] != "metadata") {
    return false;
  }
  metadata[unescape(words[2])] = words.size() == 4 ? unescape(words[3]) : std::string();
  return true;
}

}  // namespace curlidar::io
