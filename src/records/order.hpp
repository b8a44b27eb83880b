// SPDX-License-Identifier: BSD-3-Clause
// The order chunk: the slots of a cloud, what each holds and which record it is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"
#include "records/grid.hpp"

namespace curlidar {

/// What a slot of a cloud holds.
enum class SlotKind : std::uint8_t {
  point,  ///< a return: a record
  nan,    ///< three quiet NaN without sign or payload
  zero,   ///< (0, 0, 0), all positive
  odd,    ///< anything else that is no return, kept as raw bits
};

/// The slots of a cloud in their order. Nothing about where its returns are.
struct CloudOrder {
  std::uint64_t width = 0, height = 1;    ///< as the cloud states them
  ScalarType type = ScalarType::float32;  ///< of its coordinates
  std::vector<SlotKind> kind;             ///< of each slot
  std::vector<std::uint32_t> record;      ///< of each point, in the order of the slots
  /// Bits of the coordinates (doubles, as in Cloud) of each odd slot, in the order of the slots.
  std::vector<std::array<std::uint64_t, 3>> odd;

  std::size_t slots() const { return kind.size(); }
  friend bool operator==(const CloudOrder&, const CloudOrder&) = default;
};

/// The kind of a slot with these coordinates.
SlotKind slot_kind(const Vec3& position);
/// The coordinates of a nan or zero slot.
Vec3 slot_position(SlotKind kind);
/// Bits of the coordinates of an odd slot, and back.
std::array<std::uint64_t, 3> slot_bits(const Vec3& position);
Vec3 slot_position(const std::array<std::uint64_t, 3>& bits);

/// Kinds, odd bits, shape and type of a cloud, its returns numbered in their own order.
CloudOrder order_of(const Cloud& cloud);

/// The payload. Every record of the grid must be in `order.record` exactly once. Costs next to
/// nothing where the slots follow the cells ring by ring or firing by firing, with or without slots
/// for empty cells; else what a permutation takes. O(n log n).
std::vector<std::byte> encode_order(const CloudOrder& order, const CellGrid& grid);

/// The order of the slots of a cloud whose records lie in `grid`. Errors: corrupt, limit_exceeded
/// (more than max_slots). Whatever the bytes, every record is in `record` exactly once.
/// O(n log n + cells).
Result<CloudOrder> decode_order(const Chunk& chunk, const CellGrid& grid, std::uint64_t max_slots);

}  // namespace curlidar
