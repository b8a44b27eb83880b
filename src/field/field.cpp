// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/field.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar {

void Field::place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                      std::span<Vec3> points) const {
  const double elevation = lattice().elevation(row);
  const double flat = std::cos(elevation), up = std::sin(elevation);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double azimuth = lattice().azimuth(columns[i]), r = ranges[i];
    points[i] = {r * flat * std::cos(azimuth), r * flat * std::sin(azimuth), r * up};
  }
}

std::size_t Field::nearest_cell(double row, double column) const {
  const std::size_t rows = lattice().rows(), width = lattice().columns();
  const double inside = std::clamp(std::round(row), 0.0, static_cast<double>(rows - 1));
  const double turns = std::floor(column / static_cast<double>(width));
  const double within = column - turns * static_cast<double>(width);
  return static_cast<std::size_t>(inside) * width +
         static_cast<std::size_t>(std::round(within)) % width;
}

}  // namespace curlidar
