// SPDX-License-Identifier: BSD-3-Clause
#include "io/text.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace curlidar::io {
namespace {

template <std::size_t Index>
bool store_word(std::string_view word, Column& column, std::size_t index) {
  return parse_number(word, (*std::get_if<Index>(&column))[index]);
}

template <std::size_t Index>
void append_number(const Column& column, std::size_t index, std::string& out) {
  const auto value = (*std::get_if<Index>(&column))[index];
  if constexpr (std::is_floating_point_v<decltype(value)>) {
    if (std::isnan(value)) {
      out += "nan";
      return;
    }
  }
  char buffer[32];  // the shortest form of a double has at most 24 characters
  out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

template <std::size_t... Index>
constexpr std::array<StoreWord, sizeof...(Index)> make_parsers(std::index_sequence<Index...>) {
  return {store_word<Index>...};
}

template <std::size_t... Index>
constexpr std::array<AppendNumber, sizeof...(Index)> make_printers(std::index_sequence<Index...>) {
  return {append_number<Index>...};
}

constexpr auto kTypes = std::make_index_sequence<std::variant_size_v<Column>>{};

}  // namespace

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    words.push_back(word);
  }
  return words;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

StoreWord word_parser(ScalarType type) {
  static constexpr auto kParsers = make_parsers(kTypes);
  return kParsers[static_cast<std::size_t>(type)];
}

AppendNumber number_printer(ScalarType type) {
  static constexpr auto kPrinters = make_printers(kTypes);
  return kPrinters[static_cast<std::size_t>(type)];
}

}  // namespace curlidar::io
