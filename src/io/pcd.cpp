// SPDX-License-Identifier: BSD-3-Clause
// PCL's PCD files, versions 0.5 to 0.7: ascii, binary and binary_compressed.
// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "base/try.hpp"
#include "io/columns.hpp"
#include "io/lzf.hpp"
#include "io/notes.hpp"
#include "io/text_table.hpp"

namespace curlidar::io {
namespace {

constexpr std::string_view kPadding = "_";
constexpr std::string_view kIdentityViewpoint = "0 0 0 1 0 0 0";
constexpr std::uint64_t kMax32 = std::numeric_limits<std::uint32_t>::max();

struct PcdHeader {
  std::vector<TextField> fields;
  std::uint64_t width = 0, height = 1;
  Encoding encoding = Encoding::ascii;
  Metadata metadata;

  std::uint64_t points() const { return width * height; }
};

std::optional<ScalarType> scalar_type(std::string_view letter, std::string_view size) {
  using enum ScalarType;
  if (letter == "F") {
    if (size == "4") return float32;
    if (size == "8") return float64;
  } else if (letter == "I" || letter == "U") {
    const bool is_signed = letter == "I";
    if (size == "1") return is_signed ? int8 : uint8;
    if (size == "2") return is_signed ? int16 : uint16;
    if (size == "4") return is_signed ? int32 : uint32;
    if (size == "8") return is_signed ? int64 : uint64;
  }
  return std::nullopt;
}

std::size_t bytes_per_point(const TextField& field) {
  return size_of(field.type) * field.components;
}

// ---- the header ----

/// A header line: its words after the keyword, and its number.
struct HeaderLine {
  std::vector<std::string_view> words;
  std::size_t line = 0;
};

using HeaderLines = std::map<std::string_view, HeaderLine>;

/// Collects the lines up to DATA by their keywords.
Result<HeaderLines> collect_lines(const Source& source, LineReader& lines, Metadata& metadata) {
  static constexpr std::array<std::string_view, 10> kKeywords{
      "VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
      "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  HeaderLines found;
  std::string_view line;
  while (lines.next(line)) {
    if (line.starts_with('#')) {
      read_metadata_note(line.substr(1), metadata);
      continue;
    }
    std::string_view keyword = take_word(line);
    if (keyword.empty()) continue;
    if (keyword == "COLUMNS") keyword = "FIELDS";  // the name in version 0.5
    if (std::find(kKeywords.begin(), kKeywords.end(), keyword) == kKeywords.end()) {
      return error_at_line(source, lines.line(),
                           fmt::format("{} is no PCD header keyword", quoted(keyword)));
    }
    if (!found.emplace(keyword, HeaderLine{split_words(line), lines.line()}).second) {
      return error_at_line(source, lines.line(), fmt::format("a second {} line", keyword));
    }
    if (keyword == "DATA") return found;
  }
  return error_at_line(source, lines.line() + 1,
                       "the PCD header ends without a DATA line; the file is truncated");
}

/// A line of exactly one whole number of at most 32 bits.
Result<std::uint64_t> whole_number(const Source& source, const HeaderLine& line,
                                   const char* keyword) {
  std::uint64_t value = 0;
  if (line.words.size() != 1 || !parse_number(line.words[0], value) || value > kMax32) {
    return error_at_line(source, line.line,
                         fmt::format("{} must be one whole number from 0 to {}", keyword, kMax32));
  }
  return value;
}

Result<std::vector<TextField>> parse_fields(const Source& source, const HeaderLines& lines) {
  const auto names = lines.find("FIELDS");
  const auto sizes = lines.find("SIZE");
  const auto types = lines.find("TYPE");
  const auto counts = lines.find("COUNT");
  using Entry = std::pair<const char*, HeaderLines::const_iterator>;
  for (const auto& [keyword, at] :
       {Entry{"FIELDS", names}, Entry{"SIZE", sizes}, Entry{"TYPE", types}}) {
    if (at == lines.end()) {
      return error_at_line(source, 1, fmt::format("the PCD header has no {} line", keyword));
    }
    if (at->second.words.size() != names->second.words.size()) {
      return error_at_line(source, at->second.line,
                           fmt::format("{} has {} entries for {} fields", keyword,
                                       at->second.words.size(), names->second.words.size()));
    }
  }
  const std::size_t size = names->second.words.size();
  if (counts != lines.end() && counts->second.words.size() != size) {
    return error_at_line(
        source, counts->second.line,
        fmt::format("COUNT has {} entries for {} fields", counts->second.words.size(), size));
  }
  std::vector<TextField> fields(size);
  for (std::size_t i = 0; i < size; ++i) {
    fields[i].name = names->second.words[i];
    fields[i].skipped = fields[i].name == kPadding;
    const auto type = scalar_type(types->second.words[i], sizes->second.words[i]);
    if (!type) {
      return error_at_line(source, types->second.line,
                           fmt::format("field {} has TYPE {} and SIZE {}; PCD has F 4 8, I and U "
                                       "1 2 4 8",
                                       quoted(fields[i].name), quoted(types->second.words[i]),
                                       quoted(sizes->second.words[i])));
    }
    fields[i].type = *type;
    if (counts != lines.end() && (!parse_number(counts->second.words[i], fields[i].components) ||
                                  fields[i].components == 0)) {
      return error_at_line(source, counts->second.line,
                           fmt::format("field {} has COUNT {}, not a whole number above 0",
                                       quoted(fields[i].name), quoted(counts->second.words[i])));
    }
  }
  return fields;
}

Status parse_layout(const Source& source, const HeaderLines& lines, PcdHeader& header) {
  const auto width = lines.find("WIDTH");
  const auto height = lines.find("HEIGHT");
  const auto points = lines.find("POINTS");
  if (width == lines.end() && points == lines.end()) {
    return error_at_line(source, 1, "the PCD header has neither WIDTH nor POINTS");
  }
  if (width != lines.end()) {
    CURLIDAR_TRY_ASSIGN(value, whole_number(source, width->second, "WIDTH"));
    header.width = value;
  }
  if (height != lines.end()) {
    CURLIDAR_TRY_ASSIGN(value, whole_number(source, height->second, "HEIGHT"));
    header.height = value;
  }
  if (points != lines.end()) {
    CURLIDAR_TRY_ASSIGN(value, whole_number(source, points->second, "POINTS"));
    if (width == lines.end()) header.width = value;
    if (header.points() != value) {
      return error_at_line(source, points->second.line,
                           fmt::format("POINTS is {}, WIDTH times HEIGHT is {} x {}", value,
                                       header.width, header.height));
    }
  }
  return check_point_count(source, header.points());
}

Status parse_viewpoint(const Source& source, const HeaderLines& lines, PcdHeader& header) {
  const auto at = lines.find("VIEWPOINT");
  if (at == lines.end()) return {};
  const HeaderLine& line = at->second;
  double number = 0;
  const bool numbers = std::all_of(line.words.begin(), line.words.end(),
                                   [&](auto word) { return parse_number(word, number); });
  if (line.words.size() != 7 || !numbers) {
    return error_at_line(source, line.line, "VIEWPOINT must be 7 numbers: tx ty tz qw qx qy qz");
  }
  const std::string viewpoint = fmt::format("{}", fmt::join(line.words, " "));
  // The identity says nothing; leaving it out makes clouds equal whatever format they came in.
  if (viewpoint != kIdentityViewpoint) header.metadata["viewpoint"] = viewpoint;
  return {};
}

Result<PcdHeader> parse_header(const Source& source, LineReader& lines) {
  PcdHeader header;
  CURLIDAR_TRY_ASSIGN(found, collect_lines(source, lines, header.metadata));
  CURLIDAR_TRY_ASSIGN(fields, parse_fields(source, found));
  header.fields = std::move(fields);
  CURLIDAR_TRY(parse_layout(source, found, header));
  CURLIDAR_TRY(parse_viewpoint(source, found, header));
  const HeaderLine& data = found.find("DATA")->second;
  const std::string_view word = data.words.size() == 1 ? data.words[0] : std::string_view();
  if (word == "ascii") {
    header.encoding = Encoding::ascii;
  } else if (word == "binary") {
    header.encoding = Encoding::binary;
  } else if (word == "binary_compressed") {
    header.encoding = Encoding::binary_compressed;
  } else {
    return error_at_line(source, data.line, "DATA must be ascii, binary or binary_compressed");
  }
  return header;
}

// ---- the points ----

/// Bytes after the last point; tools that pad to a page leave zeros, anything else is damage.
Status check_rest(const Source& source, std::uint64_t offset) {
  const ByteSpan rest = source.bytes.subspan(static_cast<std::size_t>(offset));
  const auto other = std::find_if(rest.begin(), rest.end(), [](std::byte b) {
    return b != std::byte{0} && b != std::byte{'\n'} && b != std::byte{'\r'};
  });
  if (other == rest.end()) return {};
  return error_at_byte(source, offset + static_cast<std::uint64_t>(other - rest.begin()),
                       "there are data after the last point that the header does not count");
}

Result<std::vector<Attribute>> read_ascii(const Source& source, LineReader& lines,
                                          const PcdHeader& header) {
  CURLIDAR_TRY_ASSIGN(fields, read_text_table(source, lines, header.fields, header.points()));
  CURLIDAR_TRY(check_rest(source, lines.offset()));
  return fields;
}

std::vector<Attribute> gather_fields(const Block& block, const PcdHeader& header,
                                     bool field_by_field) {
  std::size_t record = 0;
  for (const TextField& field : header.fields) record += bytes_per_point(field);
  const auto points = static_cast<std::size_t>(header.points());
  std::vector<Attribute> out;
  std::size_t offset = 0;
  for (const TextField& field : header.fields) {
    const std::size_t size = bytes_per_point(field);
    if (!field.skipped) {
      out.push_back(gather(
          block, {field.name, field.type, field.components,
                  field_by_field ? offset * points : offset, 0, field_by_field ? size : record}));
    }
    offset += size;
  }
  return out;
}

Result<std::vector<Attribute>> read_binary(const Source& source, std::size_t offset,
                                           const PcdHeader& header) {
  std::uint64_t record = 0;
  for (const TextField& field : header.fields) record += bytes_per_point(field);
  const std::uint64_t left = source.bytes.size() - offset;
  if (header.points() > 0 && header.points() > left / std::max<std::uint64_t>(record, 1)) {
    return error_at_byte(source, offset,
                         fmt::format("{} points of {} bytes are claimed, only {} bytes follow: the "
                                     "file is truncated or its header is wrong",
                                     header.points(), record, left));
  }
  CURLIDAR_TRY(check_rest(source, offset + header.points() * record));
  const Block block{source.bytes.subspan(offset), static_cast<std::uint32_t>(header.points()), 1,
                    false};
  return gather_fields(block, header, false);
}

Result<std::vector<Attribute>> read_compressed(const Source& source, std::size_t offset,
                                               const PcdHeader& header) {
  std::uint64_t record = 0;
  for (const TextField& field : header.fields) record += bytes_per_point(field);
  if (header.points() == 0) return gather_fields({}, header, true);
  ByteReader in(source.bytes.subspan(offset));
  const auto compressed = in.read<std::uint32_t>();
  const auto uncompressed = in.read<std::uint32_t>();
  const ByteSpan stream = in.take(compressed);
  if (!in.ok()) {
    return error_at_byte(source, offset,
                         fmt::format("{} compressed bytes are claimed, only {} follow: the file is "
                                     "truncated",
                                     compressed, in.remaining()));
  }
  if (uncompressed % header.points() != 0 || uncompressed / header.points() != record) {
    return error_at_byte(
        source, offset + 4,
        fmt::format("{} uncompressed bytes are claimed, {} points of {} bytes "
                    "need {}",
                    uncompressed, header.points(), record, header.points() * record));
  }
  const auto bytes = lzf_decompress(stream, uncompressed);
  if (!bytes) {
    return error_at_byte(
        source, offset + 8,
        fmt::format("the LZF stream is damaged: it does not give {} bytes", uncompressed));
  }
  CURLIDAR_TRY(check_rest(source, offset + in.offset()));
  return gather_fields({*bytes, static_cast<std::uint32_t>(header.points()), 1, false}, header,
                       true);
}

// ---- writing ----

char type_letter(ScalarType type) {
  const std::string_view name = to_string(type);
  return name[0] == 'f' ? 'F' : name[0] == 'u' ? 'U' : 'I';
}

Result<std::string> viewpoint_of(const Cloud& cloud) {
  const auto at = cloud.metadata.find("viewpoint");
  if (at == cloud.metadata.end()) return std::string(kIdentityViewpoint);
  double number = 0;
  const auto words = split_words(at->second);
  const bool numbers = std::all_of(words.begin(), words.end(),
                                   [&](auto word) { return parse_number(word, number); });
  if (words.size() == 7 && numbers) return fmt::format("{}", fmt::join(words, " "));
  return Error{ErrorCode::invalid_argument,
               fmt::format("the metadata key viewpoint is {}; PCD needs 7 numbers: tx ty tz qw qx "
                           "qy qz",
                           quoted(at->second))};
}

std::string header_text(const Cloud& cloud, const std::vector<OutColumn>& columns,
                        const std::string& viewpoint, const char* data) {
  std::string names, sizes, types, counts;
  for (const OutColumn& column : columns) {
    names += fmt::format(" {}", column.name);
    sizes += fmt::format(" {}", size_of(column.type()));
    types += fmt::format(" {}", type_letter(column.type()));
    counts += fmt::format(" {}", column.components);
  }
  Metadata metadata = cloud.metadata;
  metadata.erase("viewpoint");
  std::string out = "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const std::string& note : metadata_notes(metadata)) out += fmt::format("# {}\n", note);
  const std::size_t width = cloud.organised() ? cloud.width : cloud.size();
  out += fmt::format("VERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH {}\nHEIGHT {}\n", names,
                     sizes, types, counts, width, cloud.organised() ? cloud.height : 1);
  out += fmt::format("VIEWPOINT {}\nPOINTS {}\nDATA {}\n", viewpoint, cloud.size(), data);
  return out;
}

Status append_compressed(const std::vector<OutColumn>& columns, std::size_t points, Bytes& out) {
  Bytes plain;
  for (const OutColumn& column : columns) append_records({column}, points, false, plain);
  const Bytes packed = lzf_compress(plain);
  if (plain.size() > kMax32 || packed.size() > kMax32) {
    return Error{ErrorCode::unsupported,
                 "a binary_compressed PCD holds at most 4 GiB of points; write binary"};
  }
  ByteWriter sizes;
  sizes.write(static_cast<std::uint32_t>(packed.size()));
  sizes.write(static_cast<std::uint32_t>(plain.size()));
  out.insert(out.end(), sizes.bytes().begin(), sizes.bytes().end());
  out.insert(out.end(), packed.begin(), packed.end());
  return {};
}

}  // namespace

Result<Cloud> parse_pcd(const Source& source) {
  LineReader lines(source.text());
  CURLIDAR_TRY_ASSIGN(header, parse_header(source, lines));
  auto fields = header.encoding == Encoding::ascii ? read_ascii(source, lines, header)
                : header.encoding == Encoding::binary
                    ? read_binary(source, lines.offset(), header)
                    : read_compressed(source, lines.offset(), header);
  if (!fields) return fields.error();
  CURLIDAR_TRY_ASSIGN(
      cloud, assemble_cloud(source, std::move(*fields), static_cast<std::uint32_t>(header.width),
                            static_cast<std::uint32_t>(header.height)));
  cloud.metadata = std::move(header.metadata);
  return cloud;
}

Result<Bytes> format_pcd(const Cloud& cloud, Encoding encoding) {
  const std::array<Column, 3> axes = coordinate_columns(cloud, written_position_type(cloud));
  const std::vector<OutColumn> columns = out_columns(cloud, axes);
  CURLIDAR_TRY(check_names_are_words(columns, "PCD"));
  if (cloud.find(kPadding) != nullptr) {
    return Error{ErrorCode::unsupported,
                 "PCD cannot hold an attribute named '_', which means padding: rename it"};
  }
  CURLIDAR_TRY_ASSIGN(viewpoint, viewpoint_of(cloud));
  Bytes out;
  switch (encoding) {
    case Encoding::ascii:
      append_text(header_text(cloud, columns, viewpoint, "ascii"), out);
      append_text_table(columns, cloud.size(), ' ', out);
      break;
    case Encoding::binary_compressed:
      append_text(header_text(cloud, columns, viewpoint, "binary_compressed"), out);
      CURLIDAR_TRY(append_compressed(columns, cloud.size(), out));
      break;
    default:
      append_text(header_text(cloud, columns, viewpoint, "binary"), out);
      append_records(columns, cloud.size(), false, out);
  }
  return out;
}

}  // namespace curlidar::io
