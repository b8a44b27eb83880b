// SPDX-License-Identifier: BSD-3-Clause
#include "codec/cell_points.hpp"

namespace curlidar {

Vec3 CellPoints::metres(std::uint32_t row, std::uint32_t column, std::int32_t range,
                        const DirectionOffset& beside) const {
  const std::uint32_t elevation =
      compact::elevation_at(table_, row, range) + static_cast<std::uint32_t>(beside.up);
  const std::uint32_t azimuth =
      compact::azimuth_of_column(std::uint64_t{table_.first_column} + column, table_.turn_columns) +
      static_cast<std::uint32_t>(beside.across);
  return compact::to_metres(compact::point_at(range, sin_cos_q30(elevation), sin_cos_q30(azimuth)));
}

std::vector<Vec3> cell_points(const compact::RowTable& table, const compact::Image& image,
                              const std::vector<DirectionOffset>& offsets) {
  const CellPoints points(table, image.rows, image.columns);
  std::vector<Vec3> out;
  std::size_t cell = 0;
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    for (std::uint32_t column = 0; column < image.columns; ++column, ++cell) {
      const std::int32_t range = image.range[cell];
      if (range <= 0) continue;
      out.push_back(offsets.empty() ? points.metres(row, column, range)
                                    : points.metres(row, column, range, offsets[out.size()]));
    }
  }
  return out;
}

}  // namespace curlidar
