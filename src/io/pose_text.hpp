// SPDX-License-Identifier: BSD-3-Clause
// Lines of numbers that are poses.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "curlidar/pose.hpp"
#include "io/formats.hpp"

namespace curlidar::io {

/// A line of a text with its number, from 1.
struct NumberedLine {
  std::string_view text;
  std::size_t number = 0;
  std::size_t blanks_before = 0;  ///< empty lines between it and the one before
};

/// The lines that are neither empty nor comments. Errors: limit_exceeded for a line beyond
/// kMaxLineBytes.
Result<std::vector<NumberedLine>> content_lines(const Source& source);
/// Words between blanks, commas and semicolons.
std::vector<std::string_view> number_words(std::string_view line);
/// All words of a line as finite numbers; `wanted` of them, if that is not 0.
Result<std::vector<double>> line_numbers(const Source& source, const NumberedLine& line,
                                         std::size_t wanted);

/// The motion of 12 numbers, rows of a 3 x 4 matrix. Errors: corrupt if the first three columns are
/// no rotation within kRotationTolerance; what they lack of one is taken out.
Result<RigidMotion> motion_of_matrix(const Source& source, std::size_t line,
                                     std::span<const double> numbers);
/// The motion of a place and of a quaternion (x, y, z, w), of length 1 within the tolerance.
Result<RigidMotion> motion_of_quaternion(const Source& source, std::size_t line, const Vec3& move,
                                         const std::array<double, 4>& xyzw);

Result<PoseTrack> parse_pose_lines(const Source& source, std::span<const NumberedLine> lines,
                                   PoseFormat format);
Result<PoseTrack> parse_pose_csv(const Source& source, std::span<const NumberedLine> lines);
/// What the first lines look like. Errors: corrupt if they are no poses.
Result<PoseFormat> tell_pose_format(const Source& source, std::span<const NumberedLine> lines);

}  // namespace curlidar::io
