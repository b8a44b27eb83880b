// SPDX-License-Identifier: BSD-3-Clause
#include "records/order.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "base/try.hpp"
#include "format/packed.hpp"
#include "format/payload.hpp"
#include "records/order_syntax.hpp"
#include "records/walk.hpp"
#include "records/walk_search.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kOddBytes = 24;

bool has_walk(const CellGrid& grid) {
  return grid.cells() > 0;
}

WalkRecords follow(const std::optional<Walk>& walk, const CellGrid& grid) {
  return {walk ? walk->cells(grid.columns) : std::vector<std::uint32_t>{}, grid};
}

/// The walk along which the slots cost least; none if there are no cells.
std::optional<Walk> best_walk(const CloudOrder& order, const CellGrid& grid) {
  if (!has_walk(grid)) return std::nullopt;
  std::optional<Walk> best;
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  CloudOrder copy = order;
  for (const Walk& walk : likely_walks(order, grid)) {
    const WalkRecords records(walk.cells(grid.columns), grid);
    CostCounter counter;
    OrderSyntax<CostCounter> syntax(counter, records, grid.columns);
    const bool better = syntax.code(copy, order.slots(), [&] { return counter.cost() < least; });
    if (!better && best) continue;
    least = counter.cost();
    best = walk;
  }
  return best;
}

std::vector<std::byte> odd_bytes(const CloudOrder& order) {
  ByteWriter writer;
  for (const auto& bits : order.odd) {
    for (const std::uint64_t coordinate : bits) writer.write(coordinate);
  }
  return split_planes(writer.bytes(), kOddBytes);
}

Status read_odd(PayloadReader& reader, CloudOrder& order) {
  std::uint64_t count = 0;
  for (const SlotKind kind : order.kind) count += kind == SlotKind::odd ? 1 : 0;
  if (count == 0) return {};
  CURLIDAR_TRY_ASSIGN(planes, unpack_exactly(reader, "odd slots", count * kOddBytes));
  const std::vector<std::byte> bytes = join_planes(planes, kOddBytes);
  ByteReader values(bytes);
  order.odd.resize(static_cast<std::size_t>(count));
  for (auto& bits : order.odd) {
    for (std::uint64_t& coordinate : bits) coordinate = values.read<std::uint64_t>();
    if (slot_kind(slot_position(bits)) != SlotKind::odd) {
      return reader.corrupt("a slot without return holds one");
    }
  }
  return {};
}

Result<CloudOrder> read_shape(PayloadReader& reader, std::uint64_t& slots,
                              std::uint64_t max_slots) {
  CloudOrder order;
  slots = reader.read_varint();
  order.width = reader.read_varint();
  order.height = reader.read_varint();
  const auto type = reader.read<std::uint8_t>();
  CURLIDAR_TRY(reader.check("shape of the cloud"));
  if (type >= std::variant_size_v<Column>) {
    return reader.corrupt(fmt::format("unknown type {} of coordinates", type));
  }
  order.type = static_cast<ScalarType>(type);
  const bool fits = order.width <= UINT32_MAX && order.height <= UINT32_MAX;
  if (!fits || (order.height > 1 && order.width * order.height != slots)) {
    return reader.corrupt(
        fmt::format("a cloud of {} x {} with {} slots", order.width, order.height, slots));
  }
  if (slots > max_slots) {
    return reader.error(
        ErrorCode::limit_exceeded,
        fmt::format("the cloud claims {} slots, the limit is {}", slots, max_slots));
  }
  return order;
}

}  // namespace

WalkRecords::WalkRecords(std::vector<std::uint32_t> cells, const CellGrid& grid)
    : cell(std::move(cells)) {
  std::vector<std::uint32_t> numbers(grid.cells(), kNone);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (grid.occupied[i] != 0) numbers[i] = static_cast<std::uint32_t>(records++);
  }
  record.reserve(cell.size() + grid.loose);
  for (const std::uint32_t at : cell) record.push_back(numbers[at]);
  for (std::size_t i = 0; i < grid.loose; ++i) {
    record.push_back(static_cast<std::uint32_t>(records++));
  }
  holds.reserve(record.size());
  for (const std::uint32_t number : record) holds.push_back(number != kNone ? 1 : 0);
}

