// SPDX-License-Identifier: BSD-3-Clause
// Reconstruction between the samples by the paper's profile, against exact truth, for every
// simulated scene; `report_measure truth` measures the other methods as well.  Usage: scene_truth
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/truth.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::bench;

/// A scene with the sensor and the preset that people would take into it.
struct Case {
  const char* scene;
  const char* sensor;
  const char* preset;
};
constexpr Case kCases[] = {{"street", "hdl64e-kitti", "outdoor"},
                           {"forest", "hdl64e-kitti", "outdoor"},
                           {"newer-college", "os1-64-gen1", "newer-college"},
                           {"room", "os1-64-gen1", "indoor"},
                           {"corridor", "os1-64-gen1", "indoor"}};

constexpr std::size_t kRays = 100'000;  // of each factor

Status print_case(const Case& c) {
  CURLIDAR_TRY_ASSIGN(simulated, simulate_scan(c.scene, c.sensor, c.preset, 1));
  CURLIDAR_TRY_ASSIGN(limits, limits_of(simulated.cloud, simulated.settings));
  for (const Method& method : paper_methods(simulated.cloud, simulated.settings)) {
    if (!method.sampler) return Error{ErrorCode::invalid_argument, method.skipped};
    for (const double factor : {2.0, 4.0, 8.0}) {
      const std::vector<Vec3> rays = rays_between(simulated.rings, factor, kRays);
      const Judge judge(true_ranges(*simulated.scene, rays), limits);
      const RayErrors errors = judge.errors(method.sampler->tell(rays));
      fmt::print(
          "| {} | {} | {} | {} | {:.1f} | {:g}x1 | {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | "
          "{:.1f} | {} |\n",
          c.scene, c.sensor, c.preset, method.setting, method.cp_paper_percent, factor,
          errors.points, errors.stats.mean, errors.stats.p50, errors.stats.p95,
          100 * errors.within_5cm, 100 * errors.completeness, errors.no_surface);
    }
  }
  return {};
}

}  // namespace

int main() {
  fmt::print(
      "Errors of interpolated points along their rays, metres. Complete: of the rays that meet a "
      "surface within the range limits. Sky: points where there is no surface.\n\n"
      "| scene | sensor | preset | setting | CP % | R | points | mean | median | p95 | within 5 cm "
      "% | "
      "complete % | sky |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& c : kCases) {
    const Status status = print_case(c);
    if (status) continue;
    fmt::print(stderr, "scene_truth: {}: {}\n", c.scene, status.error().message);
    return 1;
  }
  return 0;
}
