// SPDX-License-Identifier: BSD-3-Clause
#include "format/packed_values.hpp"

#include <fmt/format.h>

#include <type_traits>

#include "base/try.hpp"
#include "format/packed.hpp"

namespace curlidar {
namespace {

// How the values of an attribute are arranged before packing; the bits of the format's form byte.
constexpr std::uint8_t kDelta = 1;   // each value less that of the return before it
constexpr std::uint8_t kPlanes = 2;  // first bytes of all values, then second bytes, ...
constexpr std::uint8_t kForms = 4;

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

}  // namespace

void write_packed_values(ByteWriter& writer, const Column& values, std::uint32_t components) {
  const std::size_t value_size = size_of(type_of(values));
  const std::vector<std::byte> bytes = bytes_of(values);
  std::uint8_t best_form = 0;
  std::size_t best_size = pack(bytes, kTrialLevel).size();
  for (std::uint8_t form = 1; form < kForms; ++form) {
    if (value_size == 1 && (form & kPlanes) != 0) continue;  // one plane: nothing changes
    const std::size_t size = pack(arrange(bytes, form, value_size, components), kTrialLevel).size();
    if (size < best_size) {
      best_form = form;
      best_size = size;
    }
  }
  writer.write(best_form);
  writer.write_bytes(pack(arrange(bytes, best_form, value_size, components), kFinalLevel));
}

Result<Column> read_packed_values(PayloadReader& reader, ScalarType type, std::uint64_t components,
                                  std::uint64_t count) {
  const auto form = reader.read<std::uint8_t>();
  CURLIDAR_TRY(reader.check("attribute"));
  if (form >= kForms) return reader.corrupt(fmt::format("unknown form {} of values", form));
  CURLIDAR_TRY_ASSIGN(packed, unpack_exactly(reader, "attribute values", count * size_of(type)));
  const auto stride = static_cast<std::size_t>(components);
  return column_of(type, restore(std::move(packed), form, size_of(type), stride));
}

}  // namespace curlidar
