// SPDX-License-Identifier: BSD-3-Clause
// Stanford's PLY files: ascii, binary little and big endian. The element "vertex" is read, all
// others are passed over. http://paulbourke.net/dataformats/ply/
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "base/try.hpp"
#include "io/columns.hpp"
#include "io/notes.hpp"
#include "io/text_table.hpp"

namespace curlidar::io {
namespace {

struct PlyProperty {
  TextField field;                             ///< of lists: the type of the entries
  ScalarType length_type = ScalarType::uint8;  ///< of lists
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const {
    return std::any_of(properties.begin(), properties.end(),
                       [](const PlyProperty& p) { return p.field.is_list; });
  }
  /// Bytes of the scalar properties of one record.
  std::size_t scalar_bytes() const {
    std::size_t bytes = 0;
    for (const PlyProperty& p : properties) bytes += p.field.is_list ? 0 : size_of(p.field.type);
    return bytes;
  }
};

/// Attributes of several components are written as scalars name_0, name_1, ...; a comment of ours
/// says that they belong together.
struct JoinedField {
  std::string name;
  std::uint32_t components = 1;
};

struct PlyHeader {
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::uint64_t columns = 0, rows = 0;  ///< obj_info num_cols, num_rows of organised clouds
  std::vector<JoinedField> joined;
  Metadata metadata;
};

std::optional<ScalarType> scalar_type(std::string_view name) {
  using enum ScalarType;
  if (name == "char" || name == "int8") return int8;
  if (name == "uchar" || name == "uint8") return uint8;
  if (name == "short" || name == "int16") return int16;
  if (name == "ushort" || name == "uint16") return uint16;
  if (name == "int" || name == "int32") return int32;
  if (name == "uint" || name == "uint32") return uint32;
  if (name == "float" || name == "float32") return float32;
  if (name == "double" || name == "float64") return float64;
  return std::nullopt;
}

// ---- the header ----

using Words = std::vector<std::string_view>;

void read_comment(std::string_view comment, PlyHeader& header) {
  if (read_metadata_note(comment, header.metadata)) return;
  const Words words = split_words(comment);
  JoinedField joined;
  if (words.size() == 4 && words[0] == "curlidar" && words[1] == "components" &&
      parse_number(words[3], joined.components)) {
    joined.name = words[2];
    header.joined.push_back(joined);
  }
}

void read_obj_info(std::string_view info, PlyHeader& header) {
  const Words words = split_words(info);
  std::uint64_t number = 0;
  if (words.size() != 2 || !parse_number(words[1], number)) return;
  if (words[0] == "num_cols") header.columns = number;
  if (words[0] == "num_rows") header.rows = number;
}

/// The reason why a header line is wrong, or nothing.
std::string read_format(const Words& words, PlyHeader& header) {
  if (words.size() != 3 || words[2] != "1.0") return "the format line must be: format NAME 1.0";
  if (words[1] == "ascii") {
    header.encoding = Encoding::ascii;
  } else if (words[1] == "binary_little_endian") {
    header.encoding = Encoding::binary;
  } else if (words[1] == "binary_big_endian") {
    header.encoding = Encoding::binary_big_endian;
  } else {
    return fmt::format("{} is no PLY format", quoted(words[1]));
  }
  return {};
}

std::string read_element(const Words& words, PlyHeader& header) {
  PlyElement element;
  if (words.size() != 3 || !parse_number(words[2], element.count)) {
    return "an element line must be: element NAME COUNT";
  }
  element.name = words[1];
  header.elements.push_back(std::move(element));
  return {};
}

std::string read_property(const Words& words, PlyHeader& header) {
  const bool is_list = words.size() > 1 && words[1] == "list";
  if (words.size() != (is_list ? 5u : 3u)) {
    return "a property line must be: property TYPE NAME, or property list TYPE TYPE NAME";
  }
  if (header.elements.empty()) return "a property before the first element";
  const auto type = scalar_type(words[words.size() - 2]);
  const auto length_type = is_list ? scalar_type(words[2]) : ScalarType::uint8;
  if (!type || !length_type || *length_type == ScalarType::float32 ||
      *length_type == ScalarType::float64) {
    return fmt::format("property {} has an unknown type", quoted(words.back()));
  }
  PlyProperty property;
  property.field.name = words.back();
  property.field.type = *type;
  property.field.is_list = is_list;
  property.field.skipped = is_list;
  property.length_type = *length_type;
  header.elements.back().properties.push_back(std::move(property));
  return {};
}

Result<PlyHeader> parse_header(const Source& source, LineReader& lines) {
  PlyHeader header;
  std::string_view line;
  bool has_format = false;
  if (!lines.next(line) || trim(line) != "ply") {
    return error_at_line(source, 1, "a PLY file starts with the line: ply");
  }
  while (lines.next(line)) {
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    std::string wrong;
    if (keyword == "comment") {
      read_comment(rest, header);
    } else if (keyword == "obj_info") {
      read_obj_info(rest, header);
    } else if (keyword == "format") {
      wrong = has_format ? "a second format line" : read_format(split_words(line), header);
      has_format = true;
    } else if (keyword == "element") {
      wrong = read_element(split_words(line), header);
    } else if (keyword == "property") {
      wrong = read_property(split_words(line), header);
    } else if (keyword == "end_header") {
      if (!has_format) return error_at_line(source, lines.line(), "the header has no format line");
      return header;
    } else if (!keyword.empty()) {
      wrong = fmt::format("{} is no PLY header keyword", quoted(keyword));
    }
    if (!wrong.empty()) return error_at_line(source, lines.line(), wrong);
  }
  return error_at_line(source, lines.line() + 1,
                       "the PLY header ends without end_header; the file is truncated");
}

Result<std::size_t> find_vertex(const Source& source, const PlyHeader& header) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    if (header.elements[i].name != "vertex") continue;
    if (found) return error_at_line(source, 1, "the header has two vertex elements");
    found = i;
  }
  if (!found) return error_at_line(source, 1, "the header has no vertex element");
  return *found;
}

