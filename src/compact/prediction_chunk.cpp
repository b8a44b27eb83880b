// SPDX-License-Identifier: BSD-3-Clause
#include "compact/prediction_chunk.hpp"

#include "base/bytes.hpp"
#include "base/crc32c.hpp"
#include "compact/scan_header.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint32_t kMoved = 1u << 0, kSameRows = 1u << 1, kSameFirings = 1u << 2;
constexpr std::uint32_t kKnownFlags = kMoved | kSameRows | kSameFirings;

/// 0, -1, 1, -2, ..
std::uint64_t folded(std::int64_t x) {
  return x < 0 ? 2 * static_cast<std::uint64_t>(-(x + 1)) + 1 : 2 * static_cast<std::uint64_t>(x);
}
std::int64_t unfolded(std::uint64_t x) {
  const auto half = static_cast<std::int64_t>(x >> 1);
  return (x & 1) != 0 ? -half - 1 : half;
}

bool read_part(ByteReader& reader, std::int32_t most, std::int32_t& value) {
  const std::int64_t number = unfolded(reader.read_varint());
  if (number < -most || number > most) return false;
  value = static_cast<std::int32_t>(number);
  return true;
}

}  // namespace

std::uint16_t fingerprint_of(const DecodedScan& scan) {
  std::uint32_t crc = 0;
  for (const std::int32_t range : scan.range) {
    ByteWriter writer;
    writer.write(range);
    crc = crc32c(writer.bytes(), crc);
  }
  return static_cast<std::uint16_t>(crc);
}

std::vector<std::byte> write_prediction(const PredictionHeader& header) {
  const bool moved = !header.pose.none();
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>((moved ? kMoved : 0) | (header.same_rows ? kSameRows : 0) |
                                         (header.same_firings ? kSameFirings : 0)));
  writer.write(header.reference);
  if (!moved) return std::move(writer).bytes();
  for (const std::int32_t x : header.pose.turn) writer.write_varint(folded(x));
  for (const std::int32_t x : header.pose.move) writer.write_varint(folded(x));
  return std::move(writer).bytes();
}

Result<PredictionHeader> read_prediction(const ScanChunkView& chunk) {
  const auto corrupt = [&](std::string_view what) {
    return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset, what);
  };
  ByteReader reader(chunk.payload);
  const std::uint32_t flags = reader.read<std::uint8_t>();
  if ((flags & ~kKnownFlags) != 0) {
    return scan_error(ErrorCode::unsupported, chunk.part, chunk.offset,
                      "flags of a later version; use a newer release of curlidar");
  }
  PredictionHeader header;
  header.same_rows = (flags & kSameRows) != 0;
  header.same_firings = (flags & kSameFirings) != 0;
  header.reference = reader.read<std::uint16_t>();
  bool good = header.same_rows || !header.same_firings;
  if ((flags & kMoved) != 0) {
    for (std::int32_t& x : header.pose.turn) {
      good = read_part(reader, RelativePose::kMostTurn, x) && good;
    }
    for (std::int32_t& x : header.pose.move) {
      good = read_part(reader, RelativePose::kMostMove, x) && good;
    }
  }
  if (!reader.ok()) return corrupt("the payload ends too early");
  if (!good) return corrupt("a number out of range, or flags that do not go together");
  if (reader.remaining() != 0) return corrupt("unexpected bytes at the end");
  return header;
}

}  // namespace curlidar::compact
