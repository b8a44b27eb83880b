// SPDX-License-Identifier: BSD-3-Clause
// Scans computed from integers, as a driver does, with places that are known.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "compact/ray_tables.hpp"
#include "sensor/lattice.hpp"
#include "unit/sensor/synthetic.hpp"

namespace curlidar::test {

/// The frozen beam table of a name.
inline BeamModel frozen_table(const std::string& name) {
  const compact::BeamTable* table = compact::beam_table(name);
  BeamModel model;
  model.table = name;
  model.slots = table->slots;
  model.range_unit_m = static_cast<double>(table->range_unit_q48) * 0x1p-48;
  const double radians = 2 * std::numbers::pi * 0x1p-32;
  for (std::size_t k = 0; k < table->rays.size(); ++k) {
    const compact::Ray& ray = table->rays[k];
    model.beams.push_back({table->elevation[k] * radians, ray.azimuth_offset * radians,
                           ray.height * 0x1p-16, ray.lateral * 0x1p-16, ray.range_phase * 0x1p-16});
  }
  return model;
}

/// A sensor like the HDL-64E: two blocks of beams beside the axis, spread over the azimuth.
inline BeamModel two_blocks(std::size_t rings = 16, std::uint32_t slots = 4000) {
  BeamModel model;
  model.slots = slots;
  model.range_unit_m = .002;
  Random random(3);
  for (std::size_t k = 0; k < rings; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(rings);
    const bool lower = 2 * k >= rings;
    model.beams.push_back({.03 - .45 * share, .2 * (random.uniform() - .5),
                           (lower ? .12 : .2) - .01 * share, k % 2 == 0 ? -.026 : .026,
                           .002 * (random.uniform() - .5)});
  }
  return model;
}

struct LatticeScanOptions {
  std::uint32_t step = 2;  ///< encoder positions between firings
  double near_m = 3, far_m = 60;
  double occupancy = .8;
  double grid_m = .001;  ///< coordinates are rounded to it; 0: to float32
  MotionTwist motion;
};

struct LatticeScan {
  Cloud cloud;
  Detection rings;
  std::vector<std::uint32_t> position;  ///< of the encoder, for each point
  std::vector<double> range;
};

inline double rounded(double value, double grid_m) {
  return grid_m > 0 ? std::round(value / grid_m) * grid_m : static_cast<float>(value);
}

/// Ring by ring, each from the seam behind the sensor.
inline LatticeScan make_lattice_scan(const BeamModel& model, const LatticeScanOptions& options) {
  LatticeScan scan;
  Random random(5);
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    Ring ring;
    ring.elevation = model.beams[k].elevation;
    scan.rings.sensor.rings.push_back(ring);
    scan.rings.ring_elevations.push_back(ring.elevation);
    for (std::uint32_t position = 0; position < model.slots; position += options.step) {
      if (random.uniform() > options.occupancy) continue;
      const double metres =
          options.near_m + (options.far_m - options.near_m) * std::pow(random.uniform(), 2);
      const double range = std::round(metres / model.range_unit_m) * model.range_unit_m;
      const Vec3 p = apply_motion(options.motion, lattice_point(model, k, position, range));
      scan.cloud.positions.push_back({rounded(p.x, options.grid_m), rounded(p.y, options.grid_m),
                                      rounded(p.z, options.grid_m)});
      scan.rings.ring_of_point.push_back(static_cast<std::uint16_t>(k));
      scan.position.push_back(position);
      scan.range.push_back(range);
    }
  }
  scan.cloud.width = static_cast<std::uint32_t>(scan.cloud.size());
  return scan;
}

}  // namespace curlidar::test