// ---- binary points ----

/// The length of a list; far too large if it is negative.
std::uint64_t load_length(ByteSpan bytes, ScalarType type, bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte byte = bytes[big_endian ? i : bytes.size() - 1 - i];
    value = value << 8 | std::to_integer<std::uint64_t>(byte);
  }
  const bool is_signed = to_string(type)[0] == 'i';
  const bool negative = is_signed && (value >> (8 * bytes.size() - 1)) != 0;
  return negative ? ~std::uint64_t{0} : value;
}

/// Passes over one record with lists; its scalars are appended to `scalars` if given.
bool walk_record(ByteReader& in, const PlyElement& element, bool big_endian, Bytes* scalars) {
  for (const PlyProperty& property : element.properties) {
    const std::size_t size = size_of(property.field.type);
    if (!property.field.is_list) {
      const ByteSpan value = in.take(size);
      if (scalars != nullptr) scalars->insert(scalars->end(), value.begin(), value.end());
      continue;
    }
    const ByteSpan length_bytes = in.take(size_of(property.length_type));
    if (!in.ok()) return false;
    const std::uint64_t length = load_length(length_bytes, property.length_type, big_endian);
    if (length > in.remaining() / size) return false;
    in.take(length * size);
  }
  return in.ok();
}

Error too_short(const Source& source, std::size_t offset, const PlyElement& element) {
  return error_at_byte(source, offset,
                       fmt::format("the file ends inside the {} records of element {}: it is "
                                   "truncated or its header is wrong",
                                   element.count, quoted(element.name)));
}

/// The scalar properties of all records of an element, one record after the other. A view into the
/// file where there are no lists, otherwise into `storage`. `in` moves behind the element.
Result<ByteSpan> take_element(const Source& source, std::size_t base, ByteReader& in,
                              const PlyElement& element, bool big_endian, Bytes* storage) {
  const std::size_t start = base + in.offset();
  if (!element.has_lists()) {
    const std::size_t record = element.scalar_bytes();
    if (record == 0) return ByteSpan();
    if (element.count > in.remaining() / record) return too_short(source, start, element);
    return in.take(element.count * record);
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (!walk_record(in, element, big_endian, storage)) return too_short(source, start, element);
  }
  return storage == nullptr ? ByteSpan() : ByteSpan(*storage);
}

