// SPDX-License-Identifier: BSD-3-Clause
// Text tables: .csv, .xyz, .txt. One point a line; commas, semicolons or blanks between numbers;
// lines that start with '#' or '//' are comments; the first line, or a comment before it, may name
// the columns. Text has no types: coordinates are float64, columns of whole numbers int64 or
// uint64, others float64.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/try.hpp"
#include "io/columns.hpp"
#include "io/text_table.hpp"

namespace curlidar::io {
namespace {

constexpr std::size_t kMaxColumns = 4096;

using Cells = std::vector<std::string_view>;

char separator_of(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  return line.find(',') != std::string_view::npos ? ',' : ' ';
}

/// Cells of a line, trimmed. A separator at the end of the line makes no cell.
void split_cells(std::string_view line, char separator, Cells& cells) {
  cells.clear();
  if (separator == ' ') {
    for (auto word = take_word(line); !word.empty(); word = take_word(line)) cells.push_back(word);
    return;
  }
  for (;;) {
    const std::size_t end = std::min(line.find(separator), line.size());
    cells.push_back(trim(line.substr(0, end)));
    if (end == line.size()) break;
    line.remove_prefix(end + 1);
  }
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//");
}

std::string_view without_mark(std::string_view comment) {
  while (!comment.empty() && (comment[0] == '#' || comment[0] == '/')) comment.remove_prefix(1);
  return trim(comment);
}

/// An empty cell is a missing value, as tables exported by statistics packages have them.
bool parse_cell(std::string_view cell, double& value) {
  if (!cell.empty()) return parse_number(cell, value);
  value = std::numeric_limits<double>::quiet_NaN();
  return true;
}

bool all_numbers(const Cells& cells) {
  double value = 0;
  return std::all_of(cells.begin(), cells.end(), [&](auto c) { return parse_cell(c, value); });
}

/// Column names: quotes are taken off, X Y Z are x y z, empty names are numbered.
std::vector<std::string> names_of(const Cells& cells) {
  std::vector<std::string> names;
  for (std::string_view cell : cells) {
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
      cell = cell.substr(1, cell.size() - 2);
    }
    std::string name(cell);
    if (name == "X" || name == "Y" || name == "Z") name[0] = static_cast<char>(name[0] + 'x' - 'X');
    if (name.empty()) name = fmt::format("column{}", names.size());
    names.push_back(std::move(name));
  }
  return names;
}

bool names_axes(const std::vector<std::string>& names) {
  const auto has = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return has("x") && has("y") && has("z");
}

/// The values of a column while it is not yet known whether all are whole numbers.
class GrowingColumn {
 public:
  explicit GrowingColumn(bool whole) : whole_(whole) {}

  bool append(std::string_view cell) {
    double value = 0;
    if (!parse_cell(cell, value)) return false;
    reals_.push_back(value);
    if (whole_) append_whole(cell);
    return true;
  }

  Column take() {
    if (!whole_ || bits_.empty() || (negative_ && large_)) return std::move(reals_);
    if (large_) return std::move(bits_);
    return std::vector<std::int64_t>(bits_.begin(), bits_.end());
  }

 private:
  void append_whole(std::string_view cell) {
    std::int64_t small = 0;
    std::uint64_t bits = 0;
    if (parse_number(cell, small)) {
      bits = static_cast<std::uint64_t>(small);
      // "-0" is whole for a parser but loses its sign.
      if (cell.starts_with('-')) (small == 0 ? whole_ : negative_) = small != 0;
    } else if (parse_number(cell, bits)) {
      large_ = true;
    } else {
      whole_ = false;
    }
    bits_.push_back(bits);
    if (!whole_) bits_ = {};
  }

