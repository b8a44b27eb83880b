// SPDX-License-Identifier: BSD-3-Clause
// The rays of a scan: any bytes decode to a table that can be coded again, or to an error, and the
// table's points lie where points may.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>

#include "compact/ray_chunk.hpp"
#include "compact/ray_points.hpp"
#include "hostile/targets/input.hpp"

namespace curlidar::test {

/// The corners and the middle of an image, near and far.
inline std::string check_ray_points(const compact::RowTable& table, std::uint32_t rows,
                                    std::uint32_t columns) {
  const compact::RayPoints points(table, rows);
  for (const std::uint32_t row : {0u, rows / 2, rows - 1}) {
    for (const std::uint32_t column : {0u, columns / 2, columns - 1}) {
      for (const std::int32_t range : {1, 1 << 10, 1 << 20, 1 << 30}) {
        const compact::FixedPoint p = points.fixed(row, column, range);
        const auto farthest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (farthest > compact::kFarthestQ36) return "a point outside the world";
      }
    }
  }
  return "";
}

/// Input: rows - 1, columns - 1 in two bytes, payload.
inline std::string rays_target(ByteSpan bytes) {
  using namespace compact;
  FuzzInput input(bytes);
  const std::uint32_t rows = 1 + input.byte(), columns = 1 + input.two_bytes();
  RowTable table;
  table.turn_columns = columns;
  const Status status = read_rays({ScanPart::rays, input.rest(), 3}, rows, columns, table);
  if (!status) return status.error().message.empty() ? "an error without a message" : "";
  if (!check_rays(table, rows, columns)) return "a table that cannot be written";
  const std::vector<std::byte> coded = write_rays(table);
  RowTable again;
  again.turn_columns = columns;
  if (!read_rays({ScanPart::rays, coded, 0}, rows, columns, again) || again != table) {
    return "coded again, the table differs";
  }
  return check_ray_points(table, rows, columns);
}

}  // namespace curlidar::test
