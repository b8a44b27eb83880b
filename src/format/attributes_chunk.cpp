// SPDX-License-Identifier: BSD-3-Clause
#include "format/attributes_chunk.hpp"

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "format/packed_values.hpp"
#include "format/payload.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kScalarTypes = std::variant_size_v<Column>;

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

/// Name, type and components; `values` of the type, but empty.
Result<Attribute> read_head(PayloadReader& reader, std::uint64_t count, std::uint64_t max_bytes) {
  CURLIDAR_TRY_ASSIGN(name, reader.read_text("attribute name", kMaxAttributeNameBytes));
  if (name.empty()) return reader.corrupt("an attribute has no name");
  const auto type_number = reader.read<std::uint8_t>();
  if (type_number >= kScalarTypes) {
    return reader.corrupt(fmt::format("unknown value type {}", type_number));
  }
  const auto type = static_cast<ScalarType>(type_number);
  CURLIDAR_TRY_ASSIGN(components, reader.read_count("components", kMaxAttributeComponents));
  if (components == 0) return reader.corrupt("an attribute has no components");

  const std::uint64_t bytes_per_return = components * size_of(type);
  if (count > max_bytes / bytes_per_return) {
    return reader.error(ErrorCode::limit_exceeded,
                        fmt::format("{} returns of {} bytes are more than the limit of {} bytes",
                                    count, bytes_per_return, max_bytes));
  }
  return Attribute{std::move(name), static_cast<std::uint32_t>(components), make_column(type, 0)};
}

Status check_attributes(const std::vector<Attribute>& attributes, std::size_t count) {
  if (attributes.size() > kMaxAttributes) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} attributes, a .curl file holds at most {}; choose some",
                             attributes.size(), kMaxAttributes)};
  }
  std::set<std::string_view> names;
  for (const Attribute& attribute : attributes) {
    CURLIDAR_TRY(check_attribute(attribute, count));
    if (!names.insert(attribute.name).second) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("two attributes are named {}; rename one", quoted(attribute.name))};
    }
  }
  return {};
}

}  // namespace

Result<std::vector<std::byte>> write_attribute_list(const std::vector<Attribute>& attributes,
                                                    std::size_t count,
                                                    const WriteValues& write_values) {
  CURLIDAR_TRY(check_attributes(attributes, count));
  ByteWriter writer;
  writer.write_varint(attributes.size());
  for (const Attribute& attribute : attributes) {
    CURLIDAR_TRY(write_text(writer, "attribute name " + quoted(attribute.name), attribute.name,
                            kMaxAttributeNameBytes));
    writer.write(static_cast<std::uint8_t>(type_of(attribute.values)));
    writer.write_varint(attribute.components);
    write_values(writer, attribute);
  }
  return std::move(writer).bytes();
}

Result<std::vector<Attribute>> read_attribute_list(PayloadReader& reader, std::uint64_t count,
                                                   std::uint64_t max_bytes,
                                                   const ReadValues& read_values) {
  CURLIDAR_TRY_ASSIGN(attribute_count, reader.read_count("attributes", kMaxAttributes));
  std::set<std::string> names;
  std::vector<Attribute> attributes;
  for (std::uint64_t i = 0; i < attribute_count; ++i) {
    CURLIDAR_TRY_ASSIGN(attribute, read_head(reader, count, max_bytes));
    CURLIDAR_TRY(read_values(reader, attribute));
    if (!names.insert(attribute.name).second) {
      return reader.corrupt(fmt::format("two attributes are named {}", quoted(attribute.name)));
    }
    max_bytes -= size_of(attribute.values) * size_of(type_of(attribute.values));
    attributes.push_back(std::move(attribute));
  }
  CURLIDAR_TRY(reader.finish());
  return attributes;
}

Result<std::vector<std::byte>> write_attributes(const std::vector<Attribute>& attributes,
                                                std::size_t returns) {
  return write_attribute_list(attributes, returns, [](ByteWriter& writer, const Attribute& from) {
    write_packed_values(writer, from.values, from.components);
  });
}

Result<std::vector<Attribute>> read_attributes(const Chunk& chunk, std::uint64_t returns,
                                               std::uint64_t max_bytes) {
  PayloadReader reader(chunk);
  const auto read = [&](PayloadReader& from, Attribute& attribute) -> Status {
    CURLIDAR_TRY_ASSIGN(values,
                        read_packed_values(from, type_of(attribute.values), attribute.components,
                                           returns * attribute.components));
    attribute.values = std::move(values);
    return {};
  };
  return read_attribute_list(reader, returns, max_bytes, read);
}

}  // namespace curlidar
