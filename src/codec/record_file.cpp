// SPDX-License-Identifier: BSD-3-Clause
#include "codec/record_file.hpp"

#include <cmath>
#include <utility>

#include "base/float32.hpp"
#include "base/try.hpp"
#include "codec/cell_points.hpp"
#include "format/payload.hpp"
#include "records/attributes.hpp"
#include "records/corrections.hpp"
#include "records/loose.hpp"

namespace curlidar {
namespace {

/// Flags of the promise chunk.
constexpr std::uint8_t kPromisesBound = 1, kPromisesBits = 2, kAnyOrder = 4;

}  // namespace

bool has_records(const std::vector<Chunk>& chunks) {
  return find_chunk(chunks, ChunkType::order) != nullptr;
}

Status check_no_records(const std::vector<Chunk>& chunks) {
  for (const ChunkType type : {ChunkType::loose, ChunkType::corrections, ChunkType::records}) {
    if (const Chunk* chunk = find_chunk(chunks, type)) {
      return PayloadReader(*chunk).corrupt("its points have no order: there is no order chunk");
    }
  }
  return {};
}

void round_to(ScalarType type, std::vector<Vec3>& points) {
  if (type != ScalarType::float32) return;
  for (Vec3& p : points) {
    p = {round_to_float32(p.x), round_to_float32(p.y), round_to_float32(p.z)};
  }
}

RecordCells::RecordCells(const compact::RowTable& table, const compact::Image& image)
    : image_(image) {
  occupied_.reserve(image.range.size());
  for (const std::int32_t range : image.range) {
    occupied_.push_back(range > 0 ? 1 : 0);
    if (range > 0) ranges_.push_back(range);
  }
  if (!table.rays) return;
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    column_shift_.push_back(table.rays->column_shift(row));
  }
}

RecordGeometry RecordCells::geometry(std::size_t loose) const {
  return {grid(loose), image_.range, column_shift_};
}

Result<std::vector<Vec3>> decode_cell_points(const std::vector<Chunk>& chunks,
                                             const compact::RowTable& table,
                                             const compact::Image& image,
                                             const compact::Image* coarse) {
  std::vector<DirectionOffset> offsets;
  if (const Chunk* chunk = find_chunk(chunks, ChunkType::directions)) {
    if (table.rays || image.rows == 0) {
      return PayloadReader(*chunk).corrupt("offsets of directions without even columns");
    }
    const RecordCells cells(table, image);
    CURLIDAR_TRY_ASSIGN(decoded, decode_directions(*chunk, cells.grid(0), cells.ranges()));
    offsets = std::move(decoded);
  }
  if (coarse == nullptr) return cell_points(table, image, offsets);
  for (std::size_t cell = 0; cell < image.range.size(); ++cell) {
    if ((image.range[cell] > 0) != (coarse->range[cell] > 0)) {
      return Error{ErrorCode::corrupt, "the field and its residuals do not cover the same cells"};
    }
  }
  return cell_points(table, *coarse, offsets);
}

Result<DecodedRecords> decode_records(const std::vector<Chunk>& chunks,
                                      const compact::RowTable& table, const compact::Image& image,
                                      const compact::Image* coarse, const DecodeLimits& limits) {
  DecodedRecords out;
  CURLIDAR_TRY_ASSIGN(points, decode_cell_points(chunks, table, image, coarse));
  out.points = std::move(points);
  if (const Chunk* chunk = find_chunk(chunks, ChunkType::loose)) {
    CURLIDAR_TRY_ASSIGN(loose, decode_loose(*chunk, limits.max_cells));
    out.loose = loose.size();
    out.points.insert(out.points.end(), loose.begin(), loose.end());
  }
  const RecordCells cells(table, image);
  CURLIDAR_TRY_ASSIGN(order_chunk, require_chunk(chunks, ChunkType::order));
  CURLIDAR_TRY_ASSIGN(order, decode_order(order_chunk, cells.grid(out.loose), limits.max_cells));
  out.order = std::move(order);
  round_to(out.order.type, out.points);
  if (const Chunk* chunk = find_chunk(chunks, ChunkType::corrections);
      chunk != nullptr && coarse == nullptr) {
    CURLIDAR_TRY(apply_corrections(*chunk, out.order.type, out.points));
  }
  if (const Chunk* chunk = find_chunk(chunks, ChunkType::records)) {
    CURLIDAR_TRY_ASSIGN(
        attributes, read_records(*chunk, out.order, cells.geometry(out.loose), limits.max_bytes));
    out.attributes = std::move(attributes);
  }
  return out;
}

Cloud assemble_cloud(const DecodedRecords& records) {
  const CloudOrder& order = records.order;
  Cloud cloud;
  cloud.position_type = order.type;
  cloud.width = static_cast<std::uint32_t>(order.width);
  cloud.height = static_cast<std::uint32_t>(order.height);
  cloud.attributes = records.attributes;
  cloud.positions.reserve(order.slots());
  std::size_t point = 0, odd = 0;
  for (const SlotKind kind : order.kind) {
    switch (kind) {
      case SlotKind::point:
        cloud.positions.push_back(records.points[order.record[point++]]);
        break;
      case SlotKind::odd:
        cloud.positions.push_back(slot_position(order.odd[odd++]));
        break;
      default:
        cloud.positions.push_back(slot_position(kind));
    }
  }
  return cloud;
}

std::vector<Attribute> attributes_of_records(const DecodedRecords& records) {
  const CloudOrder& order = records.order;
  std::vector<std::uint32_t> slot_of_record(records.points.size(), 0);
  std::size_t point = 0;
  for (std::uint32_t slot = 0; slot < order.slots(); ++slot) {
    if (order.kind[slot] == SlotKind::point) slot_of_record[order.record[point++]] = slot;
  }
  Cloud slots;
  slots.positions.resize(order.slots());
  slots.attributes = records.attributes;
  return select(slots, slot_of_record).attributes;
}

std::vector<std::byte> write_promise(const RecordPromise& promise) {
  ByteWriter writer;
  const bool bound = !promise.bit_exact && promise.bound_m > 0;
  const int flags = (bound ? kPromisesBound : 0) | (promise.bit_exact ? kPromisesBits : 0) |
                    (promise.any_order ? kAnyOrder : 0);
  writer.write(static_cast<std::uint8_t>(flags));
  if (bound) writer.write(promise.bound_m);
  return std::move(writer).bytes();
}

Result<RecordPromise> read_promise(const std::vector<Chunk>& chunks) {
  RecordPromise promise;
  const Chunk* chunk = find_chunk(chunks, ChunkType::promise);
  if (chunk == nullptr) return promise;
  PayloadReader reader(*chunk);
  const auto flags = reader.read<std::uint8_t>();
  if (flags > (kPromisesBound | kPromisesBits | kAnyOrder)) {
    return Error{ErrorCode::unsupported, "the file promises what only a newer curlidar knows"};
  }
  constexpr int kBoth = kPromisesBound | kPromisesBits;
  if (flags == 0 || (flags & kBoth) == kBoth) {
    return reader.corrupt("no promise, or two of the coordinates");
  }
  promise.bit_exact = (flags & kPromisesBits) != 0;
  promise.any_order = (flags & kAnyOrder) != 0;
  if ((flags & kPromisesBound) != 0) {
    promise.bound_m = reader.read<double>();
    if (!(promise.bound_m > 0) || !std::isfinite(promise.bound_m)) {
      return reader.corrupt("a bound that is no length");
    }
  }
  CURLIDAR_TRY(reader.finish());
  return promise;
}

}  // namespace curlidar
