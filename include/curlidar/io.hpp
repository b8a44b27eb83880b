// SPDX-License-Identifier: BSD-3-Clause
// Cloud files. Formats are told by content first, then by extension.
//
// Positions are kept as double with the source's floating-point type beside them (integers of more
// than 16 bits become float64; 64-bit ones are rounded to it); all other fields become attributes
// of their own type, bit by bit. Writers use the position type again.
#pragma once

#include <array>
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
  /// PCL's PCD: ascii, binary, binary_compressed. Holds everything: layout, all types, components,
  /// metadata (as comments; "viewpoint" in its own line, the identity is left out).
  pcd,
  /// Ascii, binary little and big endian. Holds everything but 64-bit integers; components as
  /// name_0, name_1, ...; metadata as comments. List properties of vertices have no place in a
  /// cloud: they are passed over and named in the metadata key "ply_lists_not_read".
  ply,
  /// .bin: float32 x y z intensity. Written intensity is converted; a missing one is 0.
  kitti,
  /// .pcd.bin: float32 x y z intensity ring. Written as KITTI.
  nuscenes,
  /// NumPy N x k or H x W x k numbers: x y z, then intensity (k = 4), intensity and ring (k = 5) or
  /// column3, column4, ... (k > 5); or N or H x W structures with fields x, y and z. Written plain
  /// if that gives names and types back, else structured. No metadata.
  npy,
  /// .csv / .xyz / .txt: text columns, optional header; unnamed columns as in npy. Text has no
  /// types: coordinates are float64, columns of whole numbers int64 or uint64, others float64.
  /// Components are split into name_0, name_1, ...; no layout, no metadata.
  csv,
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
/// Memory is bounded by a small multiple of the file's size, whatever its header claims; of what it
/// unpacks to for binary_compressed PCD, which is at most 88 times as much.
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

enum class MeshFormat { ply, obj };
/// By file name, whatever the case of its letters.
std::optional<MeshFormat> mesh_format_by_extension(std::string_view path);

/// Writes a triangle mesh with float32 vertices: in the format given or, without, that of the
/// extension of `path`; else as PLY. PLY has the given encoding (ascii or binary, little endian).
/// "-" is standard output. `normals` are of the vertices, or none. Atomic.
Status write_mesh(const std::string& path, std::span<const Vec3> vertices,
                  std::span<const std::array<std::uint32_t, 3>> triangles,
                  Encoding encoding = Encoding::binary, std::span<const Vec3> normals = {},
                  std::optional<MeshFormat> format = {});

/// Whole-file helpers used by every command ("-" is standard input/output; writes are atomic).
Result<std::vector<std::byte>> read_file(const std::string& path);
Status write_file(const std::string& path, std::span<const std::byte> bytes);

/// From now on SIGINT, SIGTERM and SIGHUP remove unfinished outputs before they end the program;
/// those that are ignored stay so. For programs; the library never calls it.
void remove_temporary_files_on_signals();

}  // namespace curlidar
