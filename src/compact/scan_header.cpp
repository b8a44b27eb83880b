// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_header.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/try.hpp"
#include "compact/ray_chunk.hpp"
#include "compact/row_sequence.hpp"

namespace curlidar::compact {
namespace {

// Flags of the parameters; the lowest three bits are root_log2.
constexpr std::uint32_t kHasResidual = 1u << 3, kHasSegments = 1u << 4, kHasTurn = 1u << 5,
                        kHasLattice = 1u << 6;
constexpr std::uint32_t kReserved = 1u << 7;
// Flags of the sensor table.
constexpr std::uint32_t kHasHeights = 1u << 0, kHasOffsets = 1u << 1, kHasRays = 1u << 2;

constexpr std::uint32_t kMaxRootLog2 = 5;
constexpr std::uint32_t kMaxSmallestLeaf = 1u << (2 * kMaxRootLog2);

Error invalid(std::string what) {
  return {ErrorCode::invalid_argument, std::move(what)};
}

/// Whether the values are multiples of 2^shift within [-limit, limit].
Status check_sequence(const std::vector<std::int32_t>& values, std::uint32_t shift,
                      std::int32_t limit, std::string_view name) {
  if (shift > kMaxTableShift)
    return invalid(fmt::format("the shift of the {}s is above {}", name, kMaxTableShift));
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] < -limit || values[k] > limit) {
      return invalid(fmt::format("the {} of row {} is out of range", name, k));
    }
    if ((static_cast<std::uint32_t>(values[k]) & ((1u << shift) - 1)) != 0) {
      return invalid(fmt::format(
          "the {} of row {} is not a multiple of 2^{}; round the table first", name, k, shift));
    }
  }
  return {};
}

/// What is wrong with the sizes, empty if nothing: the same for writers and readers.
std::string fault_of(const ScanParameters& p, const RowTable& t) {
  if (p.rows == 0 || p.rows > kMaxRows)
    return fmt::format("{} rows; 1..{} are possible", p.rows, kMaxRows);
  if (t.turn_columns == 0 || t.turn_columns > kMaxTurnColumns) {
    return fmt::format("{} columns in a turn; 1..{} are possible", t.turn_columns, kMaxTurnColumns);
  }
  if (p.columns == 0 || p.columns > t.turn_columns) {
    return fmt::format("{} columns; 1..{} of a turn are possible", p.columns, t.turn_columns);
  }
  if (t.first_column >= t.turn_columns)
    return fmt::format("first column {} of {}", t.first_column, t.turn_columns);
  if (p.step < 1 || p.step > kMaxStep)
    return fmt::format("field step {}; 1..{} are possible", p.step, kMaxStep);
  if (p.residual_step < 0 || p.residual_step > kMaxStep) {
    return fmt::format("residual step {}; 1..{} are possible", p.residual_step, kMaxStep);
  }
  if (p.lattice_q32 != 0 && (p.lattice_q32 < kLeastLattice || p.lattice_q32 > kMostLattice)) {
    return fmt::format("lattice of {} / 2^32 m; 2^16..2^40 are possible", p.lattice_q32);
  }
  if (p.root_log2 < 1 || p.root_log2 > kMaxRootLog2) {
    return fmt::format("roots of 2^{} cells; 1..{} are possible", p.root_log2, kMaxRootLog2);
  }
  if (p.smallest_leaf < 1 || p.smallest_leaf > kMaxSmallestLeaf) {
    return fmt::format("smallest leaf of {} cells; 1..{} are possible", p.smallest_leaf,
                       kMaxSmallestLeaf);
  }
  if (p.bands < 1 || p.bands > p.rows || p.sectors < 1 || p.sectors > p.columns ||
      std::uint64_t{p.bands} * p.sectors > kMaxSegments) {
    return fmt::format("{} x {} segments; at least a cell each and {} in all are possible", p.bands,
                       p.sectors, kMaxSegments);
  }
  return {};
}

/// A varint that fits 32 bits; anything larger becomes 2^32 - 1, which no check passes.
std::uint32_t read_small(ByteReader& reader) {
  const std::uint64_t value = reader.read_varint();
  return value > UINT32_MAX ? UINT32_MAX : static_cast<std::uint32_t>(value);
}

std::int32_t read_step(ByteReader& reader) {
  const std::uint32_t value = read_small(reader);
  return value > INT32_MAX ? INT32_MAX : static_cast<std::int32_t>(value);
}