Result<std::vector<Attribute>> read_binary(const Source& source, std::size_t offset,
                                           const PlyHeader& header, std::size_t vertex_index) {
  const bool big_endian = header.encoding == Encoding::binary_big_endian;
  ByteReader in(source.bytes.subspan(offset));
  for (std::size_t i = 0; i < vertex_index; ++i) {
    CURLIDAR_TRY(take_element(source, offset, in, header.elements[i], big_endian, nullptr));
  }
  const PlyElement& vertex = header.elements[vertex_index];
  Bytes storage;
  CURLIDAR_TRY_ASSIGN(records, take_element(source, offset, in, vertex, big_endian, &storage));
  std::vector<Attribute> out;
  const std::size_t record = vertex.scalar_bytes();
  if (record == 0) return out;
  const Block block{records, static_cast<std::uint32_t>(vertex.count), 1, big_endian};
  std::size_t at = 0;
  for (const PlyProperty& property : vertex.properties) {
    if (property.field.is_list) continue;
    out.push_back(gather(block, {property.field.name, property.field.type, 1, at, 0, record}));
    at += size_of(property.field.type);
  }
  return out;
}

// ---- ascii points ----

Result<std::vector<Attribute>> read_ascii(const Source& source, LineReader& lines,
                                          const PlyHeader& header, std::size_t vertex_index) {
  std::string_view line;
  for (std::size_t e = 0; e < vertex_index; ++e) {
    const PlyElement& element = header.elements[e];
    if (element.properties.empty()) continue;
    for (std::uint64_t i = 0; i < element.count;) {
      if (!lines.next(line)) return too_short(source, lines.offset(), element);
      if (!trim(line).empty()) ++i;
    }
  }
  std::vector<TextField> fields;
  for (const PlyProperty& property : header.elements[vertex_index].properties) {
    fields.push_back(property.field);
  }
  return read_text_table(source, lines, fields, header.elements[vertex_index].count);
}

// ---- fields to a cloud ----

/// Where the fields NAME_0 .. NAME_{k-1} start, if they stand side by side with one type.
std::optional<std::size_t> find_parts(const std::vector<Attribute>& fields,
                                      const JoinedField& joined) {
  const auto first = std::find_if(fields.begin(), fields.end(),
                                  [&](const Attribute& f) { return f.name == joined.name + "_0"; });
  const auto start = static_cast<std::size_t>(first - fields.begin());
  if (joined.components < 2 || joined.components > fields.size() - start) return std::nullopt;
  for (std::uint32_t k = 0; k < joined.components; ++k) {
    const Attribute& part = fields[start + k];
    if (part.name != fmt::format("{}_{}", joined.name, k) || part.components != 1 ||
        part.values.index() != first->values.index()) {
      return std::nullopt;
    }
  }
  return start;
}

void join_parts(const JoinedField& joined, std::vector<Attribute>& fields) {
  const auto start = find_parts(fields, joined);
  if (!start) return;  // a comment that does not fit its file means nothing
  const std::size_t points = size_of(fields[*start].values);
  Attribute whole{joined.name, joined.components,
                  make_column(type_of(fields[*start].values), points * joined.components)};
  std::visit(
      [&](auto& to) {
        for (std::uint32_t k = 0; k < joined.components; ++k) {
          const auto& from = *std::get_if<std::decay_t<decltype(to)>>(&fields[*start + k].values);
          for (std::size_t i = 0; i < points; ++i) to[i * joined.components + k] = from[i];
        }
      },
      whole.values);
  const auto first = fields.begin() + static_cast<std::ptrdiff_t>(*start);
  fields.erase(first + 1, first + static_cast<std::ptrdiff_t>(joined.components));
  *first = std::move(whole);
}

/// Names of the list properties of an element: they have no place in a cloud.
std::string list_names(const PlyElement& element) {
  std::vector<std::string_view> names;
  for (const PlyProperty& p : element.properties) {
    if (p.field.is_list) names.push_back(p.field.name);
  }
  return fmt::format("{}", fmt::join(names, " "));
}

// ---- writing ----

