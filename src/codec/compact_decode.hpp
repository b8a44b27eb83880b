// SPDX-License-Identifier: BSD-3-Clause
// Profile::compact: a file to a scan.
#pragma once

#include <vector>

#include "compact/scan_decoder.hpp"
#include "curlidar/codec.hpp"
#include "format/container.hpp"

namespace curlidar {

/// Metadata key that names the sensor.
inline constexpr const char* kSensorKey = "sensor";

/// Whether the chunks are those of a compact file.
bool is_compact(const std::vector<Chunk>& chunks);

Result<DecodedScan> decode_compact(const PartialContainer& container, const DecodeOptions& options);

/// Rows and ranges of a file, complete.
struct CompactImage {
  compact::RowTable table;
  compact::Image image;
};
Result<CompactImage> decode_compact_image(ByteSpan bytes, const DecodeOptions& options);

}  // namespace curlidar
