// SPDX-License-Identifier: BSD-3-Clause
// Sequence files: whole, cut off, every scan in a row and again from elsewhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "curlidar/sequence.hpp"
#include "hostile/targets/input.hpp"
#include "support/chunks.hpp"

namespace curlidar::test {

/// Faults of what a file tells without decoding.
inline std::string check_groups(const SequenceFile& file, std::size_t bytes, bool cut) {
  if (!cut && !file.missing().empty()) return "something is missing of a whole sequence";
  if (file.scans() > bytes) return "more scans than bytes";
  std::uint64_t scans = 0;
  for (const SequencePart& group : file.groups()) {
    if (group.first_scan != scans) return "scans between groups";
    scans += group.scans;
  }
  return scans == file.scans() ? "" : "another number of scans than the groups have";
}

inline std::string check_stamp(const ScanStamp& stamp) {
  if (stamp.time_s && !std::isfinite(*stamp.time_s)) return "a time that is none";
  if (!stamp.T_map_sensor) return "";
  for (const Vec3& row : stamp.T_map_sensor->rotation) {
    if (!(std::abs(norm(row) - 1) < 1e-12)) return "a pose that is no rotation";
  }
  return std::isfinite(norm(stamp.T_map_sensor->move)) ? "" : "a pose that is nowhere";
}

inline bool same_scan(const DecodedScan& a, const DecodedScan& b) {
  if (a.cloud.has_value() != b.cloud.has_value() || a.coded_returns != b.coded_returns)
    return false;
  if (!a.cloud) return true;
  const auto same = [](const Vec3& p, const Vec3& q) {
    return norm(p - q) == 0 || !std::isfinite(norm(p - q));
  };
  return std::equal(a.cloud->positions.begin(), a.cloud->positions.end(),
                    b.cloud->positions.begin(), b.cloud->positions.end(), same);
}

/// Reads all that the bytes say they hold; a scan that is sought is that which comes in a row.
inline std::string read_whole_sequence(ByteSpan bytes, bool allow_truncated) {
  constexpr std::size_t kMostScans = 12;
  SequenceReadOptions options;
  options.limits = {1u << 14, 1u << 20};
  options.allow_truncated = allow_truncated;
  const std::vector<std::byte> whole(bytes.begin(), bytes.end());
  auto file = SequenceFile::parse(whole, "fuzz", options);
  if (!file) return file.error().message.empty() ? "an error without words" : "";
  if (std::string fault = check_groups(*file, bytes.size(), allow_truncated); !fault.empty()) {
    return fault;
  }
  const std::size_t scans = std::min(file->scans(), kMostScans);
  for (std::size_t i = 0; i < scans; ++i) {
    const auto told = file->scan(i);
    const auto scan = file->decode(i);
    if (!told && scan) return "a scan that nobody knows";
    if (!told) continue;
    if (std::string fault = check_stamp(told->stamp); !fault.empty()) return fault;
    if (!scan || i + 1 != scans) continue;
    auto again = SequenceFile::parse(whole, "fuzz", options);
    const auto sought = again->decode(i);
    if (!sought || !same_scan(*sought, *scan)) return "another scan when it is sought";
  }
  return "";
}

/// The input as it is, and with its checksums put right, which no fuzzer would find; each as a
/// whole sequence and as one that may be cut off.
inline std::string sequence_target(ByteSpan bytes) {
  for (const bool cut : {false, true}) {
    if (std::string fault = read_whole_sequence(bytes, cut); !fault.empty()) return fault;
  }
  if (bytes.size() < kHeaderSize) return "";
  const auto repaired = with_right_checksums(bytes);
  for (const bool cut : {false, true}) {
    if (std::string fault = read_whole_sequence(repaired, cut); !fault.empty()) return fault;
  }
  return "";
}

}  // namespace curlidar::test
