// SPDX-License-Identifier: BSD-3-Clause
// Tables of rays as sensors have them.
#pragma once

#include <cstdint>
#include <vector>

#include "compact/ray_chunk.hpp"
#include "compact/ray_tables.hpp"
#include "compact/scan_types.hpp"
#include "support/clouds.hpp"

namespace curlidar::test {

/// Positions at a pace of slots a firing, each late by up to `jitter` slots.
inline std::vector<std::uint32_t> turning(std::uint32_t slots, double pace, std::uint64_t jitter) {
  Random random(7);
  std::vector<std::uint32_t> firings;
  for (double at = 0; at + static_cast<double>(jitter) < slots; at += pace) {
    const auto late = static_cast<std::uint32_t>(jitter == 0 ? 0 : random.below(jitter + 1));
    const std::uint32_t position = static_cast<std::uint32_t>(at) + late;
    if (firings.empty() || position > firings.back()) firings.push_back(position);
  }
  return firings;
}

/// Rows in no order, their azimuth offsets repeating every four and lateral offsets every two.
inline compact::RowTable inline_rays(std::int32_t rows, std::vector<std::uint32_t> firings,
                                     std::uint32_t slots) {
  Random random(2);
  compact::RowTable table;
  compact::RayTable& rays = table.rays.emplace();
  rays.slots = slots;
  rays.firings = std::move(firings);
  rays.range_unit_q48 = 562949953421;
  table.turn_columns = static_cast<std::uint32_t>(rays.firings.size());
  table.elevation_shift = 8;
  rays.azimuth_shift = 10;
  rays.height_shift = 1;
  rays.phase_shift = 2;
  for (std::int32_t row = 0; row < rows; ++row) {
    table.elevation.push_back(((row * 7) % rows - rows / 2) * ((1 << 28) / rows / 256 * 256));
    compact::Ray& ray = rays.rays.emplace_back();
    ray.azimuth_offset = (row % 4 - 2) * 36000 * 1024;
    ray.height = row * 2 - 32;
    ray.lateral = row % 2 == 0 ? 1703 : -1703;
    ray.range_phase = static_cast<std::int32_t>(random.below(16)) * 4 - 32;
  }
  return table;
}

inline compact::RowTable frozen_rays(std::uint32_t number, std::vector<std::uint32_t> firings) {
  compact::RowTable table;
  compact::use_beam_table(number, table);
  table.rays->firings = std::move(firings);
  table.rays->range_unit_q48 = compact::beam_table(number)->range_unit_q48;
  table.turn_columns = static_cast<std::uint32_t>(table.rays->firings.size());
  return table;
}

inline void set_motion(compact::RayTable& rays, bool full) {
  rays.turn_shift = 6;
  rays.move_shift = 3;
  rays.motion.turn = {64 * 1001, -64 * 7003, 64 * 300001};
  rays.motion.move = {8 * 12345, -8 * 20, 0};
  if (!full) return;
  rays.motion.turn2 = {64, -64, 0};
  rays.motion.rigid_move = {8 * 77, 0, -8 * 12345};
}

inline std::uint32_t rows_of(const compact::RowTable& table) {
  return static_cast<std::uint32_t>(table.elevation.size());
}

}  // namespace curlidar::test