/// Step or lattice of the residual layer; what no check passes where there should be one and is
/// not.
void read_residual_levels(ByteReader& reader, std::uint32_t flags, ScanParameters& p) {
  if ((flags & kHasLattice) != 0) {
    p.lattice_q32 = reader.read_varint();
    const bool possible = (flags & kHasResidual) != 0 && p.lattice_q32 >= kLeastLattice &&
                          p.lattice_q32 <= kMostLattice;
    p.residual_step = possible ? static_cast<std::int32_t>(p.lattice_q32 >> 16) : -1;
  } else if ((flags & kHasResidual) != 0) {
    const std::int32_t step = read_step(reader);
    p.residual_step = step == 0 ? -1 : step;
  }
}

}  // namespace

Error scan_error(ErrorCode code, ScanPart part, std::size_t offset, std::string_view what) {
  return {code, fmt::format("{} chunk, byte {}: {}", to_string(part), offset, what)};
}

Status check_header(const ScanParameters& p, const RowTable& t) {
  if (const std::string fault = fault_of(p, t); !fault.empty()) return invalid(fault);
  if (t.elevation.size() != p.rows) {
    return invalid(fmt::format("the table has {} rows, the image {}", t.elevation.size(), p.rows));
  }
  if ((!t.height.empty() && t.height.size() != p.rows) ||
      (!t.range_offset.empty() && t.range_offset.size() != p.rows)) {
    return invalid("heights and range offsets need one number for each row, or none at all");
  }
  if (t.rays) {
    CURLIDAR_TRY(check_rays(t, p.rows, p.columns));
    return check_sequence(t.range_offset, t.offset_shift, kMaxRowOffset, "range offset");
  }
  CURLIDAR_TRY(check_sequence(t.elevation, t.elevation_shift, kMaxElevation, "elevation"));
  CURLIDAR_TRY(check_sequence(t.height, t.height_shift, kMaxRowOffset, "height"));
  return check_sequence(t.range_offset, t.offset_shift, kMaxRowOffset, "range offset");
}

std::vector<std::byte> write_parameters(const ScanParameters& p, const RowTable& t) {
  ByteWriter writer;
  const bool segments = p.bands * p.sectors > 1;
  const bool turn = t.turn_columns != p.columns || t.first_column != 0;
  writer.write(static_cast<std::uint8_t>(p.root_log2 | (p.residual_step > 0 ? kHasResidual : 0) |
                                         (segments ? kHasSegments : 0) | (turn ? kHasTurn : 0) |
                                         (p.lattice_q32 != 0 ? kHasLattice : 0)));
  writer.write_varint(p.rows);
  writer.write_varint(p.columns);
  writer.write_varint(static_cast<std::uint32_t>(p.step));
  writer.write_varint(p.smallest_leaf);
  if (p.lattice_q32 != 0) {
    writer.write_varint(p.lattice_q32);
  } else if (p.residual_step > 0) {
    writer.write_varint(static_cast<std::uint32_t>(p.residual_step));
  }
  if (segments) {
    writer.write_varint(p.bands);
    writer.write_varint(p.sectors);
  }
  if (turn) {
    writer.write_varint(t.turn_columns);
    writer.write_varint(t.first_column);
  }
  return std::move(writer).bytes();
}

Result<ScanHeader> read_parameters(const ScanChunkView& chunk, const ScanLimits& limits) {
  ByteReader reader(chunk.payload);
  ScanHeader header;
  ScanParameters& p = header.parameters;
  RowTable& t = header.table;
  const std::uint32_t flags = reader.read<std::uint8_t>();
  if ((flags & kReserved) != 0) {
    return scan_error(ErrorCode::unsupported, chunk.part, chunk.offset,
                      "flags of a later version; use a newer release of curlidar");
  }
  p.root_log2 = flags & 7;
  p.rows = read_small(reader);
  p.columns = read_small(reader);
  p.step = read_step(reader);
  p.smallest_leaf = read_small(reader);
  read_residual_levels(reader, flags, p);
  if ((flags & kHasSegments) != 0) {
    p.bands = read_small(reader);
    p.sectors = read_small(reader);
  }
  t.turn_columns = p.columns;
  if ((flags & kHasTurn) != 0) {
    t.turn_columns = read_small(reader);
    t.first_column = read_small(reader);
  }
  const std::size_t at = chunk.offset + reader.offset();
  if (!reader.ok()) {
    return scan_error(ErrorCode::corrupt, chunk.part, at, "the payload ends inside the parameters");
  }
  if (reader.remaining() != 0) {
    return scan_error(ErrorCode::corrupt, chunk.part, at,
                      fmt::format("{} unexpected bytes at the end", reader.remaining()));
  }
  if (const std::string fault = fault_of(p, t); !fault.empty()) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset, fault);
  }
  // Cells and surfaces are numbered in 31 bits.
  const std::uint64_t most = std::min<std::uint64_t>(limits.max_cells, INT32_MAX);
  if (std::uint64_t{p.rows} * p.columns > most) {
    return scan_error(ErrorCode::limit_exceeded, chunk.part, chunk.offset,
                      fmt::format("{} x {} cells are more than the limit of {}; raise it if the "
                                  "file is trusted",
                                  p.rows, p.columns, most));
  }
  return header;
}

