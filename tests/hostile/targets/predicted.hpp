// SPDX-License-Identifier: BSD-3-Clause
// All chunks of a scan that is predicted from a small street.
#pragma once

#include <string>

#include "compact/prediction_chunk.hpp"
#include "compact/scan_encoder.hpp"
#include "hostile/targets/scan.hpp"
#include "support/compact_scans.hpp"

namespace curlidar::test {

inline compact::ScanSettings street_settings() {
  compact::ScanSettings settings;
  settings.steps = compact::steps_for_step(compact::kRangeUnit / 4);
  settings.effort = 1;
  settings.threads = 1;
  return settings;
}

/// What every input is predicted from.
inline const compact::DecodedScan& reference_street() {
  static const compact::DecodedScan scan = [] {
    const CompactScan street = integer_street(12, 48);
    const auto encoded = compact::encode_scan(street.image, street.table, street_settings());
    return compact::decode_scan(views_of(encoded->chunks)).value();
  }();
  return scan;
}

/// Flags of the scan, then its chunks. Fingerprints are put right.
inline constexpr std::size_t kPredictedHeader = 1;

inline std::string predicted_target(ByteSpan bytes) {
  using namespace compact;
  FuzzInput input(bytes);
  const std::uint32_t flags = input.byte();
  const std::uint16_t fingerprint = fingerprint_of(reference_street());
  ScanChunks chunks;
  std::vector<std::vector<std::byte>> changed;
  changed.reserve(64);
  std::size_t offset = kPredictedHeader;
  for (const FuzzChunk& chunk : read_fuzz_chunks(input)) {
    const auto part = static_cast<ScanPart>(0x10 + chunk.type % 8);
    ByteSpan payload = chunk.payload;
    if (part == ScanPart::prediction && payload.size() >= 3 && changed.size() < 64) {
      auto& copy = changed.emplace_back(payload.begin(), payload.end());
      copy[1] = static_cast<std::byte>(fingerprint & 0xff);
      copy[2] = static_cast<std::byte>(fingerprint >> 8);
      payload = copy;
    }
    chunks.chunks.push_back({part, payload, offset + 3, true});
    offset += 3 + chunk.payload.size();
  }
  chunks.complete = (flags & kIncomplete) == 0;
  if (!chunks.complete && (flags & kTorn) != 0 && !chunks.chunks.empty()) {
    chunks.chunks.back().whole = false;
  }
  ScanOptions options;
  options.field_only = (flags & kFieldOnly) != 0;
  options.keep_nodes = (flags & kNodes) != 0;
  options.threads = 1;
  options.reference = &reference_street();
  const auto scan = decode_scan(chunks, {8192}, options);
  if (!scan) return scan.error().message.empty() ? "an error without a message" : "";
  if (std::string fault = check_planes(*scan); !fault.empty()) return fault;
  for (std::size_t cell = 0; cell < scan->range.size(); ++cell) {
    if (scan->surface[cell] >= 0) (void)surface_in(*scan, cell);
  }
  return check_points(*scan);
}

}  // namespace curlidar::test
