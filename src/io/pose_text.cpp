// SPDX-License-Identifier: BSD-3-Clause
#include "io/pose_text.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/try.hpp"
#include "io/text.hpp"

namespace curlidar::io {
namespace {

/// Files with four digits pass; a matrix that is scaled, skewed or transposed in part does not.
constexpr double kRotationTolerance = 1e-3;
/// Below this a matrix is a rotation to the rounding of doubles, and stays as it is.
constexpr double kRounding = 1e-12;

using Matrix3 = Eigen::Matrix3d;

Matrix3 matrix_of(const RigidMotion& motion) {
  Matrix3 matrix;
  for (int row = 0; row < 3; ++row) {
    const Vec3& r = motion.rotation[static_cast<std::size_t>(row)];
    matrix.row(row) << r.x, r.y, r.z;
  }
  return matrix;
}

void set_rotation(RigidMotion& motion, const Matrix3& matrix) {
  for (int row = 0; row < 3; ++row) {
    motion.rotation[static_cast<std::size_t>(row)] = {matrix(row, 0), matrix(row, 1),
                                                      matrix(row, 2)};
  }
}

/// The nearest rotation in the sense of least squares.
Matrix3 nearest_rotation(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

bool is_words_of(const NumberedLine& line, std::size_t wanted) {
  const auto words = number_words(line.text);
  double value = 0;
  for (const std::string_view word : words) {
    if (!parse_number(word, value)) return false;
  }
  return words.size() == wanted;
}

Result<PoseTrack> parse_kitti_poses(const Source& source, std::span<const NumberedLine> lines) {
  PoseTrack track;
  for (const NumberedLine& line : lines) {
    CURLIDAR_TRY_ASSIGN(numbers, line_numbers(source, line, 12));
    CURLIDAR_TRY_ASSIGN(motion, motion_of_matrix(source, line.number, numbers));
    track.T_map_sensor.push_back(motion);
  }
  return track;
}

Result<PoseTrack> parse_tum(const Source& source, std::span<const NumberedLine> lines) {
  PoseTrack track;
  for (const NumberedLine& line : lines) {
    CURLIDAR_TRY_ASSIGN(n, line_numbers(source, line, 8));
    CURLIDAR_TRY_ASSIGN(motion, motion_of_quaternion(source, line.number, {n[1], n[2], n[3]},
                                                     {n[4], n[5], n[6], n[7]}));
    track.T_map_sensor.push_back(motion);
    track.time_s.push_back(n[0]);
  }
  return track;
}

bool is_last_row(std::span<const double> row) {
  return row[0] == 0 && row[1] == 0 && row[2] == 0 && row[3] == 1;
}

Status check_last_row(const Source& source, const NumberedLine& line, std::span<const double> row) {
  if (is_last_row(row)) return {};
  return error_at_line(source, line.number,
                       "the last row of a 4 x 4 pose must be 0 0 0 1 (rows, not columns, are "
                       "written one after the other)");
}

/// One pose of rows from lines[at] on; moves `at` behind it.
Result<RigidMotion> parse_rows(const Source& source, std::span<const NumberedLine> lines,
                               std::size_t& at) {
  const std::size_t first = at;
  std::vector<double> numbers;
  for (; at < first + 3; ++at) {
    if (at == lines.size() || (at > first && lines[at].blanks_before > 0)) {
      return error_at_line(source, lines[at - 1].number,
                           fmt::format("the pose ends after {} of its 3 rows", at - first));
    }
    CURLIDAR_TRY_ASSIGN(row, line_numbers(source, lines[at], 4));
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  // No row of a rotation is all zeros, so that a fourth row cannot be the next pose's first.
  const bool goes_on = at < lines.size() && lines[at].blanks_before == 0;
  if (goes_on) {
    CURLIDAR_TRY_ASSIGN(row, line_numbers(source, lines[at], 4));
    if (is_last_row(row)) ++at;
  }
  return motion_of_matrix(source, lines[first].number, numbers);
}

Result<PoseTrack> parse_matrices(const Source& source, std::span<const NumberedLine> lines) {
  PoseTrack track;
  for (std::size_t at = 0; at < lines.size();) {
    if (!is_words_of(lines[at], 16)) {
      CURLIDAR_TRY_ASSIGN(motion, parse_rows(source, lines, at));
      track.T_map_sensor.push_back(motion);
      continue;
    }
    CURLIDAR_TRY_ASSIGN(numbers, line_numbers(source, lines[at], 16));
    CURLIDAR_TRY(check_last_row(source, lines[at], std::span(numbers).last(4)));
    CURLIDAR_TRY_ASSIGN(motion,
                        motion_of_matrix(source, lines[at].number, std::span(numbers).first(12)));
    track.T_map_sensor.push_back(motion);
    ++at;
  }
  return track;
}

}  // namespace

Result<std::vector<NumberedLine>> content_lines(const Source& source) {
  std::string_view text = source.text();
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // the mark some editors set
  LineReader reader(text);
  std::vector<NumberedLine> lines;
  std::size_t blanks = 0;
  std::string_view line;
  while (reader.next(line)) {
    if (line.size() > kMaxLineBytes) {
      return error_at_line(
          source, reader.line(),
          fmt::format("the line has {} bytes: this is no file of poses", line.size()),
          ErrorCode::limit_exceeded);
    }
    line = trim(line);
    if (line.empty()) ++blanks;
    if (line.empty() || line.starts_with('#') || line.starts_with("//")) continue;
    lines.push_back({line, reader.line(), blanks});
    blanks = 0;
  }
  return lines;
}

std::vector<std::string_view> number_words(std::string_view line) {
  constexpr std::string_view kBetween = " \t,;";
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBetween);
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(kBetween), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

Result<std::vector<double>> line_numbers(const Source& source, const NumberedLine& line,
                                         std::size_t wanted) {
  const auto words = number_words(line.text);
  if (wanted != 0 && words.size() != wanted) {
    return error_at_line(source, line.number,
                         fmt::format("{} numbers where {} are wanted", words.size(), wanted));
  }
  std::vector<double> numbers;
  numbers.reserve(words.size());
  for (const std::string_view word : words) {
    double value = 0;
    if (!parse_number(word, value) || !std::isfinite(value)) {
      return error_at_line(source, line.number,
                           fmt::format("{} is no finite number", quoted(word)));
    }
    numbers.push_back(value);
  }
  return numbers;
}

Result<RigidMotion> motion_of_matrix(const Source& source, std::size_t line,
                                     std::span<const double> numbers) {
  RigidMotion motion;
  for (std::size_t row = 0; row < 3; ++row) {
    motion.rotation[row] = {numbers[4 * row], numbers[4 * row + 1], numbers[4 * row + 2]};
  }
  motion.move = {numbers[3], numbers[7], numbers[11]};
  const Matrix3 matrix = matrix_of(motion);
  const double off = (matrix * matrix.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationTolerance)) {
    return error_at_line(
        source, line,
        fmt::format("the first three columns are no rotation: rows are {:.3g} from orthonormal "
                    "(more than {}). A pose is written row by row, r r r t",
                    off, kRotationTolerance));
  }
  if (matrix.determinant() < 0) {
    return error_at_line(source, line,
                         "the rotation's determinant is -1, not +1: it mirrors. Both frames must "
                         "be right-handed");
  }
  if (off > kRounding) set_rotation(motion, nearest_rotation(matrix));
  return motion;
}

Result<RigidMotion> motion_of_quaternion(const Source& source, std::size_t line, const Vec3& move,
                                         const std::array<double, 4>& xyzw) {
  const Eigen::Quaterniond q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  const double length = q.norm();
  if (!(std::abs(length - 1) <= kRotationTolerance)) {
    return error_at_line(source, line,
                         fmt::format("the quaternion has length {:.6g}, not 1 (within {}); its "
                                     "order is qx qy qz qw",
                                     length, kRotationTolerance));
  }
  RigidMotion motion;
  set_rotation(motion, q.normalized().toRotationMatrix());
  motion.move = move;
  return motion;
}

Result<PoseFormat> tell_pose_format(const Source& source, std::span<const NumberedLine> lines) {
  const NumberedLine& first = lines.front();
  if (is_words_of(first, 12)) return PoseFormat::kitti;
  if (is_words_of(first, 8)) return PoseFormat::tum;
  if (is_words_of(first, 4) || is_words_of(first, 16)) return PoseFormat::matrix;
  const auto words = number_words(first.text);
  double value = 0;
  if (!words.empty() && !parse_number(words.front(), value)) return PoseFormat::csv;
  return error_at_line(source, first.number,
                       fmt::format("{} words are no pose: wanted are 12 numbers (KITTI), 8 (TUM), "
                                   "rows of 4 or 16 (matrices), or names of columns (CSV)",
                                   words.size()));
}

Result<PoseTrack> parse_pose_lines(const Source& source, std::span<const NumberedLine> lines,
                                   PoseFormat format) {
  switch (format) {
    case PoseFormat::kitti:
      return parse_kitti_poses(source, lines);
    case PoseFormat::tum:
      return parse_tum(source, lines);
    case PoseFormat::matrix:
      return parse_matrices(source, lines);
    case PoseFormat::csv:
      break;
  }
  return parse_pose_csv(source, lines);
}

}  // namespace curlidar::io
