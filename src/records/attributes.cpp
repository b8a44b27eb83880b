// SPDX-License-Identifier: BSD-3-Clause
#include "records/attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
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

/// Slots that are points, and the others, in their order.
struct Slots {
  std::vector<std::uint64_t> points, others;

  explicit Slots(const CloudOrder& order) {
    for (std::uint64_t slot = 0; slot < order.slots(); ++slot) {
      (order.kind[slot] == SlotKind::point ? points : others).push_back(slot);
    }
  }
};

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

/// Undoes pick().
void place(Column& values, std::uint32_t components, const std::vector<std::uint64_t>& slots,
           const Column& picked) {
  std::visit(
      [&](auto& column) {
        const auto& from = std::get<std::decay_t<decltype(column)>>(picked);
        for (std::size_t i = 0; i < slots.size(); ++i) {
          std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(i * components), components,
                      column.begin() + static_cast<std::ptrdiff_t>(slots[i] * components));
        }
      },
      values);
}

class RecordsWriter {
 public:
  RecordsWriter(const CloudOrder& order, const RecordGeometry& geometry)
      : order_(order), slots_(order), places_{geometry, order.record} {}

  void write(ByteWriter& writer, const Attribute& attribute) const {
    const std::vector<std::byte> packed = pack_slots(attribute);
    std::vector<std::byte> columns = code_columns(attribute);
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
    const Column points = pick(attribute.values, attribute.components, slots_.points);
    const KeyScale scale = scale_of(points);
    writer.write(static_cast<std::uint8_t>(scale));
    for (std::uint32_t component = 0; component < attribute.components; ++component) {
      const auto keys = keys_of(points, scale, component, attribute.components);
      std::vector<std::int64_t> by_record(keys.size());
      for (std::size_t i = 0; i < keys.size(); ++i) by_record[order_.record[i]] = keys[i];
      writer.write_bytes(encode_column(by_record, places_));
    }
    if (!slots_.others.empty()) {
      write_packed_values(writer, pick(attribute.values, attribute.components, slots_.others),
                          attribute.components);
    }
    return std::move(writer).bytes();
  }

  const CloudOrder& order_;
  Slots slots_;
  SequencePlaces places_;
};

class RecordsReader {
 public:
  RecordsReader(const CloudOrder& order, const RecordGeometry& geometry)
      : order_(order), slots_(order), places_{geometry, order.record} {}

  Status read(PayloadReader& reader, Attribute& attribute) const {
    const ScalarType type = type_of(attribute.values);
    const auto form = reader.read<std::uint8_t>();
    CURLIDAR_TRY(reader.check("attribute"));
    if (form == kPacked) {
      CURLIDAR_TRY_ASSIGN(values, read_packed_values(reader, type, attribute.components,
                                                     order_.slots() * attribute.components));
      attribute.values = std::move(values);
      return {};
    }
    if (form != kColumns || attribute.components > kMaxColumns) {
      return reader.corrupt(fmt::format("unknown form {} of an attribute", form));
    }
    attribute.values = make_column(type, order_.slots() * attribute.components);
    return read_columns(reader, attribute);
  }

 private:
  Status read_columns(PayloadReader& reader, Attribute& attribute) const {
    const auto scale = static_cast<KeyScale>(reader.read<std::uint8_t>());
    CURLIDAR_TRY(reader.check("scale of an attribute"));
    const ScalarType type = type_of(attribute.values);
    if (!is_scale_of(scale, type)) {
      return reader.corrupt(
          fmt::format("unknown scale {} of an attribute", static_cast<int>(scale)));
    }
    for (std::uint32_t component = 0; component < attribute.components; ++component) {
      CURLIDAR_TRY_ASSIGN(keys, decode_column(reader, order_.record.size(), places_));
      for (std::size_t i = 0; i < slots_.points.size(); ++i) {
        set_value(attribute.values, slots_.points[i] * attribute.components + component, scale,
                  keys[order_.record[i]]);
      }
    }
    if (slots_.others.empty()) return {};
    CURLIDAR_TRY_ASSIGN(others, read_packed_values(reader, type, attribute.components,
                                                   slots_.others.size() * attribute.components));
    place(attribute.values, attribute.components, slots_.others, others);
    return {};
  }

  const CloudOrder& order_;
  Slots slots_;
  SequencePlaces places_;
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
