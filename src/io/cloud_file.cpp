// SPDX-License-Identifier: BSD-3-Clause
// Which format a file has, and the way from paths to the formats' readers and writers.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "io/columns.hpp"
#include "io/formats.hpp"
#include "io/text.hpp"

namespace curlidar {
namespace {

using io::Source;

struct FormatName {
  std::string_view name;
  CloudFormat format;
};

constexpr std::array<FormatName, 8> kNames{{{"pcd", CloudFormat::pcd},
                                            {"ply", CloudFormat::ply},
                                            {"kitti", CloudFormat::kitti},
                                            {"nuscenes", CloudFormat::nuscenes},
                                            {"npy", CloudFormat::npy},
                                            {"csv", CloudFormat::csv},
                                            {"xyz", CloudFormat::csv},
                                            {"txt", CloudFormat::csv}}};

/// Longer endings first: ".pcd.bin" is not ".bin".
constexpr std::array<FormatName, 8> kExtensions{{{".pcd.bin", CloudFormat::nuscenes},
                                                 {".bin", CloudFormat::kitti},
                                                 {".pcd", CloudFormat::pcd},
                                                 {".ply", CloudFormat::ply},
                                                 {".npy", CloudFormat::npy},
                                                 {".csv", CloudFormat::csv},
                                                 {".xyz", CloudFormat::csv},
                                                 {".txt", CloudFormat::csv}}};

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

/// PCD headers may start with any comment or keyword; the version line is usual.
bool looks_like_pcd(std::string_view text) {
  constexpr std::array<std::string_view, 3> kKeywords{"VERSION ", "FIELDS ", "# .PCD"};
  io::LineReader lines(text.substr(0, 4096));
  std::string_view line;
  while (lines.next(line)) {
    for (const std::string_view keyword : kKeywords) {
      if (line.starts_with(keyword)) return true;
    }
    if (!line.empty() && line[0] != '#') return false;
  }
  return false;
}

std::optional<CloudFormat> format_by_content(std::string_view text) {
  if (text.starts_with("\x93NUMPY")) return CloudFormat::npy;
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return CloudFormat::ply;
  if (looks_like_pcd(text)) return CloudFormat::pcd;
  return std::nullopt;
}

bool looks_like_text(std::string_view text) {
  const std::string_view head = text.substr(0, 4096);
  return !head.empty() && std::all_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\r' || c == '\t';
  });
}

Result<CloudFormat> tell_format(const Source& source) {
  if (const auto format = format_by_content(source.text())) return *format;
  if (const auto format = cloud_format_by_extension(source.name)) return *format;
  if (looks_like_text(source.text())) return CloudFormat::csv;
  return Error{ErrorCode::unsupported,
               fmt::format("{}: cannot tell the format of this file; name it (pcd, ply, kitti, "
                           "nuscenes, npy, csv)",
                           source.name)};
}

Result<Cloud> parse_as(CloudFormat format, const Source& source) {
  switch (format) {
    case CloudFormat::pcd:
      return io::parse_pcd(source);
    case CloudFormat::ply:
      return io::parse_ply(source);
    case CloudFormat::kitti:
      return io::parse_kitti(source);
    case CloudFormat::nuscenes:
      return io::parse_nuscenes(source);
    case CloudFormat::npy:
      return io::parse_npy(source);
    case CloudFormat::csv:
      return io::parse_csv(source);
  }
  return Error{ErrorCode::invalid_argument, fmt::format("{}: unknown format", source.name)};
}

bool has_encoding(CloudFormat format, Encoding encoding) {
  switch (encoding) {
    case Encoding::binary:
      return true;  // the default; text formats have only text
    case Encoding::ascii:
      return format == CloudFormat::pcd || format == CloudFormat::ply || format == CloudFormat::csv;
    case Encoding::binary_compressed:
      return format == CloudFormat::pcd;
    case Encoding::binary_big_endian:
      return format == CloudFormat::ply || format == CloudFormat::npy;
  }
  return false;
}

