// SPDX-License-Identifier: BSD-3-Clause
// All chunks of a compact scan, whole, cut off and in part.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>

#include "compact/scan_decoder.hpp"
#include "compact/scan_points.hpp"
#include "hostile/targets/chunks.hpp"

namespace curlidar::test {

/// Options, then what of the image is asked for: row begin and end, column begin and end.
inline constexpr std::size_t kScanHeader = 5;
enum ScanInputOption : std::uint32_t {
  kFieldOnly = 1,
  kRegion = 2,
  kNodes = 4,
  kIncomplete = 8,  ///< the file is cut off
  kTorn = 16,       ///< and the last chunk is
};

inline std::string check_planes(const compact::DecodedScan& scan) {
  const std::size_t cells = std::size_t{scan.parameters.rows} * scan.parameters.columns;
  if (scan.occupied.size() != cells || scan.range.size() != cells ||
      scan.field_range.size() != cells || scan.surface.size() != cells ||
      scan.leaf.size() != cells) {
    return "planes of different sizes";
  }
  const auto surfaces = static_cast<std::int64_t>(scan.surfaces.size());
  const auto leaves = static_cast<std::int64_t>(scan.leaves.size());
  for (const compact::DecodedLeaf& leaf : scan.leaves) {
    if (leaf.layers == 0 || leaf.first_surface + leaf.layers > surfaces) {
      return "a leaf without surfaces";
    }
  }
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (scan.range[cell] < 0 || scan.range[cell] > 1 << 30 || scan.field_range[cell] < 0 ||
        scan.field_range[cell] > 1 << 30) {
      return "a range out of bounds";
    }
    if (scan.occupied[cell] == 0 && scan.range[cell] != 0) return "a range in an empty cell";
    if (scan.surface[cell] < -1 || scan.surface[cell] >= surfaces || scan.leaf[cell] < -1 ||
        scan.leaf[cell] >= leaves) {
      return "a surface or leaf that is not there";
    }
    if ((scan.range[cell] > 0) != (scan.surface[cell] >= 0) ||
        (scan.surface[cell] >= 0) != (scan.leaf[cell] >= 0)) {
      return "a range without a surface or the other way";
    }
  }
  return "";
}

/// Points must be exact in doubles.
inline std::string check_points(const compact::DecodedScan& scan) {
  const compact::PointTable points(scan.table, scan.parameters.rows, scan.parameters.columns);
  const std::size_t columns = scan.parameters.columns;
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    if (scan.range[cell] == 0) continue;
    const compact::FixedPoint p =
        points.fixed(static_cast<std::uint32_t>(cell / columns),
                     static_cast<std::uint32_t>(cell % columns), scan.range[cell]);
    constexpr std::int64_t most = std::int64_t{1} << 53;
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > most) return "a point too far";
  }
  return "";
}

/// A part must hold what the whole holds there.
inline std::string check_part(const compact::DecodedScan& whole, const compact::DecodedScan& part,
                              const compact::Region& region) {
  std::size_t cell = 0;
  for (std::uint32_t row = 0; row < whole.parameters.rows; ++row) {
    for (std::uint32_t column = 0; column < whole.parameters.columns; ++column, ++cell) {
      const bool inside = row >= region.row_begin && row < region.row_end &&
                          column >= region.column_begin && column < region.column_end;
      if (part.range[cell] != (inside ? whole.range[cell] : 0)) return "a part differs";
    }
  }
  return "";
}

inline std::string scan_target(ByteSpan bytes) {
  using namespace compact;
  FuzzInput input(bytes);
  const std::uint32_t flags = input.byte();
  Region region;
  region.row_begin = input.byte();
  region.row_end = input.byte();
  region.column_begin = input.byte();
  region.column_end = input.byte();
  ScanChunks chunks;
  std::size_t offset = kScanHeader;
  for (const FuzzChunk& chunk : read_fuzz_chunks(input)) {
    const auto part = static_cast<ScanPart>(0x10 + chunk.type % 7);
    chunks.chunks.push_back({part, chunk.payload, offset + 3, true});
    offset += 3 + chunk.payload.size();
  }
  chunks.complete = (flags & kIncomplete) == 0;
  if (!chunks.complete && (flags & kTorn) != 0 && !chunks.chunks.empty()) {
    chunks.chunks.back().whole = false;
  }
  const ScanLimits limits{8192};
  ScanOptions options;
  options.field_only = (flags & kFieldOnly) != 0;
  options.keep_nodes = (flags & kNodes) != 0;
  options.threads = 1;

  if (const auto index = decode_scan_index(chunks, limits); !index && index.error().message.empty())
    return "an error without a message";
  const auto scan = decode_scan(chunks, limits, options);
  if (!scan && scan.error().message.empty()) return "an error without a message";
  if (scan) {
    if (std::string fault = check_planes(*scan); !fault.empty()) return fault;
    if (std::string fault = check_points(*scan); !fault.empty()) return fault;
    if (chunks.complete && !scan->missing.empty()) return "something is missing of a whole file";
    for (const Missing& missing : scan->missing) (void)to_string(missing);
  }
  if ((flags & kRegion) == 0) return "";
  options.region = region;
  const auto part = decode_scan(chunks, limits, options);
  if (!part) return scan ? "a part of a good scan is refused" : "";
  if (std::string fault = check_planes(*part); !fault.empty()) return fault;
  return scan ? check_part(*scan, *part, region) : "";
}

}  // namespace curlidar::test
