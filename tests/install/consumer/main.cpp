// SPDX-License-Identifier: BSD-3-Clause
// A scan through the installed library: a round room, encoded, decoded and made denser.
#include <curlidar/reconstruct.hpp>
#include <curlidar/sensor.hpp>
#include <curlidar/version.hpp>

#include <cmath>
#include <cstdio>

namespace {

constexpr double kRadius = 8;

curlidar::Cloud round_room(const curlidar::SensorProfile& sensor) {
  curlidar::Cloud cloud;
  for (const double elevation : sensor.elevations()) {
    for (int column = 0; column < 1024; ++column) {
      const double azimuth = -3.14159265358979 + 6.28318530717959 * column / 1024;
      cloud.positions.push_back(curlidar::direction_of(elevation, azimuth) *
                                (kRadius / std::cos(elevation)));
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

int fail(const char* step, const curlidar::Error& error) {
  std::fprintf(stderr, "%s: %s\n", step, error.message.c_str());
  return 1;
}

}  // namespace

int main() {
  std::printf("curlidar %s\n", curlidar::version());
  const auto sensor = curlidar::builtin_sensor("vlp16");
  if (!sensor) return fail("builtin_sensor", sensor.error());

  curlidar::EncodeSettings settings;
  settings.sensor = *sensor;
  settings.paper.min_range_m = 1;
  settings.paper.max_range = {};
  const auto encoded = curlidar::encode(round_room(*sensor), settings);
  if (!encoded) return fail("encode", encoded.error());
  const auto scan = curlidar::decode(encoded->bytes);
  if (!scan) return fail("decode", scan.error());
  const auto same = curlidar::reconstruct(*scan);
  if (!same) return fail("reconstruct", same.error());
  curlidar::ReconstructSettings denser;
  denser.rows = 4;
  const auto dense = curlidar::reconstruct(*scan, denser);
  if (!dense) return fail("reconstruct 4x1", dense.error());

  const std::size_t coded = encoded->report.points_coded;
  std::printf("%zu returns coded in %zu bytes, %zu points at 4x1\n", coded, encoded->bytes.size(),
              dense->size());
  double worst = 0;
  for (const curlidar::Vec3& p : dense->positions) {
    worst = std::fmax(worst, std::fabs(std::hypot(p.x, p.y) - kRadius));
  }
  std::printf("farthest point from the wall: %.3f m\n", worst);
  const bool good =
      coded > 10000 && same->size() == coded && dense->size() > 2 * coded && worst < 0.3;
  return good ? 0 : 1;
}
