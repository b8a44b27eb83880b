// SPDX-License-Identifier: BSD-3-Clause
#include "io/text_table.hpp"

#include <fmt/format.h>

#include "base/try.hpp"

namespace curlidar::io {
namespace {

/// A field with the column that its words go to.
struct Target {
  const TextField* field;
  Column* column;  ///< null for skipped fields
  StoreWord store;
};

/// A word of each number and a separator after it is the least that a table takes.
Status check_size(const Source& source, const LineReader& lines,
                  const std::vector<TextField>& fields, std::uint64_t points) {
  std::uint64_t words = 0;
  for (const TextField& field : fields) words += field.components;
  const std::uint64_t left = source.bytes.size() - lines.offset();
  if (points == 0 || (words > 0 && points <= (left + 1) / 2 / words)) return {};
  return error_at_byte(source, lines.offset(),
                       fmt::format("{} points of {} numbers are claimed, only {} bytes follow: the "
                                   "file is truncated or its header is wrong",
                                   points, words, left));
}

bool skip_words(std::string_view& rest, std::uint64_t count) {
  for (; count > 0; --count) {
    if (take_word(rest).empty()) return false;
  }
  return true;
}

/// Stores the words of a line; an empty string or what is wrong with it.
std::string store_line(std::string_view line, const std::vector<Target>& targets,
                       std::size_t point) {
  for (const Target& target : targets) {
    const TextField& field = *target.field;
    std::uint64_t count = field.components;
    if (field.is_list && !parse_number(take_word(line), count)) {
      return fmt::format("the length of list {} is no whole number", quoted(field.name));
    }
    if (field.skipped) {
      if (!skip_words(line, count)) return "the line has too few numbers";
      continue;
    }
    for (std::size_t k = 0; k < field.components; ++k) {
      const std::string_view word = take_word(line);
      if (word.empty()) return "the line has too few numbers";
      if (!target.store(word, *target.column, point * field.components + k)) {
        return fmt::format("{} is no {} for field {}", quoted(word), to_string(field.type),
                           quoted(field.name));
      }
    }
  }
  return take_word(line).empty() ? "" : "the line has too many numbers";
}

}  // namespace

Result<std::vector<Attribute>> read_text_table(const Source& source, LineReader& lines,
                                               const std::vector<TextField>& fields,
                                               std::uint64_t points) {
  CURLIDAR_TRY(check_size(source, lines, fields, points));
  std::vector<Attribute> out;
  out.reserve(fields.size());
  std::vector<Target> targets;
  for (const TextField& field : fields) {
    targets.push_back({&field, nullptr, word_parser(field.type)});
    if (field.skipped) continue;
    out.push_back({field.name, field.components,
                   make_column(field.type, static_cast<std::size_t>(points) * field.components)});
    targets.back().column = &out.back().values;
  }
  std::string_view line;
  for (std::size_t point = 0; point < points;) {
    if (!lines.next(line)) {
      return error_at_line(source, lines.line() + 1,
                           fmt::format("the file ends after {} of {} points", point, points));
    }
    if (line.size() > kMaxLineBytes) {
      return error_at_line(source, lines.line(),
                           fmt::format("the line has {} bytes, more than the limit of {}",
                                       line.size(), kMaxLineBytes),
                           ErrorCode::limit_exceeded);
    }
    if (trim(line).empty()) continue;
    const std::string wrong = store_line(line, targets, point);
    if (!wrong.empty()) return error_at_line(source, lines.line(), wrong);
    ++point;
  }
  return out;
}

void append_text_table(const std::vector<OutColumn>& columns, std::size_t points, char separator,
                       Bytes& out) {
  std::vector<AppendNumber> printers;
  for (const OutColumn& column : columns) printers.push_back(number_printer(column.type()));
  std::string line;
  for (std::size_t point = 0; point < points; ++point) {
    line.clear();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      for (std::size_t k = 0; k < columns[c].components; ++k) {
        if (!line.empty()) line += separator;
        printers[c](*columns[c].values, point * columns[c].components + k, line);
      }
    }
    line += '\n';
    append_text(line, out);
  }
}

void append_text(std::string_view text, Bytes& out) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  out.insert(out.end(), begin, begin + text.size());
}

}  // namespace curlidar::io
