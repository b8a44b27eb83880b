// SPDX-License-Identifier: BSD-3-Clause
#include "compact/ray_chunk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "base/try.hpp"
#include "compact/firing_list.hpp"
#include "compact/number_models.hpp"
#include "compact/ray_tables.hpp"
#include "compact/row_sequence.hpp"
#include "compact/scan_header.hpp"
#include "entropy/plain_bits.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint32_t kFrozen = 1u << 0, kMoved = 1u << 1, kFullMotion = 1u << 2,
                        kHasUnit = 1u << 3;
constexpr std::uint32_t kReserved = ~(kFrozen | kMoved | kFullMotion | kHasUnit);

constexpr std::int32_t kAnyAngle = std::numeric_limits<std::int32_t>::max();

/// Rows that look alike are this far apart at most.
constexpr std::uint32_t kPeriodBits = 3;

/// A column of the beams that is written out.
struct Part {
  std::string_view name;
  std::int32_t Ray::*member;
  std::uint32_t RayTable::*shift;
  std::int32_t limit;
};
constexpr std::array<Part, 4> kParts = {
    {{"azimuth offset", &Ray::azimuth_offset, &RayTable::azimuth_shift, kAnyAngle},
     {"height", &Ray::height, &RayTable::height_shift, kMaxRowOffset},
     {"lateral offset", &Ray::lateral, &RayTable::lateral_shift, kMaxRowOffset},
     {"range phase", &Ray::range_phase, &RayTable::phase_shift, kMaxRowOffset}}};

/// The numbers of a motion in the order of the format, of which the first two may be all there are.
constexpr std::array<Motion::Triple Motion::*, 6> kMotionParts = {
    &Motion::turn,  &Motion::move,       &Motion::turn2,
    &Motion::move2, &Motion::rigid_turn, &Motion::rigid_move};

std::uint32_t motion_shift(const RayTable& rays, std::size_t part) {
  return part % 2 == 0 ? rays.turn_shift : rays.move_shift;
}

std::size_t motion_parts(std::uint32_t flags) {
  return (flags & kFullMotion) != 0 ? 6 : (flags & kMoved) != 0 ? 2 : 0;
}

bool has_full_motion(const Motion& motion) {
  return std::any_of(kMotionParts.begin() + 2, kMotionParts.end(),
                     [&](auto part) { return motion.*part != Motion::Triple{}; });
}

Error invalid(std::string what) {
  return {ErrorCode::invalid_argument, std::move(what)};
}

bool is_multiple(std::int32_t value, std::uint32_t shift) {
  return (static_cast<std::uint32_t>(value) & ((1u << shift) - 1)) == 0;
}

/// Whether a number is one that the format holds: a multiple of 2^shift within the limit.
bool is_possible(std::int32_t value, std::uint32_t shift, std::int32_t limit) {
  return shift <= kMaxTableShift && is_multiple(value, shift) && value >= -limit && value <= limit;
}

Status check_inline_beams(const RowTable& table) {
  const RayTable& rays = *table.rays;
  for (std::size_t row = 0; row < rays.rays.size(); ++row) {
    if (!is_possible(table.elevation[row], table.elevation_shift, kMaxElevation)) {
      return invalid(fmt::format("the elevation of row {} is out of range or no multiple of 2^{}",
                                 row, table.elevation_shift));
    }
    for (const Part& part : kParts) {
      if (!is_possible(rays.rays[row].*part.member, rays.*part.shift, part.limit)) {
        return invalid(fmt::format("the {} of row {} is out of range or no multiple of 2^{}",
                                   part.name, row, rays.*part.shift));
      }
    }
  }
  return {};
}

Status check_frozen_beams(const RowTable& table) {
  const RayTable& rays = *table.rays;
  const BeamTable* frozen = beam_table(rays.table);
  if (frozen == nullptr) return invalid(fmt::format("there is no beam table {}", rays.table));
  const bool no_shifts = table.elevation_shift == 0 &&
                         std::all_of(kParts.begin(), kParts.end(),
                                     [&](const Part& part) { return rays.*part.shift == 0; });
  if (!no_shifts || frozen->slots != rays.slots || frozen->elevation != table.elevation ||
      frozen->rays != rays.rays ||
      (rays.range_unit_q48 != 0 && rays.range_unit_q48 != frozen->range_unit_q48)) {
    return invalid(fmt::format("the rays are not those of beam table {}", rays.table));
  }
  return {};
}

