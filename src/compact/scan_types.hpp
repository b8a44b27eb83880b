// SPDX-License-Identifier: BSD-3-Clause
// A whole scan in the compact profile's integers: its image, its rows, its cut into segments, and
// the chunks that it becomes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "compact/geometry.hpp"
#include "compact/ray_table.hpp"

namespace curlidar::compact {

/// One range for each cell, row-major, row 0 the highest ring.
struct Image {
  std::uint32_t rows = 0, columns = 0;
  std::vector<std::int32_t> range;  ///< Q16 metres, 0 = empty

  std::size_t cells() const { return std::size_t{rows} * columns; }
};

/// Most rows of an image, and most columns of a turn.
inline constexpr std::uint32_t kMaxRows = 1u << 16;
inline constexpr std::uint32_t kMaxTurnColumns = 1u << 22;
/// Elevations lie strictly within a quarter turn of level.
inline constexpr std::int32_t kMaxElevation = 1 << 30;
/// |height| and |range_offset| of a row are at most this: 64 m.
inline constexpr std::int32_t kMaxRowOffset = 1 << 22;
/// Numbers of a table may be multiples of up to 2^kMaxTableShift.
inline constexpr std::uint32_t kMaxTableShift = 24;

/// What is known of an image's rows: where each looks, and how its sensor measures. Every number is
/// a multiple of 2^(its shift), which is what makes a table small.
struct RowTable {
  std::uint32_t turn_columns = 0;  ///< columns of a full turn
  std::uint32_t first_column = 0;  ///< of the turn, where the image's column 0 lies

  std::vector<std::int32_t> elevation;  ///< of each row: binary angles, the highest first
  /// Q16 metres: a point at range r is seen at elevation + height / r. Empty = all 0.
  std::vector<std::int32_t> height;
  /// Q16 metres: field and residual code range - range_offset. Empty = all 0.
  std::vector<std::int32_t> range_offset;

  std::uint32_t elevation_shift = 0, height_shift = 0, offset_shift = 0;

  /// The sensor's own rays, if cells are those: then `height` is empty, turn_columns the number of
  /// firings, and elevations are those of the rays and in any order.
  std::optional<RayTable> rays;

  friend bool operator==(const RowTable&, const RowTable&) = default;
};

/// Rounds every number of a table to the nearest multiple of 2^(its shift).
void round_to_shifts(RowTable& table);

/// What a decoder must know before the first cell.
struct ScanParameters {
  std::uint32_t rows = 0, columns = 0;
  std::int32_t step = 0;           ///< D of the field, Q16 metres, 1..kMaxStep
  std::int32_t residual_step = 0;  ///< of the residual layer, Q16 metres; 0 = there is none
  /// If not 0: residual levels are multiples of this many 2^-32 m, as ResidualLevels has them;
  /// residual_step is then lattice_q32 / 2^16.
  std::uint64_t lattice_q32 = 0;
  std::uint32_t root_log2 = 4;  ///< roots of 2^root_log2 cells a side, 1..5
  std::uint32_t smallest_leaf = 8;
  std::uint32_t bands = 1, sectors = 1;  ///< of rows and of columns: bands * sectors segments

  friend bool operator==(const ScanParameters&, const ScanParameters&) = default;
};

inline constexpr std::int32_t kMaxStep = 1 << 24;
/// Of lattice_q32.
inline constexpr std::uint64_t kLeastLattice = std::uint64_t{1} << 16;
inline constexpr std::uint64_t kMostLattice = std::uint64_t{1} << 40;
inline constexpr std::uint32_t kMaxSegments = 4096;

/// A part of the image that is coded on its own: rows row .. row + rows - 1, likewise columns.
struct SegmentPlace {
  std::uint32_t row = 0, column = 0, rows = 0, columns = 0;

  std::size_t cells() const { return std::size_t{rows} * columns; }
};

/// The segments of a scan in the order of the format: band by band, in each sector by sector. Band
/// i begins at row floor(i * rows / bands), sectors likewise.
std::vector<SegmentPlace> segments_of(const ScanParameters& parameters);

/// The directions of one segment's cells.
Geometry geometry_of(const RowTable& table, const SegmentPlace& place);

/// Kinds of chunk, with the types that a container numbers them by.
enum class ScanPart : std::uint8_t {
  parameters = 0x10,
  sensor = 0x11,
  index = 0x12,
  mask = 0x13,      ///< one for each segment, in the order of the segments
  field = 0x14,     ///< likewise
  residual = 0x15,  ///< likewise, if there is a residual layer
  rays = 0x16,      ///< if cells are the sensor's own rays
  prediction = 0x17,  ///< of predicted scans: behind the parameters
};
/// "compact_parameters", ... as the container names them.
const char* to_string(ScanPart part);

/// A chunk to write.
struct ScanChunk {
  ScanPart part = ScanPart::parameters;
  std::vector<std::byte> payload;
};

/// A chunk that was read.
struct ScanChunkView {
  ScanPart part = ScanPart::parameters;
  ByteSpan payload;
  std::size_t offset = 0;  ///< of the payload in the file, for messages
  bool whole = true;       ///< false: cut off, the payload's end is missing
};

}  // namespace curlidar::compact
