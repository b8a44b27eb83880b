// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the rings against exact truth: a simulated scan is coded, and every method
// is asked along the same rays between the rings, of which the simulator knows the surface.
#include "report/measure/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/try.hpp"
#include "curlidar/paper.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

constexpr double kRingsOfPaper = 64;  // of the sensors that its presets were made for

/// Prints what a method tells, within the limits and (`whole`) within none.
void print_method(const Method& method, double factor, const std::vector<RangeEstimate>& told,
                  const std::vector<RangeEstimate>& edge_aware, const Judge& limited,
                  const Judge& whole) {
  Json line = method.header();
  line["factor"] = factor;
  line.update(to_json(limited.errors(told)));
  line["equal"] = to_json(limited.equal_cut(told, edge_aware));
  line["whole"] = to_json(whole.errors(told));
  line["whole"]["equal"] = to_json(whole.equal_cut(told, edge_aware));
  if (method.name == "compact") {
    line["confidence"] = to_json(whole.confidence(told));
    line["trades"] = to_json(whole.trades(told));
  }
  print_line(line);
}

void print_factor(const std::vector<Method>& methods, const Simulated& simulated, double factor,
                  std::size_t most, const RangeLimits& limits) {
  const std::vector<Vec3> rays = rays_between(simulated.rings, factor, most);
  const std::vector<double> truth = true_ranges(*simulated.scene, rays);
  const Judge limited(truth, limits), whole(truth, {0, simulated.settings.sensor->max_range_m});
  const std::vector<RangeEstimate> edge_aware = methods.back().sampler->tell(rays);
  for (const Method& method : methods) {
    if (method.sampler) {
      print_method(method, factor, method.sampler->tell(rays), edge_aware, limited, whole);
    }
  }
}

/// The sensor as it is simulated: all beams leave from the origin.
SensorProfile from_origin(SensorProfile sensor) {
  sensor.beam_origin_radius_m = 0;
  for (Ring& ring : sensor.rings) ring.vertical_offset_m = ring.horizontal_offset_m = 0;
  return sensor;
}

}  // namespace

Result<Simulated> simulate_scan(const std::string& scene, const std::string& sensor,
                                const std::string& preset, std::uint64_t seed) {
  Simulated simulated;
  CURLIDAR_TRY_ASSIGN(world, make_scene(scene, seed));
  simulated.scene = std::move(world);
  CURLIDAR_TRY_ASSIGN(builtin, builtin_sensor(sensor));
  const SensorProfile profile = from_origin(std::move(builtin));
  CURLIDAR_TRY_ASSIGN(paper, paper_preset(preset));
  CURLIDAR_TRY_ASSIGN(cloud, simulate(*simulated.scene, profile, {.seed = seed}));
  CURLIDAR_TRY_ASSIGN(rings, assign_rings(cloud, profile));
  simulated.cloud = std::move(cloud);
  simulated.settings.profile = Profile::paper;
  simulated.settings.paper = paper;
  simulated.settings.sensor = profile;
  simulated.settings.attributes.emplace();
  simulated.settings.threads = 1;
  const double times = kRingsOfPaper / static_cast<double>(profile.rings.size());
  if (times > 1) simulated.settings = for_fewer_rings(simulated.settings, profile, times);
  simulated.rings = std::move(rings);
  return simulated;
}

MethodInput input_of(const Simulated& simulated) {
  return {.cloud = &simulated.cloud,
          .paper = simulated.settings,
          .compact_sensor = {},  // it finds its own
          .ring_of_point = simulated.rings.ring_of_point,
          .ring_elevations = simulated.rings.ring_elevations,
          .columns = simulated.settings.sensor->columns};
}

std::vector<Vec3> rays_between(const Detection& rings, double factor, std::size_t most) {
  const Lattice lattice = Lattice::from_rings(rings.ring_elevations, rings.sensor.columns);
  const DenseGrid grid(lattice, factor, 1);
  const auto between = [](double row) { return row > 0 && std::abs(row - std::round(row)) > 1e-9; };
  std::size_t rows = 0;
  for (std::size_t i = 0; i < grid.rows; ++i) rows += between(grid.row(i)) ? 1 : 0;
  const std::size_t stride = std::max<std::size_t>(1, rows * grid.columns / most);
  std::vector<Vec3> rays;
  for (std::size_t i = 0, row = 0; i < grid.rows; ++i) {
    if (!between(grid.row(i))) continue;
    for (std::size_t j = row++ % stride; j < grid.columns; j += stride) {
      rays.push_back(lattice.direction(grid.row(i), grid.column(j)));
    }
  }
  return rays;
}

std::vector<double> true_ranges(const Scene& scene, std::span<const Vec3> directions) {
  std::vector<double> ranges(directions.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    Hit hit;
    if (scene.cast({}, directions[i], hit)) ranges[i] = hit.range_m;
  }
  return ranges;
}

Status truth(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(factors, parse_factors(arguments.option("factors", "2,4,8")));
  CURLIDAR_TRY_ASSIGN(baseline, arguments.number("baseline", 0, 0, 1));
  CURLIDAR_TRY_ASSIGN(seed, arguments.number("seed", 1, 0, 1u << 30));
  CURLIDAR_TRY_ASSIGN(most, arguments.number("rays", 40'000, 100, 1u << 30));
  CURLIDAR_TRY_ASSIGN(
      simulated, simulate_scan(arguments.words[0], arguments.words[1], arguments.words[2], seed));
  CURLIDAR_TRY_ASSIGN(limits, limits_of(simulated.cloud, simulated.settings));
  print_line({{"returns", count_returns(simulated.cloud)},
              {"min_range_m", limits.min_m},
              {"max_range_m", limits.max_m}});
  std::vector<Method> methods = make_methods(input_of(simulated));
  if (baseline == 1) {
    methods.insert(methods.begin(), baseline_method(simulated.cloud, simulated.settings));
  }
  for (const Method& method : methods) {
    if (!method.sampler) print_line(method.header());
  }
  for (const double factor : factors) print_factor(methods, simulated, factor, most, limits);
  return {};
}

}  // namespace curlidar::bench
