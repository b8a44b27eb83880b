// SPDX-License-Identifier: BSD-3-Clause
// Whole .curl files of every profile: decoded, listed, reconstructed.
#pragma once

#include <cmath>
#include <string>

#include "curlidar/reconstruct.hpp"
#include "hostile/targets/chunks.hpp"
#include "hostile/targets/made_from_fields.hpp"
#include "support/chunks.hpp"

namespace curlidar::test {

/// First byte of an input that is not a .curl file.
enum DecodeInputOption : std::uint32_t {
  kWithoutResiduals = 1,
  kPartOnly = 2,
  kPartition = 4,
  kCut = 8,  ///< the file is cut to as many 256ths of its size as the second byte says
};
inline constexpr std::size_t kDecodeHeader = 2;

/// A file of the input's chunks.
inline std::vector<std::byte> framed(FuzzInput& input) {
  ContainerWriter writer;
  for (const FuzzChunk& chunk : read_fuzz_chunks(input)) {
    writer.add(static_cast<ChunkType>(chunk.type), chunk.payload);
  }
  return std::move(writer).finish();
}

/// Of files with every return: a slot for each of the order, attributes for each, points in as many
/// slots as there are records, within the limits.
inline std::string check_cloud(const DecodedScan& scan, const DecodeLimits& limits) {
  if (!scan.records) return scan.cloud ? "a cloud of no records" : "";
  if (!scan.cloud) return "";
  const Cloud& cloud = *scan.cloud;
  if (cloud.size() > limits.max_cells) return "more slots than allowed";
  if (cloud.size() != scan.records->slots_of_cloud) return "not a position for each slot";
  if (cloud.organised() && std::uint64_t{cloud.width} * cloud.height != cloud.size()) {
    return "a shape of another size";
  }
  if (cloud.size() < scan.points.size()) return "fewer slots than points";
  if (scan.records->loose > scan.points.size()) return "more loose points than points";
  for (const Attribute& attribute : cloud.attributes) {
    if (size_of(attribute.values) != cloud.size() * attribute.components) {
      return "an attribute of the cloud of another length";
    }
  }
  for (const Vec3& p : scan.points) {
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) return "no point";
  }
  return "";
}

inline std::string check_decoded(ByteSpan file, const DecodeOptions& options) {
  const auto chunks = list_chunks(file);
  const auto scan = decode(file, options);
  if (!scan) return scan.error().message.empty() ? "an error without a message" : "";
  if (!chunks && !options.allow_truncated) return "decoded, but not to be listed";
  if (const std::string broken = check_cloud(*scan, options.limits); !broken.empty()) return broken;
  const bool compact = scan->profile == Profile::compact;
  const std::size_t wanted = scan->cloud ? scan->cloud->size() : scan->points.size();
  if (compact && scan->points.size() != scan->coded_returns) return "points are not the returns";
  if (scan->field == nullptr) return "no field";
  ReconstructSettings settings;
  settings.max_points = 1u << 14;
  if (const auto cloud = reconstruct(*scan, settings); cloud && compact) {
    if (cloud->positions.size() != wanted) return "not one point for each return";
    for (const Attribute& attribute : cloud->attributes) {
      if (size_of(attribute.values) != cloud->positions.size() * attribute.components) {
        return "an attribute of another length";
      }
    }
  }
  settings.rows = 1.5;
  settings.columns = 0.7;
  settings.masks = false;
  settings.organised = true;
  (void)reconstruct(*scan, settings);
  settings.organised = false;
  settings.masks = true;
  settings.strategy = DenseStrategy::best;
  settings.normals = settings.confidence = settings.keep_originals = true;
  (void)reconstruct(*scan, settings);
  for (const DenseStrategy strategy : {DenseStrategy::best, DenseStrategy::masks}) {
    if (std::string wrong = check_everything_made(*scan, strategy); !wrong.empty()) return wrong;
  }
  return "";
}

/// Inputs that start as a .curl file are one, with its checksums put right; others are options and
/// chunks. Either way the library sees files whose framing is right.
inline std::string decode_target(ByteSpan bytes) {
  DecodeOptions options;
  options.limits.max_cells = 1u << 13;
  options.limits.max_bytes = 1u << 20;
  if (is_curl(bytes)) {
    if (bytes.size() < kHeaderSize) return "";
    options.partition = true;
    return check_decoded(with_right_checksums(bytes), options);
  }
  FuzzInput input(bytes);
  const std::uint32_t flags = input.byte();
  const std::size_t kept = input.byte();
  std::vector<std::byte> file = framed(input);
  options.field_only = (flags & kWithoutResiduals) != 0;
  options.partition = (flags & kPartition) != 0;
  if ((flags & kPartOnly) != 0) options.region = ScanRegion{1, 9, -1, 2};
  if ((flags & kCut) != 0) {
    options.allow_truncated = true;
    file.resize(file.size() * kept / 256);
  }
  return check_decoded(file, options);
}

}  // namespace curlidar::test
