// SPDX-License-Identifier: BSD-3-Clause
// Loose points, corrections and directions: any bytes are refused or decode to what can be coded
// again.
#pragma once

#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "base/float32.hpp"
#include "hostile/targets/input.hpp"
#include "records/corrections.hpp"
#include "records/directions.hpp"
#include "records/loose.hpp"

namespace curlidar::test {

inline bool is_finite_of(ScalarType type, double x) {
  return std::isfinite(x) && (type == ScalarType::float64 || round_to_float32(x) == x);
}
inline bool all_of_type(ScalarType type, const std::vector<Vec3>& points) {
  for (const Vec3& p : points) {
    if (!is_finite_of(type, p.x) || !is_finite_of(type, p.y) || !is_finite_of(type, p.z)) {
      return false;
    }
  }
  return true;
}

/// Input: payload. It takes no more than 512 points.
inline std::string loose_target(ByteSpan bytes) {
  const auto points = decode_loose({ChunkType::loose, bytes, 0}, 512);
  if (!points) return points.error().message.empty() ? "an error without a message" : "";
  const auto type = static_cast<ScalarType>(bytes[1]);
  if (points->size() > 512) return "more points than allowed";
  if (!all_of_type(type, *points)) return "a point that is not finite or not of its type";
  const auto coded = encode_loose(*points, type, {});
  if (!coded) return "cannot be coded again: " + coded.error().message;
  const auto again = decode_loose({ChunkType::loose, coded->bytes, 0}, points->size());
  return again && *again == *points ? "" : "coded again, the points differ";
}

/// Float32 coordinates within 128 of the origin.
inline std::vector<Vec3> made_up_points(std::size_t count) {
  std::size_t number = 0;
  const auto any = [&] {
    return round_to_float32(static_cast<std::int32_t>(mixed(number++)) * 0x1p-24);
  };
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {any(), any(), any()};
  return points;
}

/// Input: number of points, type (odd: float64), payload. made_up_points are predicted.
inline std::string corrections_target(ByteSpan bytes) {
  FuzzInput input(bytes);
  const std::vector<Vec3> predicted = made_up_points(input.byte());
  const ScalarType type = (input.byte() & 1) != 0 ? ScalarType::float64 : ScalarType::float32;
  std::vector<Vec3> points = predicted;
  const Status applied = apply_corrections({ChunkType::corrections, input.rest(), 2}, type, points);
  if (!applied) return applied.error().message.empty() ? "an error without a message" : "";
  if (!all_of_type(type, points)) return "a point that is not finite or not of its type";
  const auto coded = encode_corrections(predicted, points, type, {});
  if (!coded) return "cannot be coded again: " + coded.error().message;
  std::vector<Vec3> again = predicted;
  if (!apply_corrections({ChunkType::corrections, coded->bytes, 0}, type, again) ||
      again != points) {
    return "coded again, the points differ";
  }
  return "";
}

/// Input: rows, columns, fill (2 bits) and nearness (from bit 2), payload.
inline std::string directions_target(ByteSpan bytes) {
  FuzzInput input(bytes);
  const std::uint32_t rows = input.byte() % 32, columns = input.byte() % 64;
  const std::uint32_t options = input.byte();
  const auto occupied =
      fill_flags(input, std::size_t{rows} * columns, static_cast<Fill>(options & 3));
  const CellGrid grid{rows, columns, occupied, 0};
  std::vector<std::int32_t> ranges;
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    const std::uint32_t nearness = 2 + (options >> 2 & 15);
    if (occupied[i] != 0) ranges.push_back(1 + static_cast<std::int32_t>(mixed(i) >> nearness));
  }
  const Chunk chunk{ChunkType::directions, input.rest(), 3};
  const auto offsets = decode_directions(chunk, grid, ranges);
  if (!offsets) return offsets.error().message.empty() ? "an error without a message" : "";
  if (offsets->size() != ranges.size()) return "not one offset for each cell";
  const auto step = static_cast<std::int32_t>(ByteReader(chunk.payload).read_varint());
  const CodedDirections coded = encode_directions(grid, ranges, *offsets, step);
  const auto again = decode_directions({ChunkType::directions, coded.bytes, 0}, grid, ranges);
  return again && *again == coded.decoded ? "" : "coded again, the offsets differ";
}

}  // namespace curlidar::test