Status check_firings(const RayTable& rays, std::uint32_t columns) {
  if (rays.slots == 0 || rays.slots > kMaxSlots) {
    return invalid(fmt::format("{} encoder positions; 1..{} are possible", rays.slots, kMaxSlots));
  }
  if (rays.firings.size() != columns) {
    return invalid(fmt::format("{} firings for {} columns", rays.firings.size(), columns));
  }
  for (std::size_t i = 0; i < rays.firings.size(); ++i) {
    if (rays.firings[i] >= rays.slots || (i > 0 && rays.firings[i] <= rays.firings[i - 1])) {
      return invalid(
          fmt::format("firing {} is not behind the one before it and below {}", i, rays.slots));
    }
  }
  return {};
}

Status check_motion(const RayTable& rays) {
  for (std::size_t part = 0; part < kMotionParts.size(); ++part) {
    for (const std::int32_t value : rays.motion.*kMotionParts[part]) {
      if (!is_possible(value, motion_shift(rays, part), kMostMotion)) {
        return invalid("a number of the motion is out of range or no multiple of its shift");
      }
    }
  }
  if (rays.motion.none() && (rays.turn_shift != 0 || rays.move_shift != 0)) {
    return invalid("shifts of a motion that there is not");
  }
  return {};
}

/// Rows 0, p, 2 p, .., 1, p + 1, .. of `count`: rows that are alike behind each other.
template <class Visit>
void for_rows_by_period(std::size_t count, std::size_t period, const Visit& visit) {
  for (std::size_t first = 0; first < period; ++first) {
    for (std::size_t row = first; row < count; row += period) visit(row);
  }
}

std::vector<std::int32_t> by_period(const std::vector<std::int32_t>& values, std::size_t period) {
  std::vector<std::int32_t> out;
  out.reserve(values.size());
  for_rows_by_period(values.size(), period, [&](std::size_t row) { out.push_back(values[row]); });
  return out;
}

/// Writes one number for each row with the period that costs least.
void write_part(RangeEncoder& encoder, const std::vector<std::int32_t>& values,
                std::uint32_t shift) {
  std::uint32_t best = 0;
  std::size_t least = SIZE_MAX;
  for (std::uint32_t period = 1; period <= 1u << kPeriodBits; ++period) {
    RangeEncoder trial;
    write_sequence(trial, by_period(values, period), shift, SequenceKind::steady);
    const std::size_t size = std::move(trial).finish().size();
    if (size >= least) continue;
    least = size;
    best = period;
  }
  code_plain(encoder, best - 1, kPeriodBits);
  write_sequence(encoder, by_period(values, best), shift, SequenceKind::steady);
}

bool read_part(RangeDecoder& decoder, std::uint32_t rows, std::int32_t limit,
               std::vector<std::int32_t>& values, std::uint32_t& shift) {
  const std::size_t period = code_plain(decoder, std::size_t{0}, kPeriodBits) + 1;
  std::vector<std::int32_t> coded;
  if (!read_sequence(decoder, rows, limit, coded, shift, SequenceKind::steady)) return false;
  values.resize(rows);
  std::size_t next = 0;
  for_rows_by_period(rows, period, [&](std::size_t row) { values[row] = coded[next++]; });
  return true;
}

void write_beams(RangeEncoder& encoder, const RowTable& table) {
  write_sequence(encoder, table.elevation, table.elevation_shift, SequenceKind::steady_differences);
  for (const Part& part : kParts) {
    std::vector<std::int32_t> values;
    for (const Ray& ray : table.rays->rays) values.push_back(ray.*part.member);
    write_part(encoder, values, table.rays.value().*part.shift);
  }
}

bool read_beams(RangeDecoder& decoder, std::uint32_t rows, RowTable& table) {
  if (!read_sequence(decoder, rows, kMaxElevation, table.elevation, table.elevation_shift,
                     SequenceKind::steady_differences)) {
    return false;
  }
  RayTable& rays = *table.rays;
  rays.rays.resize(rows);
  std::vector<std::int32_t> values;
  for (const Part& part : kParts) {
    if (!read_part(decoder, rows, part.limit, values, rays.*part.shift)) return false;
    for (std::size_t row = 0; row < rows; ++row) rays.rays[row].*part.member = values[row];
  }
  return true;
}

