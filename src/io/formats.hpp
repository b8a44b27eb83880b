// SPDX-License-Identifier: BSD-3-Clause
// What every cloud format gives: a reader from bytes and a writer to bytes. Files are not touched.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/io.hpp"

namespace curlidar::io {

/// The bytes of a file, with its name for messages.
struct Source {
  ByteSpan bytes;
  const std::string& name;
  const ReadLimits& limits;

  std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
};

/// "NAME: byte 12: reason", ErrorCode::corrupt unless told otherwise.
Error error_at_byte(const Source& source, std::uint64_t offset, const std::string& reason,
                    ErrorCode code = ErrorCode::corrupt);
/// "NAME: line 3: reason"; lines count from 1.
Error error_at_line(const Source& source, std::uint64_t line, const std::string& reason,
                    ErrorCode code = ErrorCode::corrupt);
/// Text of a hostile file made fit for a message: quoted, shortened, unprintable bytes as '?'.
std::string quoted(std::string_view text);

/// Fails if a file claims more points than the caller allows or a Cloud can number.
Status check_point_count(const Source& source, std::uint64_t points);

using Bytes = std::vector<std::byte>;

Result<Cloud> parse_pcd(const Source& source);
Result<Cloud> parse_ply(const Source& source);
Result<Cloud> parse_kitti(const Source& source);
Result<Cloud> parse_nuscenes(const Source& source);
Result<Cloud> parse_npy(const Source& source);
Result<Cloud> parse_csv(const Source& source);

/// Writers expect a cloud that passed check_writable (columns.hpp) and an encoding that the format
/// has (cloud_file.cpp checks both).
Result<Bytes> format_pcd(const Cloud& cloud, Encoding encoding);
Result<Bytes> format_ply(const Cloud& cloud, Encoding encoding);
Result<Bytes> format_kitti(const Cloud& cloud);
Result<Bytes> format_nuscenes(const Cloud& cloud);
Result<Bytes> format_npy(const Cloud& cloud, Encoding encoding);
/// `separator` ',' gives a header line, ' ' a commented one (the .xyz habit).
Result<Bytes> format_csv(const Cloud& cloud, char separator);

}  // namespace curlidar::io
