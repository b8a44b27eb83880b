// SPDX-License-Identifier: BSD-3-Clause
// Order and attributes: any bytes are refused or decode to what can be coded again.
#pragma once

#include <algorithm>
#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "hostile/targets/input.hpp"
#include "records/attributes.hpp"
#include "records/order.hpp"

namespace curlidar::test {

/// A grid made up from the front of an input: rows, columns - 1, loose points, how it is filled.
struct FuzzGrid {
  std::uint32_t rows, columns;
  std::size_t loose;
  std::vector<std::uint8_t> occupied;

  explicit FuzzGrid(FuzzInput& input)
      : rows(input.byte() % 17), columns(1 + input.byte() % 64), loose(input.byte()) {
    const auto fill = static_cast<Fill>(input.byte() % 4);
    occupied = fill_flags(input, std::size_t{rows} * columns, fill);
  }
  CellGrid grid() const { return {rows, columns, occupied, loose}; }
};

inline std::string fault_of_order(const CloudOrder& order, std::size_t records) {
  std::vector<std::uint32_t> sorted = order.record;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (sorted[i] != i) return "a record that is there twice or not at all";
  }
  if (sorted.size() != records) return "another number of records";
  const auto count = [&](SlotKind kind) {
    return static_cast<std::size_t>(std::count(order.kind.begin(), order.kind.end(), kind));
  };
  if (count(SlotKind::point) != records) return "another number of points";
  return count(SlotKind::odd) == order.odd.size() ? "" : "another number of odd slots";
}

/// Input: grid, payload. It takes no more than 4096 slots.
inline std::string order_target(ByteSpan bytes) {
  FuzzInput input(bytes);
  const FuzzGrid grid(input);
  const auto order = decode_order({ChunkType::order, input.rest(), 4}, grid.grid(), 4096);
  if (!order) return order.error().message.empty() ? "an error without a message" : "";
  if (order->slots() > 4096) return "more slots than allowed";
  const std::string fault = fault_of_order(*order, grid.grid().records());
  if (!fault.empty()) return fault;
  const std::vector<std::byte> coded = encode_order(*order, grid.grid());
  const auto again = decode_order({ChunkType::order, coded, 0}, grid.grid(), order->slots());
  return again && *again == *order ? "" : "coded again, the order differs";
}

/// The bits of all values.
inline std::vector<std::uint64_t> bits_of(const Column& column) {
  std::vector<std::uint64_t> bits;
  std::visit(
      [&](const auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        for (const Value value : values) {
          bits.push_back(
              static_cast<std::uint64_t>(std::bit_cast<UnsignedOfSize<sizeof(Value)>>(value)));
        }
      },
      column);
  return bits;
}

/// Input: grid, how many slots are no points, payload. The order is made up.
inline std::string records_target(ByteSpan bytes) {
  FuzzInput input(bytes);
  const FuzzGrid grid(input);
  const std::size_t records = grid.grid().records(), others = input.byte();
  CloudOrder order;
  order.kind.assign(records, SlotKind::point);
  order.kind.insert(order.kind.begin() + static_cast<std::ptrdiff_t>(records / 2), others,
                    SlotKind::zero);
  for (std::size_t i = 0; i < records; ++i) {
    order.record.push_back(static_cast<std::uint32_t>(i));
    if (i > 0) std::swap(order.record[i], order.record[mixed(i) % i]);
  }
  std::vector<std::int32_t> ranges, shift;
  for (std::size_t i = 0; i < grid.occupied.size(); ++i) {
    ranges.push_back(static_cast<std::int32_t>(mixed(i)) >> mixed(i + 1) % 16);
  }
  for (std::uint32_t row = 0; row < grid.rows; ++row) {
    shift.push_back(static_cast<std::int32_t>(mixed(row)) % 100);
  }
  const RecordGeometry geometry{grid.grid(), ranges, shift};

  constexpr std::uint64_t kMost = 1 << 20;
  const auto attributes =
      read_records({ChunkType::records, input.rest(), 5}, order, geometry, kMost);
  if (!attributes) return attributes.error().message.empty() ? "an error without a message" : "";
  std::uint64_t size = 0;
  for (const Attribute& attribute : *attributes) {
    size += size_of(attribute.values) * size_of(type_of(attribute.values));
    if (size_of(attribute.values) != order.slots() * attribute.components) {
      return "a wrong number of values";
    }
  }
  if (size > kMost) return "more memory than allowed";
  const auto coded = write_records(*attributes, order, geometry);
  if (!coded) return "cannot be coded again: " + coded.error().message;
  const auto again = read_records({ChunkType::records, *coded, 0}, order, geometry, kMost);
  if (!again || again->size() != attributes->size()) return "coded again, it does not decode";
  for (std::size_t i = 0; i < again->size(); ++i) {
    if (bits_of((*again)[i].values) != bits_of((*attributes)[i].values)) {
      return "coded again, the values differ";
    }
  }
  return "";
}

}  // namespace curlidar::test