/// One syntax for both ways; false if a number is out of range.
template <class Coder>
bool code_motion(Coder& coder, std::size_t parts, RayTable& rays) {
  rays.turn_shift = code_plain(coder, rays.turn_shift, 5);
  rays.move_shift = code_plain(coder, rays.move_shift, 5);
  if (rays.turn_shift > kMaxTableShift || rays.move_shift > kMaxTableShift) return false;
  NumberModels models;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::uint32_t shift = motion_shift(rays, part);
    for (std::int32_t& value : rays.motion.*kMotionParts[part]) {
      const std::int64_t unit = models.code(coder, value >> shift);
      if (std::abs(unit) > kMostMotion >> shift) return false;
      value = static_cast<std::int32_t>(unit * (std::int64_t{1} << shift));
    }
  }
  return true;
}

bool is_range_unit(std::uint64_t unit) {
  return unit >= kLeastRangeUnit && unit <= kMostRangeUnit;
}

std::uint32_t flags_of(const RayTable& rays) {
  const bool full = has_full_motion(rays.motion);
  return (rays.table != 0 ? kFrozen : 0) | (!rays.motion.none() ? kMoved : 0) |
         (full ? kFullMotion : 0) | (rays.range_unit_q48 != 0 ? kHasUnit : 0);
}

/// Takes the beam table that the chunk names.
Status read_frozen_front(const ScanChunkView& chunk, ByteReader& reader, std::uint32_t flags,
                         std::uint32_t rows, RowTable& table) {
  const std::uint64_t number = reader.read_varint();
  if (number > UINT32_MAX || !use_beam_table(static_cast<std::uint32_t>(number), table)) {
    return scan_error(ErrorCode::unsupported, chunk.part, chunk.offset,
                      "an unknown beam table; use a newer release of curlidar");
  }
  RayTable& rays = *table.rays;
  if (rays.rays.size() != rows) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset,
                      fmt::format("a beam table of {} rows for {}", rays.rays.size(), rows));
  }
  if ((flags & kHasUnit) == 0) return {};
  rays.range_unit_q48 = beam_table(rays.table)->range_unit_q48;
  if (rays.range_unit_q48 != 0) return {};
  return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset,
                    "the beam table has no range unit");
}

/// What is in front of beams that are written out.
Status read_inline_front(const ScanChunkView& chunk, ByteReader& reader, std::uint32_t flags,
                         RayTable& rays) {
  const std::uint64_t slots = reader.read_varint();
  if (slots == 0 || slots > kMaxSlots) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset,
                      fmt::format("{} encoder positions; 1..{} are possible", slots, kMaxSlots));
  }
  rays.slots = static_cast<std::uint32_t>(slots);
  if ((flags & kHasUnit) == 0) return {};
  rays.range_unit_q48 = reader.read_varint();
  if (is_range_unit(rays.range_unit_q48)) return {};
  return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset,
                    "the range unit is missing or out of range");
}

/// Firings and motion, and what may be wrong of them.
Status read_times(const ScanChunkView& chunk, RangeDecoder& decoder, std::uint32_t flags,
                  std::uint32_t columns, bool good, RayTable& rays) {
  good = good && read_firings(decoder, columns, rays.slots, rays.firings);
  if (const std::size_t parts = motion_parts(flags); good && parts > 0) {
    good = code_motion(decoder, parts, rays) && !rays.motion.none();
  }
  const auto corrupt = [&](std::string_view what) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset, what);
  };
  if (decoder.exhausted()) return corrupt("the payload ends inside the rays");
  if (!good) return corrupt("a number of the rays is out of range");
  if (!decoder.finished()) return corrupt("unexpected bytes at the end");
  return {};
}

}  // namespace

Status check_rays(const RowTable& table, std::uint32_t rows, std::uint32_t columns) {
  const RayTable& rays = *table.rays;
  if (rays.rays.size() != rows || table.elevation.size() != rows) {
    return invalid(fmt::format("{} rays and {} elevations for {} rows", rays.rays.size(),
                               table.elevation.size(), rows));
  }
  if (!table.height.empty() || table.height_shift != 0) {
    return invalid("heights belong to the rays, where there are rays");
  }
  if (table.turn_columns != columns || table.first_column != 0) {
    return invalid("the columns of rays are all the firings of a turn");
  }
  if (rays.range_unit_q48 != 0 && !is_range_unit(rays.range_unit_q48)) {
    return invalid(
        fmt::format("a range unit of {} / 2^48 m; 2^32..2^56 are possible", rays.range_unit_q48));
  }
  CURLIDAR_TRY(check_firings(rays, columns));
  CURLIDAR_TRY(check_motion(rays));
  return rays.table != 0 ? check_frozen_beams(table) : check_inline_beams(table);
}

