// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the rows against exact truth: a simulated scan is coded and made denser,
// each method on its own grid; every point on no coded row is compared with the surface that its
// own ray meets.
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/try.hpp"
#include "curlidar/paper.hpp"
#include "curlidar/simulate.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/methods.hpp"
#include "report/measure/truth.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {

RayErrors judge(const Scene& scene, const std::vector<RayRange>& rays, const RangeLimits& limits) {
  RayTally tally(limits);
  for (const RayRange& ray : rays) {
    Hit hit;
    const bool met = scene.cast({}, ray.direction, hit);
    tally.add(ray.range_m, met ? std::optional(hit.range_m) : std::nullopt);
  }
  return tally.errors();
}

Result<Simulated> simulate_scan(const std::string& scene, const std::string& sensor,
                                const std::string& preset, std::uint64_t seed) {
  Simulated simulated;
  CURLIDAR_TRY_ASSIGN(world, make_scene(scene, seed));
  simulated.scene = std::move(world);
  CURLIDAR_TRY_ASSIGN(profile, builtin_sensor(sensor));
  CURLIDAR_TRY_ASSIGN(paper, paper_preset(preset));
  CURLIDAR_TRY_ASSIGN(cloud, simulate(*simulated.scene, profile, {.seed = seed}));
  CURLIDAR_TRY_ASSIGN(rings, assign_rings(cloud, profile));
  simulated.cloud = std::move(cloud);
  simulated.settings.profile = Profile::paper;
  simulated.settings.paper = paper;
  simulated.settings.sensor = std::move(profile);
  simulated.settings.attributes.emplace();
  simulated.rings = std::move(rings);
  return simulated;
}

Result<RangeLimits> limits_of(const Cloud& cloud, const EncodeSettings& settings) {
  CURLIDAR_TRY_ASSIGN(grid, gridded(cloud, settings));
  const PaperSettings limits = range_limits(settings.paper, grid);
  return RangeLimits{limits.min_range_m, limits.max_range.metres};
}

Status truth(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(factors, parse_factors(arguments.option("factors", "2,4,8")));
  CURLIDAR_TRY_ASSIGN(baseline, arguments.number("baseline", 0, 0, 1));
  CURLIDAR_TRY_ASSIGN(seed, arguments.number("seed", 1, 0, 1u << 30));
  CURLIDAR_TRY_ASSIGN(
      simulated, simulate_scan(arguments.words[0], arguments.words[1], arguments.words[2], seed));
  CURLIDAR_TRY_ASSIGN(limits, limits_of(simulated.cloud, simulated.settings));
  print_line({{"returns", count_returns(simulated.cloud)},
              {"min_range_m", limits.min_m},
              {"max_range_m", limits.max_m}});
  std::vector<Method> methods = make_methods(
      {.cloud = &simulated.cloud,
       .paper = simulated.settings,
       .compact_sensor = {},  // simulated beams start at the origin, those of profiles may not
       .ring_of_point = simulated.rings.ring_of_point,
       .ring_elevations = simulated.rings.ring_elevations,
       .columns = simulated.settings.sensor->columns});
  if (baseline == 1) {
    methods.insert(methods.begin(), baseline_method(simulated.cloud, simulated.settings));
  }
  for (const Method& method : methods) {
    if (!method.sampler) {
      print_line(method.header());
      continue;
    }
    for (const double factor : factors) {
      CURLIDAR_TRY_ASSIGN(rays, method.sampler->between_rows(factor));
      Json line = method.header();
      line["factor"] = factor;
      line.update(to_json(judge(*simulated.scene, rays, limits)));
      print_line(line);
    }
  }
  return {};
}

}  // namespace curlidar::bench
