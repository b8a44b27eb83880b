// SPDX-License-Identifier: BSD-3-Clause
// Poses under named columns, in any order; columns with other names are passed over.
#include <fmt/format.h>

#include <algorithm>

#include "base/try.hpp"
#include "io/pose_text.hpp"
#include "io/text.hpp"

namespace curlidar::io {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Where the columns of a pose are; kNone for those that are missing.
struct PoseColumns {
  std::size_t count = 0;
  std::size_t time = kNone;
  std::array<std::size_t, 3> place{};
  std::array<std::size_t, 4> quaternion{};
  std::array<std::size_t, 9> rotation{};

  bool has_quaternion() const { return has(quaternion); }
  bool has_rotation() const { return has(rotation); }
  bool has_place() const { return has(place); }

 private:
  template <std::size_t N>
  static bool has(const std::array<std::size_t, N>& columns) {
    return std::find(columns.begin(), columns.end(), kNone) == columns.end();
  }
};

std::string_view unquoted(std::string_view word) {
  const bool quotes = word.size() >= 2 && word.front() == '"' && word.back() == '"';
  return quotes ? word.substr(1, word.size() - 2) : word;
}

Result<PoseColumns> columns_of(const Source& source, const NumberedLine& header) {
  const auto words = number_words(header.text);
  const auto find = [&](std::initializer_list<std::string_view> names) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (std::find(names.begin(), names.end(), unquoted(words[i])) != names.end()) return i;
    }
    return kNone;
  };
  PoseColumns columns;
  columns.count = words.size();
  columns.time = find({"time", "time_s", "timestamp", "t"});
  columns.place = {find({"x", "tx"}), find({"y", "ty"}), find({"z", "tz"})};
  columns.quaternion = {find({"qx"}), find({"qy"}), find({"qz"}), find({"qw"})};
  columns.rotation = {find({"r00"}), find({"r01"}), find({"r02"}), find({"r10"}), find({"r11"}),
                      find({"r12"}), find({"r20"}), find({"r21"}), find({"r22"})};
  if (columns.has_place() && (columns.has_quaternion() || columns.has_rotation())) return columns;
  return error_at_line(source, header.number,
                       "not names of a pose's columns: wanted are x, y, z and qx, qy, qz, qw or "
                       "r00 .. r22, and time if known");
}

Result<RigidMotion> motion_of_row(const Source& source, std::size_t line,
                                  const PoseColumns& columns, std::span<const double> row) {
  const auto& [x, y, z] = columns.place;
  const Vec3 move{row[x], row[y], row[z]};
  if (columns.has_quaternion()) {
    const auto& q = columns.quaternion;
    return motion_of_quaternion(source, line, move, {row[q[0]], row[q[1]], row[q[2]], row[q[3]]});
  }
  const auto& r = columns.rotation;
  const double matrix[12] = {row[r[0]], row[r[1]], row[r[2]], move.x,    row[r[3]], row[r[4]],
                             row[r[5]], move.y,    row[r[6]], row[r[7]], row[r[8]], move.z};
  return motion_of_matrix(source, line, matrix);
}

}  // namespace

Result<PoseTrack> parse_pose_csv(const Source& source, std::span<const NumberedLine> lines) {
  CURLIDAR_TRY_ASSIGN(columns, columns_of(source, lines.front()));
  PoseTrack track;
  for (const NumberedLine& line : lines.subspan(1)) {
    CURLIDAR_TRY_ASSIGN(row, line_numbers(source, line, columns.count));
    CURLIDAR_TRY_ASSIGN(motion, motion_of_row(source, line.number, columns, row));
    track.T_map_sensor.push_back(motion);
    if (columns.time != kNone) track.time_s.push_back(row[columns.time]);
  }
  return track;
}

}  // namespace curlidar::io
