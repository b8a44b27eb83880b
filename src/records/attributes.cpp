// SPDX-License-Identifier: BSD-3-Clause
#include "records/attributes.hpp"

#include <fmt/format.h>

#include <numeric>
#include <type_traits>

#include "base/try.hpp"
#include "format/attributes_chunk.hpp"
#include "format/packed_values.hpp"
#include "format/payload.hpp"
#include "records/column_code.hpp"
#include "records/keys.hpp"

namespace curlidar {
namespace {

// How the values of an attribute are coded: the format's form byte.
constexpr std::uint8_t kPacked = 0;   ///< all slots as bytes
constexpr std::uint8_t kColumns = 1;  ///< a column for each component of the points

/// Attributes of more components are packed.
constexpr std::uint32_t kMaxColumns = 16;

/// Some of the slots of a cloud, each with a value for each column: the points, as records; or the
/// others, as loose ones in the order of the slots.
struct Part {
  std::vector<std::uint64_t> slots;
  RecordGeometry geometry;
  std::vector<std::uint32_t> records;  ///< of each slot

  SequencePlaces places() const { return {geometry, records}; }
};

std::vector<Part> parts_of(const CloudOrder& order, const RecordGeometry& geometry) {
  Part points{{}, geometry, order.record}, others;
  for (std::uint64_t slot = 0; slot < order.slots(); ++slot) {
    (order.kind[slot] == SlotKind::point ? points : others).slots.push_back(slot);
  }
  others.geometry.grid.loose = others.slots.size();
  others.records.resize(others.slots.size());
  std::iota(others.records.begin(), others.records.end(), 0u);
  std::vector<Part> parts;
  if (!points.slots.empty()) parts.push_back(std::move(points));
  if (!others.slots.empty()) parts.push_back(std::move(others));
  return parts;
}

/// Values of some slots.
Column pick(const Column& values, std::uint32_t components,
            const std::vector<std::uint64_t>& slots) {
  return std::visit(
      [&](const auto& column) {
        std::decay_t<decltype(column)> picked;
        picked.reserve(slots.size() * components);
        for (const std::uint64_t slot : slots) {
          const auto begin = column.begin() + static_cast<std::ptrdiff_t>(slot * components);
          picked.insert(picked.end(), begin, begin + components);
        }
        return Column(std::move(picked));
      },
      values);
}

class RecordsWriter {
 public:
  RecordsWriter(const CloudOrder& order, const RecordGeometry& geometry)
      : parts_(parts_of(order, geometry)) {}

  void write(ByteWriter& writer, const Attribute& attribute) const {
    const std::vector<std::byte> packed = pack_slots(attribute);
    const std::vector<std::byte> columns = code_columns(attribute);
    const bool is_packed = columns.empty() || packed.size() <= columns.size();
    writer.write(is_packed ? kPacked : kColumns);
    writer.write_bytes(is_packed ? packed : columns);
  }

 private:
  static std::vector<std::byte> pack_slots(const Attribute& attribute) {
    ByteWriter writer;
    write_packed_values(writer, attribute.values, attribute.components);
    return std::move(writer).bytes();
  }

  /// Empty if there are too many columns.
  std::vector<std::byte> code_columns(const Attribute& attribute) const {
    if (attribute.components > kMaxColumns) return {};
    ByteWriter writer;
    for (const Part& part : parts_) {
      const Column values = pick(attribute.values, attribute.components, part.slots);
      const KeyScale scale = scale_of(values);
      writer.write(static_cast<std::uint8_t>(scale));
      for (std::uint32_t component = 0; component < attribute.components; ++component) {
        const auto keys = keys_of(values, scale, component, attribute.components);
        std::vector<std::int64_t> by_record(keys.size());
        for (std::size_t i = 0; i < keys.size(); ++i) by_record[part.records[i]] = keys[i];
        writer.write_bytes(encode_column(by_record, part.places()));
      }
    }
    return std::move(writer).bytes();
  }

  std::vector<Part> parts_;
};

class RecordsReader {
 public:
  RecordsReader(const CloudOrder& order, const RecordGeometry& geometry)
      : slots_(order.slots()), parts_(parts_of(order, geometry)) {}

  Status read(PayloadReader& reader, Attribute& attribute) const {
    const ScalarType type = type_of(attribute.values);
    const auto form = reader.read<std::uint8_t>();
    CURLIDAR_TRY(reader.check("attribute"));
    if (form == kPacked) {
      CURLIDAR_TRY_ASSIGN(values, read_packed_values(reader, type, attribute.components,
                                                     slots_ * attribute.components));
      attribute.values = std::move(values);
      return {};
    }
    if (form != kColumns || attribute.components > kMaxColumns) {
      return reader.corrupt(fmt::format("unknown form {} of an attribute", form));
    }
    attribute.values = make_column(type, slots_ * attribute.components);
    for (const Part& part : parts_) CURLIDAR_TRY(read_part(reader, part, attribute));
    return {};
  }

 private:
  static Status read_part(PayloadReader& reader, const Part& part, Attribute& attribute) {
    const auto scale = static_cast<KeyScale>(reader.read<std::uint8_t>());
    CURLIDAR_TRY(reader.check("scale of an attribute"));
    if (!is_scale_of(scale, type_of(attribute.values))) {
      return reader.corrupt(
          fmt::format("unknown scale {} of an attribute", static_cast<int>(scale)));
    }
    for (std::uint32_t component = 0; component < attribute.components; ++component) {
      CURLIDAR_TRY_ASSIGN(keys, decode_column(reader, part.records.size(), part.places()));
      for (std::size_t i = 0; i < part.slots.size(); ++i) {
        set_value(attribute.values, part.slots[i] * attribute.components + component, scale,
                  keys[part.records[i]]);
      }
    }
    return {};
  }

  std::size_t slots_;
  std::vector<Part> parts_;
};

}  // namespace

Result<std::vector<std::byte>> write_records(const std::vector<Attribute>& attributes,
                                             const CloudOrder& order,
                                             const RecordGeometry& geometry) {
  const RecordsWriter records(order, geometry);
  return write_attribute_list(
      attributes, order.slots(),
      [&](ByteWriter& writer, const Attribute& attribute) { records.write(writer, attribute); });
}

Result<std::vector<Attribute>> read_records(const Chunk& chunk, const CloudOrder& order,
                                            const RecordGeometry& geometry,
                                            std::uint64_t max_bytes) {
  PayloadReader reader(chunk);
  const RecordsReader records(order, geometry);
  return read_attribute_list(
      reader, order.slots(), max_bytes,
      [&](PayloadReader& from, Attribute& attribute) { return records.read(from, attribute); });
}

}  // namespace curlidar
