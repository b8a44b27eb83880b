// SPDX-License-Identifier: BSD-3-Clause
// Points as lines of words of known types: the ascii variants of PCD and PLY.
#pragma once

#include <string>
#include <vector>

#include "io/columns.hpp"
#include "io/text.hpp"

namespace curlidar::io {

/// A field of a text table.
struct TextField {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::uint32_t components = 1;
  bool skipped = false;  ///< its words are passed over
  bool is_list = false;  ///< the first word says how many follow; always skipped
};

/// Reads `points` lines, blank ones not counted, each with the words of all fields. Checks first
/// that the rest of the text can hold that many. Skipped fields are left out of the result.
Result<std::vector<Attribute>> read_text_table(const Source& source, LineReader& lines,
                                               const std::vector<TextField>& fields,
                                               std::uint64_t points);

/// One line for each point, numbers separated by a `separator`.
void append_text_table(const std::vector<OutColumn>& columns, std::size_t points, char separator,
                       Bytes& out);

/// Appends text to bytes.
void append_text(std::string_view text, Bytes& out);

}  // namespace curlidar::io