bool use_beam_table(std::uint32_t number, RowTable& table) {
  const BeamTable* frozen = beam_table(number);
  if (frozen == nullptr) return false;
  if (!table.rays) table.rays.emplace();
  RayTable& rays = *table.rays;
  rays.table = number;
  rays.slots = frozen->slots;
  rays.rays = frozen->rays;
  table.elevation = frozen->elevation;
  table.elevation_shift = 0;
  for (const Part& part : kParts) rays.*part.shift = 0;
  return true;
}

std::vector<std::byte> write_rays(const RowTable& table) {
  RayTable rays = *table.rays;
  const std::uint32_t flags = flags_of(rays);
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(flags));
  writer.write_varint(rays.table != 0 ? rays.table : rays.slots);
  if (rays.table == 0 && rays.range_unit_q48 != 0) writer.write_varint(rays.range_unit_q48);
  RangeEncoder encoder;
  if (rays.table == 0) write_beams(encoder, table);
  write_firings(encoder, rays.firings, rays.slots);
  if (const std::size_t parts = motion_parts(flags); parts > 0) code_motion(encoder, parts, rays);
  writer.write_bytes(std::move(encoder).finish());
  return std::move(writer).bytes();
}

Status read_rays(const ScanChunkView& chunk, std::uint32_t rows, std::uint32_t columns,
                 RowTable& table) {
  ByteReader reader(chunk.payload);
  const auto fault = [&](ErrorCode code, std::string_view what) {
    return scan_error(code, chunk.part, chunk.offset, what);
  };
  if (chunk.payload.empty()) return fault(ErrorCode::corrupt, "the payload is empty");
  const std::uint32_t flags = reader.read<std::uint8_t>();
  if ((flags & kReserved) != 0) {
    return fault(ErrorCode::unsupported,
                 "flags of a later version; use a newer release of curlidar");
  }
  if ((flags & kFullMotion) != 0 && (flags & kMoved) == 0) {
    return fault(ErrorCode::corrupt, "flags that do not go together");
  }
  if (table.turn_columns != columns || table.first_column != 0) {
    return fault(ErrorCode::corrupt, "the image is not a whole turn of firings");
  }
  const bool frozen = (flags & kFrozen) != 0;
  table.rays.emplace();
  RayTable& rays = *table.rays;
  CURLIDAR_TRY(frozen ? read_frozen_front(chunk, reader, flags, rows, table)
                      : read_inline_front(chunk, reader, flags, rays));
  RangeDecoder decoder(chunk.payload.subspan(reader.offset()));
  const bool good = frozen || read_beams(decoder, rows, table);
  return read_times(chunk, decoder, flags, columns, good, rays);
}

std::vector<std::byte> write_firings_only(const RowTable& table) {
  RayTable rays = *table.rays;
  const std::uint32_t flags = flags_of(rays) & (kMoved | kFullMotion);
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(flags));
  RangeEncoder encoder;
  write_firings(encoder, rays.firings, rays.slots);
  if (const std::size_t parts = motion_parts(flags); parts > 0) code_motion(encoder, parts, rays);
  writer.write_bytes(std::move(encoder).finish());
  return std::move(writer).bytes();
}

Status read_firings_only(const ScanChunkView& chunk, std::uint32_t columns, RowTable& table) {
  const auto fault = [&](ErrorCode code, std::string_view what) {
    return scan_error(code, chunk.part, chunk.offset, what);
  };
  if (chunk.payload.empty()) return fault(ErrorCode::corrupt, "the payload is empty");
  const auto flags = static_cast<std::uint32_t>(chunk.payload[0]);
  if ((flags & ~(kMoved | kFullMotion)) != 0) {
    return fault(ErrorCode::unsupported,
                 "flags of a later version; use a newer release of curlidar");
  }
  if ((flags & kFullMotion) != 0 && (flags & kMoved) == 0) {
    return fault(ErrorCode::corrupt, "flags that do not go together");
  }
  if (table.turn_columns != columns || table.first_column != 0) {
    return fault(ErrorCode::corrupt, "the image is not a whole turn of firings");
  }
  RayTable& rays = *table.rays;
  rays.motion = {};
  rays.turn_shift = rays.move_shift = 0;
  rays.firings.clear();
  RangeDecoder decoder(chunk.payload.subspan(1));
  return read_times(chunk, decoder, flags, columns, true, rays);
}

}  // namespace curlidar::compact
