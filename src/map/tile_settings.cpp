// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <fmt/format.h>

#include "base/try.hpp"
#include "map/surface_tile.hpp"

namespace curlidar {
namespace {

Status power_of_two(const char* name, double value, double least, double most) {
  int exponent = 0;
  if (value >= least && value <= most && std::frexp(value, &exponent) == 0.5) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("{} is {:g} m; it must be a power of two from {:g} to {:g} m", name,
                           value, least, most)};
}

Status within(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("{} is {:g}; it must be from {:g} to {:g}", name, value, least, most)};
}

}  // namespace

Status validate(const SurfaceSettings& settings, double side_m) {
  CURLIDAR_TRY(power_of_two("root_m", settings.root_m, 0.5, 16));
  CURLIDAR_TRY(power_of_two("smallest_leaf_m", settings.smallest_leaf_m, 0.0625, 4));
  CURLIDAR_TRY(power_of_two("footprint_m", settings.footprint_m, 0.0625, 4));
  CURLIDAR_TRY(within("step_m", settings.step_m, 0.001, 2));
  CURLIDAR_TRY(within("metres_per_bit", settings.metres_per_bit, 0, 1000));
  CURLIDAR_TRY(within("drop_m", settings.drop_m, 0.001, 10));
  CURLIDAR_TRY(within("bare_samples", settings.bare_samples, 0, 1e6));
  CURLIDAR_TRY(within("full_weight", settings.full_weight, 1, 1e6));
  if (settings.intensity) {
    CURLIDAR_TRY(within("intensity_step", settings.intensity_step, 1e-6, 1e6));
  }
  if (settings.smallest_leaf_m > settings.root_m ||
      settings.root_m / settings.smallest_leaf_m > 32) {
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("smallest_leaf_m is {:g} m; it must be from 1/32 of root_m ({:g} m) to all "
                    "of it",
                    settings.smallest_leaf_m, settings.root_m)};
  }
  if (settings.root_m / settings.footprint_m > 64 || settings.footprint_m > settings.root_m) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("footprint_m is {:g} m; it must be from 1/64 of root_m ({:g} m)",
                             settings.footprint_m, settings.root_m)};
  }
  const double roots = side_m / settings.root_m;
  if (!(roots >= 1 && roots <= 64) || roots != std::floor(roots)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("a tile's side is {:g} m; it must be 1 to 64 times root_m ({:g} m)",
                             side_m, settings.root_m)};
  }
  return {};
}

}  // namespace curlidar
