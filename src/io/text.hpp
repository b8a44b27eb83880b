// SPDX-License-Identifier: BSD-3-Clause
// Lines, words and numbers of text formats, independent of the locale.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar::io {

/// Longer lines are refused: no point has that many numbers, a binary file does.
inline constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20;

/// Walks through the lines of a text. Line ends are \n or \r\n; the last one may lack it.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  /// The next line without its end; false at the end of the text.
  bool next(std::string_view& line) {
    if (offset_ >= text_.size()) return false;
    const char* begin = text_.data() + offset_;
    const std::size_t left = text_.size() - offset_;
    const void* found = std::memchr(begin, '\n', left);
    const std::size_t size =
        found == nullptr ? left : static_cast<std::size_t>(static_cast<const char*>(found) - begin);
    offset_ += found == nullptr ? size : size + 1;
    ++line_;
    line = {begin, size};
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return true;
  }

  std::size_t offset() const { return offset_; }  ///< of the byte after the last line
  std::size_t line() const { return line_; }      ///< number of the last line, from 1

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  std::size_t line_ = 0;
};

inline bool is_space(char c) {
  return c == ' ' || c == '\t';
}

/// Takes the next word (between blanks and tabs) off `rest`; empty when there is none.
inline std::string_view take_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_space(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_space(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

std::vector<std::string_view> split_words(std::string_view line);
std::string_view trim(std::string_view text);

/// The whole of `word` as a number. Accepts a leading '+', and nan and inf for floating point.
/// False if it is not one or does not fit T; float32 values too small become zero.
template <class T>
bool parse_number(std::string_view word, T& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc{}) return stop == end;
  if constexpr (std::is_same_v<T, float>) {
    double wide = 0;
    if (error != std::errc::result_out_of_range || !parse_number(word, wide)) return false;
    value = static_cast<float>(wide);
    return wide > -1 && wide < 1;
  }
  return false;
}

/// Parses a word into element `index` of a column of the type it was made for.
using StoreWord = bool (*)(std::string_view word, Column& column, std::size_t index);
StoreWord word_parser(ScalarType type);

/// Appends an element of a column: the shortest text that parses back to the same value.
using AppendNumber = void (*)(const Column& column, std::size_t index, std::string& out);
AppendNumber number_printer(ScalarType type);

}  // namespace curlidar::io
