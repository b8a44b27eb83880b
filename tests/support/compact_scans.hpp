// SPDX-License-Identifier: BSD-3-Clause
// Scans in the compact profile's integers: a street made of whole numbers, and real scans.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "compact/scan_encoder.hpp"
#include "compact/scan_types.hpp"

namespace curlidar::test {

struct CompactScan {
  compact::Image image;
  compact::RowTable table;
};

/// Ground 1.7 m below the sensor, a wall to the left, posts, gaps and a little noise. Integers
/// only, so that every machine makes the same.
inline CompactScan integer_street(std::uint32_t rows, std::uint32_t columns,
                                  std::uint32_t noise = 600) {
  constexpr std::int64_t unit = compact::kRangeUnit;
  CompactScan scan;
  scan.image.rows = rows;
  scan.image.columns = columns;
  scan.table.turn_columns = columns;
  scan.table.elevation_shift = 12;
  std::uint64_t random = 1;
  const auto next = [&] {
    random = random * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>(random >> 33);
  };
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::int64_t top = std::int64_t{1} << 26;  // 5.6 degrees
    scan.table.elevation.push_back(
        static_cast<std::int32_t>(top - std::int64_t{row} * (std::int64_t{5} << 26) / rows));
  }
  round_to_shifts(scan.table);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const SinCos e = sin_cos_q30(static_cast<std::uint32_t>(scan.table.elevation[row]));
    for (std::uint32_t column = 0; column < columns; ++column) {
      const SinCos a = sin_cos_q30(compact::azimuth_of_column(column, columns));
      std::int64_t range = 0;
      const auto nearer = [&](std::int64_t distance, std::int64_t cosine_q30) {
        if (cosine_q30 <= 1 << 24) return;
        const std::int64_t hit = (distance << 30) / cosine_q30;
        if (hit < 80 * unit && (range == 0 || hit < range)) range = hit;
      };
      nearer(unit * 17 / 10, -std::int64_t{e.sin});
      nearer(unit * 8, (std::int64_t{e.cos} * a.sin) >> 30);
      if (column % 37 < 3) nearer(unit * (6 + column % 5), e.cos);
      if (next() % 16 == 0 || range == 0) {
        range = 0;
      } else {
        range += static_cast<std::int64_t>(next() % (2 * noise + 1)) - noise;
      }
      scan.image.range.push_back(static_cast<std::int32_t>(range));
    }
  }
  return scan;
}

/// The chunks as a reader of a file finds them; offsets count from 0 as if nothing lay between.
inline compact::ScanChunks views_of(const std::vector<compact::ScanChunk>& chunks) {
  compact::ScanChunks views;
  std::size_t offset = 0;
  for (const compact::ScanChunk& chunk : chunks) {
    views.chunks.push_back({chunk.part, chunk.payload, offset, true});
    offset += chunk.payload.size();
  }
  return views;
}

/// Mean |range - decoded| over the returns, Q16 metres.
inline double mean_error(const compact::Image& image, const std::vector<std::int32_t>& decoded) {
  double sum = 0, returns = 0;
  for (std::size_t i = 0; i < image.range.size(); ++i) {
    if (image.range[i] == 0) continue;
    sum += std::abs(static_cast<double>(image.range[i]) - decoded[i]);
    ++returns;
  }
  return returns > 0 ? sum / returns : 0;
}

inline double total_bits(const compact::Breakdown& b) {
  return b.header + b.mask + b.partition + b.modes + b.coefficients + b.labels + b.residual;
}

}  // namespace curlidar::test