/// PLY's name of a type, or null: it has no 64-bit integers.
const char* ply_type(ScalarType type) {
  switch (type) {
    case ScalarType::int8:
      return "char";
    case ScalarType::uint8:
      return "uchar";
    case ScalarType::int16:
      return "short";
    case ScalarType::uint16:
      return "ushort";
    case ScalarType::int32:
      return "int";
    case ScalarType::uint32:
      return "uint";
    case ScalarType::float32:
      return "float";
    case ScalarType::float64:
      return "double";
    default:
      return nullptr;
  }
}

Status check_types(const Cloud& cloud) {
  std::vector<std::string_view> unheld;
  for (const Attribute& attribute : cloud.attributes) {
    if (ply_type(type_of(attribute.values)) == nullptr) unheld.push_back(attribute.name);
  }
  if (unheld.empty()) return {};
  return Error{ErrorCode::unsupported,
               fmt::format("PLY has no 64-bit integers, so it cannot hold the attribute{} {}; "
                           "choose the attributes to keep, or write PCD",
                           unheld.size() > 1 ? "s" : "", fmt::join(unheld, ", "))};
}

std::string header_text(const Cloud& cloud, const std::vector<OutColumn>& columns,
                        Encoding encoding) {
  const char* format = encoding == Encoding::ascii    ? "ascii"
                       : encoding == Encoding::binary ? "binary_little_endian"
                                                      : "binary_big_endian";
  std::string out = fmt::format("ply\nformat {} 1.0\n", format);
  for (const std::string& note : metadata_notes(cloud.metadata)) {
    out += fmt::format("comment {}\n", note);
  }
  for (const Attribute& attribute : cloud.attributes) {
    if (attribute.components == 1) continue;
    out += fmt::format("comment curlidar components {} {}\n", attribute.name, attribute.components);
  }
  if (cloud.organised()) {
    out += fmt::format("obj_info num_cols {}\nobj_info num_rows {}\n", cloud.width, cloud.height);
  }
  out += fmt::format("element vertex {}\n", cloud.size());
  for (const OutColumn& column : columns) {
    out += fmt::format("property {} {}\n", ply_type(column.type()), column.name);
  }
  return out + "end_header\n";
}

}  // namespace

Result<Cloud> parse_ply(const Source& source) {
  LineReader lines(source.text());
  CURLIDAR_TRY_ASSIGN(header, parse_header(source, lines));
  CURLIDAR_TRY_ASSIGN(vertex_index, find_vertex(source, header));
  const PlyElement& vertex = header.elements[vertex_index];
  CURLIDAR_TRY(check_point_count(source, vertex.count));
  auto fields = header.encoding == Encoding::ascii
                    ? read_ascii(source, lines, header, vertex_index)
                    : read_binary(source, lines.offset(), header, vertex_index);
  if (!fields) return fields.error();
  for (const JoinedField& joined : header.joined) join_parts(joined, *fields);

  auto width = static_cast<std::uint32_t>(vertex.count);
  std::uint32_t height = 1;
  if (header.rows > 1 && header.columns == vertex.count / header.rows &&
      header.columns * header.rows == vertex.count) {
    width = static_cast<std::uint32_t>(header.columns);
    height = static_cast<std::uint32_t>(header.rows);
  }
  CURLIDAR_TRY_ASSIGN(cloud, assemble_cloud(source, std::move(*fields), width, height));
  cloud.metadata = std::move(header.metadata);
  if (vertex.has_lists()) cloud.metadata["ply_lists_not_read"] = list_names(vertex);
  return cloud;
}

Result<Bytes> format_ply(const Cloud& cloud, Encoding encoding) {
  CURLIDAR_TRY(check_types(cloud));
  const std::array<Column, 3> axes = coordinate_columns(cloud, written_position_type(cloud));
  std::vector<Column> storage;
  const std::vector<OutColumn> whole = out_columns(cloud, axes);
  CURLIDAR_TRY(check_names_are_words(whole, "PLY"));
  const std::vector<OutColumn> columns = split_components(whole, cloud.size(), storage);
  CURLIDAR_TRY(check_names_are_words(columns, "PLY"));
  Bytes out;
  append_text(header_text(cloud, columns, encoding), out);
  if (encoding == Encoding::ascii) {
    append_text_table(columns, cloud.size(), ' ', out);
  } else {
    append_records(columns, cloud.size(), encoding == Encoding::binary_big_endian, out);
  }
  return out;
}

}  // namespace curlidar::io
