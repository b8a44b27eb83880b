// SPDX-License-Identifier: BSD-3-Clause
#include "format/attributes_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "format/packed.hpp"
#include "format/payload.hpp"

namespace curlidar {
namespace {

// How the values of an attribute are arranged before packing; the bits of the format's form byte.
constexpr std::uint8_t kDelta = 1;   // each value less that of the return before it
constexpr std::uint8_t kPlanes = 2;  // first bytes of all values, then second bytes, ...
constexpr std::uint8_t kForms = 4;
constexpr std::size_t kScalarTypes = std::variant_size_v<Column>;

/// The form is chosen at the quick level and written at the slower one, which saves a few per
/// cent more.
constexpr int kTrialLevel = 3;
constexpr int kFinalLevel = 12;

std::vector<std::byte> bytes_of(const Column& column) {
  ByteWriter writer;
  std::visit(
      [&](const auto& values) {
        for (const auto value : values) writer.write(value);
      },
      column);
  return std::move(writer).bytes();
}

Column column_of(ScalarType type, ByteSpan bytes) {
  Column column = make_column(type, bytes.size() / size_of(type));
  std::visit(
      [&](auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        for (std::size_t i = 0; i < values.size(); ++i) {
          values[i] = load_little_endian<Value>(bytes.data() + i * sizeof(Value));
        }
      },
      column);
  return column;
}

/// Calls body with an unsigned value of `size` bytes (1, 2, 4 or 8).
template <class Body>
void with_unsigned(std::size_t size, const Body& body) {
  switch (size) {
    case 1:
      return body(std::uint8_t{});
    case 2:
      return body(std::uint16_t{});
    case 4:
      return body(std::uint32_t{});
    default:
      return body(std::uint64_t{});
  }
}

/// Differences (modulo 2^bits) of values `stride` apart; the first `stride` values stay.
std::vector<std::byte> differences(ByteSpan bytes, std::size_t value_size, std::size_t stride) {
  ByteWriter writer;
  with_unsigned(value_size, [&](auto tag) {
    using Bits = decltype(tag);
    const std::size_t back = stride * sizeof(Bits);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(Bits)) {
      const Bits before = at < back ? Bits{0} : load_little_endian<Bits>(&bytes[at - back]);
      writer.write(static_cast<Bits>(load_little_endian<Bits>(&bytes[at]) - before));
    }
  });
  return std::move(writer).bytes();
}

/// Undoes differences().
std::vector<std::byte> sums(ByteSpan bytes, std::size_t value_size, std::size_t stride) {
  ByteWriter writer;
  with_unsigned(value_size, [&](auto tag) {
    using Bits = decltype(tag);
    const std::size_t back = stride * sizeof(Bits);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(Bits)) {
      const Bits before =
          at < back ? Bits{0} : load_little_endian<Bits>(writer.bytes().data() + (at - back));
      writer.write(static_cast<Bits>(load_little_endian<Bits>(&bytes[at]) + before));
    }
  });
  return std::move(writer).bytes();
}

std::vector<std::byte> arrange(std::vector<std::byte> bytes, std::uint8_t form,
                               std::size_t value_size, std::size_t components) {
  if ((form & kDelta) != 0) bytes = differences(bytes, value_size, components);
  if ((form & kPlanes) != 0) bytes = split_planes(bytes, value_size);
  return bytes;
}

std::vector<std::byte> restore(std::vector<std::byte> bytes, std::uint8_t form,
                               std::size_t value_size, std::size_t components) {
  if ((form & kPlanes) != 0) bytes = join_planes(bytes, value_size);
  if ((form & kDelta) != 0) bytes = sums(bytes, value_size, components);
  return bytes;
}

void write_values(ByteWriter& writer, const Attribute& attribute) {
  const std::size_t value_size = size_of(type_of(attribute.values));
  const std::vector<std::byte> bytes = bytes_of(attribute.values);
  std::uint8_t best_form = 0;
  std::size_t best_size = pack(bytes, kTrialLevel).size();
  for (std::uint8_t form = 1; form < kForms; ++form) {
    if (value_size == 1 && (form & kPlanes) != 0) continue;  // one plane: nothing changes
    const std::size_t size =
        pack(arrange(bytes, form, value_size, attribute.components), kTrialLevel).size();
    if (size < best_size) {
      best_form = form;
      best_size = size;
    }
  }
  writer.write(best_form);
  writer.write_bytes(
      pack(arrange(bytes, best_form, value_size, attribute.components), kFinalLevel));
}

