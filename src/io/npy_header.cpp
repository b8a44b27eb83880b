// SPDX-License-Identifier: BSD-3-Clause
// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#include "io/npy_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "base/try.hpp"
#include "io/text.hpp"
#include "io/text_table.hpp"

namespace curlidar::io {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
/// Keeps every product of sizes far from overflow.
constexpr std::uint64_t kMaxFieldBytes = std::uint64_t{1} << 31;
constexpr std::size_t kMaxDimensions = 32;  // NumPy's own limit

/// Reads Python literals from left to right. The first thing that does not fit makes it fail for
/// good, with a reason.
class LiteralReader {
 public:
  LiteralReader(std::string_view text, std::size_t base) : text_(text), base_(base) {}

  bool ok() const { return reason_.empty(); }
  const std::string& reason() const { return reason_; }
  std::size_t offset() const { return base_ + at_; }

  void fail(std::string reason) {
    if (ok()) reason_ = std::move(reason);
  }
  /// The next byte that is no white space; 0 at the end.
  char peek() {
    while (at_ < text_.size() && (is_space(text_[at_]) || text_[at_] == '\n')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool accept(char c) {
    if (!ok() || peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(fmt::format("'{}' expected", c));
  }
  std::string string() {
    const char quote = peek();
    if (!ok() || (quote != '\'' && quote != '"')) {
      fail("a string expected");
      return {};
    }
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) {
      fail("a string without end");
      return {};
    }
    const std::string_view value = text_.substr(at_ + 1, end - at_ - 1);
    if (value.find('\\') != std::string_view::npos)
      fail("a name with a backslash is not supported");
    at_ = end + 1;
    return std::string(value);
  }
  std::uint64_t number() {
    peek();
    std::uint64_t value = 0;
    const char* end = text_.data() + text_.size();
    const auto [stop, error] = std::from_chars(text_.data() + at_, end, value);
    if (error != std::errc{}) fail("a whole number of at most 64 bits expected");
    at_ = static_cast<std::size_t>(stop - text_.data());
    if (peek() == 'L') ++at_;  // Python 2 wrote 5L
    return value;
  }
  bool boolean() {
    peek();
    for (const bool value : {true, false}) {
      const std::string_view word = value ? "True" : "False";
      if (text_.substr(at_).starts_with(word)) {
        at_ += word.size();
        return value;
      }
    }
    fail("True or False expected");
    return false;
  }
  /// (), (5,), (5, 3) or 5
  std::vector<std::uint64_t> shape() {
    if (peek() != '(') return {number()};
    expect('(');
    std::vector<std::uint64_t> values;
    while (ok() && !accept(')')) {
      values.push_back(number());
      if (values.size() > kMaxDimensions) fail("too many dimensions");
      if (!accept(',') && peek() != ')') fail("',' or ')' expected");
    }
    return values;
  }

 private:
  std::string_view text_;
  std::size_t base_ = 0;
  std::size_t at_ = 0;
  std::string reason_;
};

std::optional<ScalarType> scalar_type(char kind, std::uint64_t bytes) {
  using enum ScalarType;
  switch (bytes) {
    case 1:
      return kind == 'i'                  ? std::optional(int8)
             : kind == 'u' || kind == 'b' ? std::optional(uint8)
                                          : std::nullopt;
    case 2:
      return kind == 'i'   ? std::optional(int16)
             : kind == 'u' ? std::optional(uint16)
                           : std::nullopt;
    case 4:
      return kind == 'i'   ? std::optional(int32)
             : kind == 'u' ? std::optional(uint32)
             : kind == 'f' ? std::optional(float32)
                           : std::nullopt;
    case 8:
      return kind == 'i'   ? std::optional(int64)
             : kind == 'u' ? std::optional(uint64)
             : kind == 'f' ? std::optional(float64)
                           : std::nullopt;
    default:
      return std::nullopt;
  }
}

/// A type string such as '<f4'. Void ('|V4') is padding and allowed only where there is no name.
NpyField parse_type(std::string_view text, std::string name, LiteralReader& in) {
  NpyField field;
  field.name = std::move(name);
  const std::string type(text);
  if (!text.empty() && std::string_view("<>|=").find(text[0]) != std::string_view::npos) {
    field.big_endian = text[0] == '>';
    text.remove_prefix(1);
  }
  const char kind = text.empty() ? '\0' : text[0];
  if (text.empty() || !parse_number(text.substr(1), field.bytes) || field.bytes > kMaxFieldBytes) {
    in.fail(fmt::format("{} is no type", quoted(type)));
    return field;
  }
  field.padding = kind == 'V' && field.name.empty();
  const auto scalar = scalar_type(kind, field.bytes);
  if (scalar) field.type = *scalar;
  if (!scalar && !field.padding) {
    in.fail(fmt::format("type {} is not supported; there are f4 f8, i1 i2 i4 i8, u1 u2 u4 u8, b1",
                        quoted(type)));
  }
  return field;
}

/// ('x', '<f4') or ('normal', '<f4', (3,))
NpyField parse_field(LiteralReader& in) {
  in.expect('(');
  if (in.peek() == '(') in.fail("field titles are not supported");
  std::string name = in.string();
  in.expect(',');
  if (in.peek() == '[') in.fail("nested structures are not supported");
  NpyField field = parse_type(in.string(), std::move(name), in);
  if (in.accept(',') && in.peek() != ')') {
    for (const std::uint64_t size : in.shape()) {
      if (size == 0 || size > kMaxFieldBytes / field.components) {
        in.fail("a sub-array of no or too many values");
        break;
      }
      field.components *= size;
    }
  }
  in.expect(')');
  if (in.ok() && field.bytes > 0 && field.components > kMaxFieldBytes / field.bytes) {
    in.fail("a field of too many bytes");
  }
  field.bytes *= field.components;
  return field;
}

void parse_descr(LiteralReader& in, NpyHeader& header) {
  header.fields.clear();
  header.structured = in.accept('[');
  if (!header.structured) {
    const std::string type = in.string();
    if (in.ok()) header.fields.push_back(parse_type(type, "value", in));
    return;
  }
  while (in.ok() && !in.accept(']')) {
    header.fields.push_back(parse_field(in));
    if (!in.accept(',') && in.peek() != ']') in.fail("',' or ']' expected");
  }
}

void parse_dictionary(LiteralReader& in, NpyHeader& header) {
  bool descr = false, order = false, shape = false;
  in.expect('{');
  while (in.ok() && !in.accept('}')) {
    const std::string key = in.string();
    in.expect(':');
    if (!in.ok()) return;
    if (key == "descr" && !descr) {
      parse_descr(in, header);
      descr = true;
    } else if (key == "fortran_order" && !order) {
      header.fortran_order = in.boolean();
      order = true;
    } else if (key == "shape" && !shape) {
      header.shape = in.shape();
      shape = true;
    } else {
      in.fail(fmt::format("an unknown or second key {}", quoted(key)));
    }
    if (!in.accept(',') && in.peek() != '}') in.fail("',' or '}' expected");
  }
  if (in.ok() && in.peek() != '\0') in.fail("text after the dictionary");
  if (!descr || !order || !shape) in.fail("descr, fortran_order or shape is missing");
}

}  // namespace

std::uint64_t NpyHeader::item_bytes() const {
  std::uint64_t bytes = 0;
  for (const NpyField& field : fields) bytes += field.bytes;
  return bytes;
}

Result<NpyHeader> parse_npy_header(const Source& source) {
  if (!source.text().starts_with(kMagic)) {
    return error_at_byte(source, 0, "this is no .npy file: it does not start with \\x93NUMPY");
  }
  ByteReader in(source.bytes.subspan(kMagic.size()));
  const auto major = in.read<std::uint8_t>();
  in.read<std::uint8_t>();
  if (in.ok() && (major < 1 || major > 3)) {
    return error_at_byte(source, kMagic.size(),
                         fmt::format("version {} of the .npy format is unknown", major),
                         ErrorCode::unsupported);
  }
  const std::uint64_t size = major == 1 ? in.read<std::uint16_t>() : in.read<std::uint32_t>();
  const std::size_t start = kMagic.size() + in.offset();
  const ByteSpan text = in.take(size);
  if (!in.ok() || text.empty()) {
    return error_at_byte(source, kMagic.size() + 2, "the file ends inside its header");
  }
  NpyHeader header;
  header.data_offset = kMagic.size() + in.offset();
  LiteralReader literals({reinterpret_cast<const char*>(text.data()), text.size()}, start);
  parse_dictionary(literals, header);
  if (!literals.ok()) {
    return error_at_byte(source, literals.offset(), "npy header: " + literals.reason());
  }
  return header;
}

Bytes npy_header_bytes(const std::string& descr, const std::string& shape) {
  constexpr std::size_t kAlignment = 64;
  std::string text =
      fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", descr, shape);
  const bool ascii = std::all_of(text.begin(), text.end(),
                                 [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  const std::uint8_t major = !ascii ? 3 : text.size() + kAlignment > 0xffff ? 2 : 1;
  const std::size_t prefix = kMagic.size() + 2 + (major == 1 ? 2 : 4);
  while ((prefix + text.size() + 1) % kAlignment != 0) text += ' ';
  text += '\n';
  Bytes out;
  append_text(kMagic, out);
  ByteWriter numbers;
  numbers.write(major);
  numbers.write(std::uint8_t{0});
  if (major == 1) {
    numbers.write(static_cast<std::uint16_t>(text.size()));
  } else {
    numbers.write(static_cast<std::uint32_t>(text.size()));
  }
  out.insert(out.end(), numbers.bytes().begin(), numbers.bytes().end());
  append_text(text, out);
  return out;
}

}  // namespace curlidar::io