std::vector<std::uint32_t> WalkRecords::places() const {
  std::vector<std::uint32_t> places(records);
  for (std::size_t place = 0; place < record.size(); ++place) {
    if (holds[place] != 0) places[record[place]] = static_cast<std::uint32_t>(place);
  }
  return places;
}

std::array<std::uint64_t, 3> slot_bits(const Vec3& p) {
  return {std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y),
          std::bit_cast<std::uint64_t>(p.z)};
}

Vec3 slot_position(const std::array<std::uint64_t, 3>& bits) {
  return {std::bit_cast<double>(bits[0]), std::bit_cast<double>(bits[1]),
          std::bit_cast<double>(bits[2])};
}

Vec3 slot_position(SlotKind kind) {
  constexpr double nan = std::bit_cast<double>(std::uint64_t{0x7ff8} << 48);
  return kind == SlotKind::nan ? Vec3{nan, nan, nan} : Vec3{0, 0, 0};
}

SlotKind slot_kind(const Vec3& position) {
  if (is_return(position)) return SlotKind::point;
  const auto bits = slot_bits(position);
  for (const SlotKind kind : {SlotKind::nan, SlotKind::zero}) {
    if (bits == slot_bits(slot_position(kind))) return kind;
  }
  return SlotKind::odd;
}

CloudOrder order_of(const Cloud& cloud) {
  CloudOrder order;
  order.width = cloud.width;
  order.height = cloud.height;
  order.type = cloud.position_type;
  order.kind.reserve(cloud.size());
  for (const Vec3& position : cloud.positions) {
    order.kind.push_back(slot_kind(position));
    if (order.kind.back() == SlotKind::point) {
      order.record.push_back(static_cast<std::uint32_t>(order.record.size()));
    } else if (order.kind.back() == SlotKind::odd) {
      order.odd.push_back(slot_bits(position));
    }
  }
  return order;
}

std::vector<std::byte> encode_order(const CloudOrder& order, const CellGrid& grid) {
  ByteWriter writer;
  writer.write_varint(order.slots());
  writer.write_varint(order.width);
  writer.write_varint(order.height);
  writer.write(static_cast<std::uint8_t>(order.type));

  RangeEncoder coder;
  const std::optional<Walk> walk = best_walk(order, grid);
  if (walk) write_walk(coder, *walk, grid.columns);
  const WalkRecords records = follow(walk, grid);
  CloudOrder copy = order;
  OrderSyntax<RangeEncoder>(coder, records, grid.columns).code(copy, order.slots(), [] {
    return true;
  });
  const std::vector<std::byte> stream = std::move(coder).finish();
  writer.write_varint(stream.size());
  writer.write_bytes(stream);
  if (!order.odd.empty()) writer.write_bytes(pack(odd_bytes(order)));
  return std::move(writer).bytes();
}

Result<CloudOrder> decode_order(const Chunk& chunk, const CellGrid& grid, std::uint64_t max_slots) {
  PayloadReader reader(chunk);
  std::uint64_t slots = 0;
  CURLIDAR_TRY_ASSIGN(order, read_shape(reader, slots, max_slots));
  const std::size_t records = grid.records();
  if (slots < records) {
    return reader.corrupt(fmt::format("{} slots for {} points", slots, records));
  }
  const std::uint64_t size = reader.read_varint();
  const ByteSpan stream = reader.take(size);
  CURLIDAR_TRY(reader.check("order of the slots"));

  RangeDecoder coder(stream);
  std::optional<Walk> walk;
  if (has_walk(grid)) {
    walk.emplace();
    if (!read_walk(coder, *walk, grid.rows, grid.columns)) {
      return reader.corrupt("the walk over the cells is none");
    }
  }
  const WalkRecords followed = follow(walk, grid);
  order.record.reserve(records);
  OrderSyntax<RangeDecoder> syntax(coder, followed, grid.columns);
  if (!syntax.code(order, slots, [&] { return !coder.exhausted(); }) || coder.exhausted()) {
    return reader.corrupt("the order of the slots is damaged");
  }
  CURLIDAR_TRY(read_odd(reader, order));
  CURLIDAR_TRY(reader.finish());
  return order;
}

}  // namespace curlidar
