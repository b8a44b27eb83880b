// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace curlidar::io {

Error error_at_byte(const Source& source, std::uint64_t offset, const std::string& reason,
                    ErrorCode code) {
  return {code, fmt::format("{}: byte {}: {}", source.name, offset, reason)};
}

Error error_at_line(const Source& source, std::uint64_t line, const std::string& reason,
                    ErrorCode code) {
  return {code, fmt::format("{}: line {}: {}", source.name, line, reason)};
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out = "'";
  for (const char c : text.substr(0, kLongest)) out += c >= 0x20 && c < 0x7f ? c : '?';
  return out + (text.size() > kLongest ? "...'" : "'");
}

Status check_point_count(const Source& source, std::uint64_t points) {
  if (points <= source.limits.max_points && points <= std::numeric_limits<std::uint32_t>::max()) {
    return {};
  }
  return Error{ErrorCode::limit_exceeded,
               fmt::format("{}: the file claims {} points, the limit is {}", source.name, points,
                           std::min<std::uint64_t>(source.limits.max_points,
                                                   std::numeric_limits<std::uint32_t>::max()))};
}

}  // namespace curlidar::io