Result<io::Bytes> format_as(CloudFormat format, const Cloud& cloud, Encoding encoding,
                            const std::string& path) {
  switch (format) {
    case CloudFormat::pcd:
      return io::format_pcd(cloud, encoding);
    case CloudFormat::ply:
      return io::format_ply(cloud, encoding);
    case CloudFormat::kitti:
      return io::format_kitti(cloud);
    case CloudFormat::nuscenes:
      return io::format_nuscenes(cloud);
    case CloudFormat::npy:
      return io::format_npy(cloud, encoding);
    case CloudFormat::csv: {
      const std::string name = lower_case(path);
      const bool blanks = name.ends_with(".xyz") || name.ends_with(".txt");
      return io::format_csv(cloud, blanks ? ' ' : ',');
    }
  }
  return Error{ErrorCode::invalid_argument, "unknown format"};
}

}  // namespace

const char* to_string(CloudFormat format) {
  switch (format) {
    case CloudFormat::pcd:
      return "pcd";
    case CloudFormat::ply:
      return "ply";
    case CloudFormat::kitti:
      return "kitti";
    case CloudFormat::nuscenes:
      return "nuscenes";
    case CloudFormat::npy:
      return "npy";
    case CloudFormat::csv:
      return "csv";
  }
  return "unknown";
}

Result<CloudFormat> cloud_format_by_name(std::string_view name) {
  for (const FormatName& known : kNames) {
    if (known.name == name) return known.format;
  }
  return Error{ErrorCode::invalid_argument,
               fmt::format("no cloud format is named {}; there are pcd, ply, kitti, nuscenes, npy, "
                           "csv, xyz",
                           io::quoted(name))};
}

std::optional<CloudFormat> cloud_format_by_extension(std::string_view path) {
  const std::string name = lower_case(path);
  for (const FormatName& known : kExtensions) {
    if (name.ends_with(known.name)) return known.format;
  }
  return std::nullopt;
}

Result<Cloud> parse_cloud(std::span<const std::byte> bytes, const std::string& name,
                          const ReadOptions& options) {
  const Source source{bytes, name, options.limits};
  if (options.format) return parse_as(*options.format, source);
  CURLIDAR_TRY_ASSIGN(format, tell_format(source));
  return parse_as(format, source);
}

Result<Cloud> read_cloud(const std::string& path, const ReadOptions& options) {
  CURLIDAR_TRY_ASSIGN(bytes, read_file(path));
  return parse_cloud(bytes, path == "-" ? "standard input" : path, options);
}

Result<std::vector<std::byte>> format_cloud(const Cloud& cloud, const std::string& name,
                                            const WriteOptions& options) {
  const std::optional<CloudFormat> format =
      options.format ? options.format : cloud_format_by_extension(name);
  const auto named = [&](Error error) {
    error.message = fmt::format("{}: {}", name, error.message);
    return error;
  };
  if (!format) {
    return named({ErrorCode::invalid_argument,
                  "the name does not tell a format; use .pcd, .ply, .bin, .pcd.bin, .npy, .csv or "
                  ".xyz, or name one"});
  }
  if (!has_encoding(*format, options.encoding)) {
    return named({ErrorCode::invalid_argument,
                  fmt::format("{} files do not have this encoding", to_string(*format))});
  }
  if (const Status status = io::check_writable(cloud); !status) return named(status.error());
  Result<io::Bytes> bytes = format_as(*format, cloud, options.encoding, name);
  if (!bytes) return named(bytes.error());
  return bytes;
}

Status write_cloud(const std::string& path, const Cloud& cloud, const WriteOptions& options) {
  CURLIDAR_TRY_ASSIGN(bytes, format_cloud(cloud, path, options));
  return write_file(path, bytes);
}

}  // namespace curlidar