Status check_attribute(const Attribute& attribute, std::size_t returns) {
  const auto invalid = [&](const std::string& problem) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("attribute {} {}", quoted(attribute.name), problem)};
  };
  if (attribute.name.empty()) {
    return Error{ErrorCode::invalid_argument, "an attribute has no name; name it or leave it out"};
  }
  if (attribute.components < 1 || attribute.components > kMaxAttributeComponents) {
    return invalid(fmt::format("has {} components, a .curl file holds 1 to {}",
                               attribute.components, kMaxAttributeComponents));
  }
  const std::size_t values = size_of(attribute.values);
  if (values % attribute.components != 0 || values / attribute.components != returns) {
    return invalid(fmt::format("has {} values, {} returns of {} components need {}", values,
                               returns, attribute.components, returns * attribute.components));
  }
  return {};
}

Result<Attribute> read_attribute(PayloadReader& reader, std::uint64_t returns,
                                 std::uint64_t max_bytes) {
  CURLIDAR_TRY_ASSIGN(name, reader.read_text("attribute name", kMaxAttributeNameBytes));
  if (name.empty()) return reader.corrupt("an attribute has no name");
  const auto type_number = reader.read<std::uint8_t>();
  if (type_number >= kScalarTypes) {
    return reader.corrupt(fmt::format("unknown value type {}", type_number));
  }
  const auto type = static_cast<ScalarType>(type_number);
  CURLIDAR_TRY_ASSIGN(components, reader.read_count("components", kMaxAttributeComponents));
  if (components == 0) return reader.corrupt("an attribute has no components");
  const auto form = reader.read<std::uint8_t>();
  CURLIDAR_TRY(reader.check("attribute"));
  if (form >= kForms) return reader.corrupt(fmt::format("unknown form {} of values", form));

  const std::uint64_t bytes_per_return = components * size_of(type);
  if (returns > max_bytes / bytes_per_return) {
    return reader.error(ErrorCode::limit_exceeded,
                        fmt::format("{} returns of {} bytes are more than the limit of {} bytes",
                                    returns, bytes_per_return, max_bytes));
  }
  CURLIDAR_TRY_ASSIGN(packed,
                      unpack_exactly(reader, "attribute values", returns * bytes_per_return));
  const auto stride = static_cast<std::size_t>(components);
  const auto bytes = restore(std::move(packed), form, size_of(type), stride);
  return Attribute{std::move(name), static_cast<std::uint32_t>(components), column_of(type, bytes)};
}

}  // namespace

Result<std::vector<std::byte>> write_attributes(const std::vector<Attribute>& attributes,
                                                std::size_t returns) {
  if (attributes.size() > kMaxAttributes) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} attributes, a .curl file holds at most {}; choose some",
                             attributes.size(), kMaxAttributes)};
  }
  std::set<std::string_view> names;
  ByteWriter writer;
  writer.write_varint(attributes.size());
  for (const Attribute& attribute : attributes) {
    CURLIDAR_TRY(check_attribute(attribute, returns));
    if (!names.insert(attribute.name).second) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("two attributes are named {}; rename one", quoted(attribute.name))};
    }
    CURLIDAR_TRY(write_text(writer, "attribute name " + quoted(attribute.name), attribute.name,
                            kMaxAttributeNameBytes));
    writer.write(static_cast<std::uint8_t>(type_of(attribute.values)));
    writer.write_varint(attribute.components);
    write_values(writer, attribute);
  }
  return std::move(writer).bytes();
}

Result<std::vector<Attribute>> read_attributes(const Chunk& chunk, std::uint64_t returns,
                                               std::uint64_t max_bytes) {
  PayloadReader reader(chunk);
  CURLIDAR_TRY_ASSIGN(count, reader.read_count("attributes", kMaxAttributes));
  std::set<std::string> names;
  std::vector<Attribute> attributes;
  for (std::uint64_t i = 0; i < count; ++i) {
    CURLIDAR_TRY_ASSIGN(attribute, read_attribute(reader, returns, max_bytes));
    if (!names.insert(attribute.name).second) {
      return reader.corrupt(fmt::format("two attributes are named {}", quoted(attribute.name)));
    }
    max_bytes -= size_of(attribute.values) * size_of(type_of(attribute.values));
    attributes.push_back(std::move(attribute));
  }
  CURLIDAR_TRY(reader.finish());
  return attributes;
}

}  // namespace curlidar
