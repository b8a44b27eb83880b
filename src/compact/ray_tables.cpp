// SPDX-License-Identifier: BSD-3-Clause
#include "compact/ray_tables.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "base/embedded.hpp"

namespace curlidar {

/// All files of docs/format/beams.
std::span<const EmbeddedText> embedded_beams();

namespace compact {
namespace {

/// The numbers of a text, between white space and comments from # to the end of the line.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) {}

  template <class T>
  std::optional<T> next() {
    skip();
    T value{};
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc{}) return std::nullopt;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return value;
  }

 private:
  void skip() {
    while (!text_.empty()) {
      if (text_.front() == '#') {
        text_.remove_prefix(std::min(text_.find('\n'), text_.size()));
      } else if (text_.front() == ' ' || text_.front() == '\n' || text_.front() == '\r') {
        text_.remove_prefix(1);
      } else {
        return;
      }
    }
  }

  std::string_view text_;
};

BeamTable parse(const EmbeddedText& file) {
  Numbers numbers(file.text);
  BeamTable table;
  table.name = file.name;
  table.number = numbers.next<std::uint32_t>().value_or(0);
  table.slots = numbers.next<std::uint32_t>().value_or(0);
  table.range_unit_q48 = numbers.next<std::uint64_t>().value_or(0);
  while (const auto elevation = numbers.next<std::int32_t>()) {
    table.elevation.push_back(*elevation);
    Ray ray;
    for (std::int32_t* part : {&ray.azimuth_offset, &ray.height, &ray.lateral, &ray.range_phase}) {
      *part = numbers.next<std::int32_t>().value_or(0);
    }
    table.rays.push_back(ray);
  }
  return table;
}

}  // namespace

std::span<const BeamTable> beam_tables() {
  static const std::vector<BeamTable> tables = [] {
    std::vector<BeamTable> read;
    for (const EmbeddedText& file : embedded_beams()) read.push_back(parse(file));
    std::sort(read.begin(), read.end(),
              [](const BeamTable& a, const BeamTable& b) { return a.number < b.number; });
    return read;
  }();
  return tables;
}

const BeamTable* beam_table(std::uint32_t number) {
  const auto tables = beam_tables();
  return number >= 1 && number <= tables.size() ? &tables[number - 1] : nullptr;
}

const BeamTable* beam_table(std::string_view name) {
  for (const BeamTable& table : beam_tables()) {
    if (table.name == name) return &table;
  }
  return nullptr;
}

}  // namespace compact
}  // namespace curlidar
