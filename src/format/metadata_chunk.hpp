// SPDX-License-Identifier: BSD-3-Clause
// The metadata chunk: UTF-8 keys and values.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "curlidar/result.hpp"
#include "format/container.hpp"

namespace curlidar {

using Metadata = std::map<std::string, std::string>;

inline constexpr std::size_t kMaxMetadataEntries = 4096;
inline constexpr std::size_t kMaxMetadataKeyBytes = 255;
inline constexpr std::size_t kMaxMetadataValueBytes = 1u << 20;

/// The payload for the entries. invalid_argument, with the key named, for an empty or too long key,
/// a too long value, or text that is not UTF-8.
Result<std::vector<std::byte>> write_metadata(const Metadata& metadata);
Result<Metadata> read_metadata(const Chunk& chunk);

}  // namespace curlidar