  std::vector<double> reals_;
  std::vector<std::uint64_t> bits_;  ///< the same values as whole numbers, two's complement
  bool whole_;
  bool negative_ = false;
  bool large_ = false;  ///< beyond int64
};

/// What the lines before the first point say.
struct Head {
  char separator = ' ';
  std::vector<std::string> names;  ///< empty if nothing names the columns
  std::string_view first;          ///< the first line of numbers, if any
  bool has_first = false;
};

Status check_line(const Source& source, const LineReader& lines, std::string_view line) {
  if (line.size() <= kMaxLineBytes) return {};
  return error_at_line(
      source, lines.line(),
      fmt::format("the line has {} bytes, more than the limit of {}", line.size(), kMaxLineBytes),
      ErrorCode::limit_exceeded);
}

void drop_empty_end(Cells& cells) {
  if (!cells.empty() && cells.back().empty()) cells.pop_back();
}

Result<Head> read_head(const Source& source, LineReader& lines) {
  Head head;
  std::vector<std::string> commented;  // names from a comment
  std::string_view line;
  Cells cells;
  while (lines.next(line)) {
    CURLIDAR_TRY(check_line(source, lines, line));
    line = trim(line);
    if (line.empty()) continue;
    if (is_comment(line)) {
      const std::string_view text = without_mark(line);
      split_cells(text, separator_of(text), cells);
      drop_empty_end(cells);
      auto names = names_of(cells);
      if (names_axes(names)) commented = std::move(names);
      continue;
    }
    head.separator = separator_of(line);
    split_cells(line, head.separator, cells);
    drop_empty_end(cells);
    if (all_numbers(cells)) {
      head.first = line;
      head.has_first = true;
      head.names =
          commented.size() == cells.size() ? commented : default_column_names(cells.size());
      if (cells.size() >= 3) return head;
      return error_at_line(
          source, lines.line(),
          fmt::format("{} numbers; a point has at least x, y and z", cells.size()));
    }
    head.names = names_of(cells);
    if (names_axes(head.names)) return head;
    return error_at_line(source, lines.line(),
                         "neither numbers nor names of columns with x, y and z among them");
  }
  head.names = std::move(commented);
  if (!head.names.empty()) return head;
  return error_at_line(source, lines.line() + 1, "neither points nor names of columns");
}

/// Appends the cells of one line to their columns.
Status append_line(const Source& source, std::size_t line_number, const Head& head, Cells& cells,
                   std::vector<GrowingColumn>& columns) {
  if (cells.size() == columns.size() + 1) drop_empty_end(cells);
  if (cells.size() != columns.size()) {
    return error_at_line(
        source, line_number,
        fmt::format("{} values, the first line has {}", cells.size(), columns.size()));
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!columns[i].append(cells[i])) {
      return error_at_line(
          source, line_number,
          fmt::format("{} is no number for column {}", quoted(cells[i]), quoted(head.names[i])));
    }
  }
  return {};
}

std::vector<GrowingColumn> make_columns(const std::vector<std::string>& names) {
  std::vector<GrowingColumn> columns;
  for (const std::string& name : names) {
    columns.emplace_back(name != "x" && name != "y" && name != "z");
  }
  return columns;
}

}  // namespace

Result<Cloud> parse_csv(const Source& source) {
  std::string_view text = source.text();
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // the mark some editors set
  LineReader lines(text);
  CURLIDAR_TRY_ASSIGN(head, read_head(source, lines));
  if (head.names.size() > kMaxColumns) {
    return error_at_line(
        source, lines.line(),
        fmt::format("{} columns, more than the limit of {}", head.names.size(), kMaxColumns),
        ErrorCode::limit_exceeded);
  }
  std::vector<GrowingColumn> columns = make_columns(head.names);
  Cells cells;
  std::uint64_t points = 0;
  std::string_view line = head.first;
  for (bool more = head.has_first || lines.next(line); more; more = lines.next(line)) {
    CURLIDAR_TRY(check_line(source, lines, line));
    line = trim(line);
    if (line.empty() || is_comment(line)) continue;
    CURLIDAR_TRY(check_point_count(source, ++points));
    split_cells(line, head.separator, cells);
    CURLIDAR_TRY(append_line(source, lines.line(), head, cells, columns));
  }
  std::vector<Attribute> fields;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    fields.push_back({head.names[i], 1, columns[i].take()});
  }
  return assemble_cloud(source, std::move(fields), static_cast<std::uint32_t>(points), 1);
}

Result<Bytes> format_csv(const Cloud& cloud, char separator) {
  const std::array<Column, 3> axes = coordinate_columns(cloud, written_position_type(cloud));
  std::vector<Column> storage;
  const std::vector<OutColumn> columns =
      split_components(out_columns(cloud, axes), cloud.size(), storage);
  CURLIDAR_TRY(check_names_are_words(columns, "CSV"));
  std::string header = separator == ' ' ? "#" : "";
  for (const OutColumn& column : columns) {
    if (column.name.find_first_of(",;\"#/") != std::string::npos || column.name == "X" ||
        column.name == "Y" || column.name == "Z") {
      return Error{
          ErrorCode::unsupported,
          fmt::format("CSV cannot hold an attribute named {}: rename it", quoted(column.name))};
    }
    if (!header.empty()) header += separator;
    header += column.name;
  }
  Bytes out;
  append_text(header + "\n", out);
  append_text_table(columns, cloud.size(), separator, out);
  return out;
}

}  // namespace curlidar::io
