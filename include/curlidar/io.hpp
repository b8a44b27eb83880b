// SPDX-License-Identifier: BSD-3-Clause
// Cloud files. Formats are told by content first, then by extension.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

enum class CloudFormat {
  pcd,      ///< PCL's PCD: ascii, binary, binary_compressed
  ply,      ///< ascii, binary little and big endian
  kitti,    ///< .bin: float32 x y z intensity
  nuscenes, ///< .pcd.bin: float32 x y z intensity ring
  npy,      ///< NumPy N x 3..k array or structured array with x, y, z fields
  csv,      ///< .csv / .xyz / .txt: text columns, optional header
};

const char* to_string(CloudFormat format);
/// Accepts the names of to_string ("pcd", "ply", "kitti", "nuscenes", "npy", "csv", "xyz").
Result<CloudFormat> cloud_format_by_name(std::string_view name);
/// By file name: "x.pcd.bin" is nuScenes, "x.bin" KITTI.
std::optional<CloudFormat> cloud_format_by_extension(std::string_view path);

enum class Encoding { ascii, binary, binary_compressed, binary_big_endian };

struct ReadLimits {
  std::uint64_t max_points = 1'000'000'000;  ///< refuse files that claim more
};

struct ReadOptions {
  std::optional<CloudFormat> format;  ///< force one; otherwise by content and extension
  ReadLimits limits;
};

struct WriteOptions {
  std::optional<CloudFormat> format;  ///< otherwise by extension
  Encoding encoding = Encoding::binary;
};

/// Reads a cloud; "-" is standard input. Errors name the file, the place and the reason.
/// Memory is bounded by a small multiple of the file's size, whatever its header claims.
Result<Cloud> read_cloud(const std::string& path, const ReadOptions& options = {});

/// Parses a cloud from bytes; `name` is used for messages and for telling the format.
Result<Cloud> parse_cloud(std::span<const std::byte> bytes, const std::string& name,
                          const ReadOptions& options = {});

/// The bytes that write_cloud writes; `name` is used for messages and for telling the format.
Result<std::vector<std::byte>> format_cloud(const Cloud& cloud, const std::string& name,
                                            const WriteOptions& options = {});

/// Writes a cloud; "-" is standard output. Atomic: the file appears whole or not at all.
/// An attribute that the format cannot hold is an error, never dropped silently.
Status write_cloud(const std::string& path, const Cloud& cloud, const WriteOptions& options = {});

/// Whole-file helpers used by every command ("-" is standard input/output; writes are atomic).
Result<std::vector<std::byte>> read_file(const std::string& path);
Status write_file(const std::string& path, std::span<const std::byte> bytes);

}  // namespace curlidar
