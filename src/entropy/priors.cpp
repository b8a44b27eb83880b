// SPDX-License-Identifier: BSD-3-Clause
#include "entropy/priors.hpp"

#include <algorithm>
#include <optional>

namespace curlidar {
namespace {

/// Steps through the numbers of four hexadecimal digits in a text.
class HexWords {
 public:
  explicit HexWords(std::string_view text) : text_(text) {}

  /// The next number; nullopt at the end or where the text is not one.
  std::optional<std::uint32_t> next() {
    skip_space_and_comments();
    if (text_.empty()) return std::nullopt;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const int digit = i < text_.size() ? digit_of(text_[i]) : -1;
      if (digit < 0) {
        ok_ = false;
        return std::nullopt;
      }
      value = value << 4 | static_cast<std::uint32_t>(digit);
    }
    text_.remove_prefix(4);
    return value;
  }
  bool at_end() const { return ok_ && text_.empty(); }

 private:
  static int digit_of(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
  }
  void skip_space_and_comments() {
    while (!text_.empty()) {
      if (text_.front() == '#') {
        text_.remove_prefix(std::min(text_.find('\n'), text_.size() - 1) + 1);
      } else if (text_.front() == ' ' || text_.front() == '\n' || text_.front() == '\r') {
        text_.remove_prefix(1);
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  bool ok_ = true;
};

}  // namespace

bool apply_priors(std::string_view text, std::span<BitModel> models) {
  HexWords words(text);
  for (BitModel& model : models) {
    const auto word = words.next();
    if (!word) break;
    const int stretched = static_cast<std::int8_t>(*word >> 8) * 24;
    model.probability = static_cast<std::uint16_t>(squash(stretched));
    model.visits = static_cast<std::uint16_t>(*word & 0xff);
  }
  return words.at_end() || (!words.next() && words.at_end());
}

bool apply_weight_priors(std::string_view text, std::span<std::int32_t> weights) {
  HexWords words(text);
  for (std::int32_t& weight : weights) {
    const auto word = words.next();
    if (!word) break;
    weight = static_cast<std::int16_t>(*word) * 16;
  }
  return words.at_end() || (!words.next() && words.at_end());
}

}  // namespace curlidar
