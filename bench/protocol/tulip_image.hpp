// SPDX-License-Identifier: BSD-3-Clause
// The range images with which TULIP (Yang et al., CVPR 2024) measures the upsampling of KITTI
// scans: 64 rows of which every fourth is given, the others predicted.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/cloud.hpp"

namespace curlidar::bench::tulip {

inline constexpr std::size_t kRows = 64, kColumns = 1024;
inline constexpr std::size_t kEvery = 4;  ///< rows 0, 4, .. 60 are given
inline constexpr double kLowest_deg = -24.8, kHighest_deg = 2;
inline constexpr double kLongest_m = 120;            ///< longer ranges never get into an image
inline constexpr double kLeast_m = 2, kMost_m = 80;  ///< of what is judged

/// Ranges in metres, row 0 lowest; 0 where there is none.
struct Image {
  std::vector<double> range_m = std::vector<double>(kRows * kColumns, 0);

  double& at(std::size_t row, std::size_t column) { return range_m[row * kColumns + column]; }
  double at(std::size_t row, std::size_t column) const { return range_m[row * kColumns + column]; }
};

/// Where the original places the points of a cell, radians. Columns are evenly spaced although
/// that of +x, by the way its numbers are cut, is seen twice as wide as the others.
double elevation_of_row(double row);
double azimuth_of_column(double column);

/// Where the original puts a point; false outside of the image.
bool locate(const Vec3& point, std::size_t& row, std::size_t& column);

/// The image of a scan in the sensor's own frame, motion undone: of the points of a cell the last
/// one of the cloud counts, and an image holds no range beyond kMost_m.
Image project(const Cloud& cloud);

/// The given rows alone, the others empty.
Image given_rows(const Image& image);

/// The points of an image where the original places them.
Cloud points_of(const Image& image);

}  // namespace curlidar::bench::tulip