std::vector<std::byte> write_rows(const RowTable& t) {
  const std::uint32_t flags = (t.height.empty() ? 0 : kHasHeights) |
                              (t.range_offset.empty() ? 0 : kHasOffsets) | (t.rays ? kHasRays : 0);
  std::vector<std::byte> payload{static_cast<std::byte>(flags)};
  RangeEncoder encoder;
  if (!t.rays) {
    write_sequence(encoder, t.elevation, t.elevation_shift, SequenceKind::steady_differences);
  }
  if (!t.height.empty()) write_sequence(encoder, t.height, t.height_shift, SequenceKind::steady);
  if (!t.range_offset.empty()) {
    write_sequence(encoder, t.range_offset, t.offset_shift, SequenceKind::steady);
  }
  const std::vector<std::byte> coded = std::move(encoder).finish();
  payload.insert(payload.end(), coded.begin(), coded.end());
  return payload;
}

Status read_rows(const ScanChunkView& chunk, std::uint32_t rows, RowTable& t) {
  const auto corrupt = [&](std::string_view what) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset, what);
  };
  if (chunk.payload.empty()) return corrupt("the payload is empty");
  const auto flags = static_cast<std::uint32_t>(chunk.payload[0]);
  if ((flags & ~(kHasHeights | kHasOffsets | kHasRays)) != 0) {
    return scan_error(ErrorCode::unsupported, chunk.part, chunk.offset,
                      "flags of a later version; use a newer release of curlidar");
  }
  if ((flags & kHasRays) != 0) {
    if ((flags & kHasHeights) != 0) return corrupt("heights beside rays");
    t.rays.emplace();
  }
  RangeDecoder decoder(chunk.payload.subspan(1));
  bool good = t.rays || read_sequence(decoder, rows, kMaxElevation, t.elevation, t.elevation_shift,
                                      SequenceKind::steady_differences);
  if (good && (flags & kHasHeights) != 0) {
    good =
        read_sequence(decoder, rows, kMaxRowOffset, t.height, t.height_shift, SequenceKind::steady);
  }
  if (good && (flags & kHasOffsets) != 0) {
    good = read_sequence(decoder, rows, kMaxRowOffset, t.range_offset, t.offset_shift,
                         SequenceKind::steady);
  }
  if (decoder.exhausted()) return corrupt("the payload ends inside the table");
  if (!good) return corrupt("a number of the table is out of range");
  if (!decoder.finished()) return corrupt("unexpected bytes at the end");
  return {};
}

std::vector<std::byte> write_index(const std::vector<std::uint64_t>& sizes) {
  ByteWriter writer;
  for (const std::uint64_t size : sizes) writer.write_varint(size);
  return std::move(writer).bytes();
}

Result<std::vector<std::uint64_t>> read_index(const ScanChunkView& chunk, std::size_t count) {
  ByteReader reader(chunk.payload);
  std::vector<std::uint64_t> sizes;
  sizes.reserve(count);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const std::uint64_t size = reader.read_varint();
    if (size >> 48 != 0) {
      return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset + reader.offset(),
                        fmt::format("a chunk of {} bytes", size));
    }
    sizes.push_back(size);
  }
  if (!reader.ok() || reader.remaining() != 0) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset + reader.offset(),
                      fmt::format("not the sizes of {} chunks", count));
  }
  return sizes;
}

std::uint64_t frame_size(std::uint64_t payload_size) {
  ByteWriter writer;
  writer.write_varint(payload_size);
  return 1 + writer.size() + 4;
}

}  // namespace curlidar::compact
