// SPDX-License-Identifier: BSD-3-Clause
// How far is it in these directions, and how sure is that? Asked of a .curl file, or of a small
// simulated scan if none is named.
//
//   range_at [SCAN.curl]
#include <curlidar/io.hpp>
#include <curlidar/reconstruct.hpp>
#include <curlidar/simulate.hpp>

#include <array>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

namespace {

curlidar::Result<std::vector<std::byte>> simulated_file() {
  const auto scene = curlidar::make_scene("street");
  if (!scene) return scene.error();
  const auto sensor = curlidar::builtin_sensor("vlp16");
  if (!sensor) return sensor.error();
  const auto cloud = curlidar::simulate(**scene, *sensor);
  if (!cloud) return cloud.error();
  curlidar::EncodeSettings settings;
  settings.compact.effort = 1;
  settings.compact.target_value = 0.02;  // metres of mean error
  auto encoded = curlidar::encode(*cloud, settings);
  if (!encoded) return encoded.error();
  return std::move(encoded->bytes);
}

/// A ring of its own between those of the sensor, and a fan upwards into the sky.
std::vector<curlidar::Vec3> some_directions() {
  std::vector<curlidar::Vec3> directions;
  for (int i = 0; i < 100'000; ++i) {
    directions.push_back(curlidar::direction_of(-0.035, 6.2831853 * i / 100'000));
  }
  for (int i = 0; i < 100; ++i) directions.push_back({1, 0, 0.01 * i});
  return directions;
}

int fail(const curlidar::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto bytes = argc > 1 ? curlidar::read_file(argv[1]) : simulated_file();
  if (!bytes) return fail(bytes.error());
  const auto scan = curlidar::decode(*bytes);
  if (!scan) return fail(scan.error());

  // The field is made once and asked from any thread.
  const auto field = curlidar::continuous_field(*scan);
  const std::vector<curlidar::Vec3> directions = some_directions();
  std::vector<curlidar::RangeEstimate> estimates(directions.size());
  field->range_at(directions, estimates, /*threads=*/0);

  std::array<std::size_t, 3> seen{};
  std::size_t sure = 0;
  for (const curlidar::RangeEstimate& estimate : estimates) {
    ++seen[static_cast<std::size_t>(estimate.seen)];
    if (estimate.valid() && estimate.confidence >= 0.8F) ++sure;
  }
  std::printf(
      "%zu directions: %zu surfaces (%zu of them within 5 cm at 80 %%), %zu times nothing, "
      "%zu unknown\n",
      estimates.size(), seen[2], sure, seen[1], seen[0]);

  // From a hand's breadth above the sensor, ahead and a little down.
  const curlidar::Sightline line{{0, 0, 0.1}, {1, 0, -0.1}};
  curlidar::RangeEstimate one;
  field->range_along(std::span(&line, 1), std::span(&one, 1));
  if (one.valid()) std::printf("ahead: %.2f m, confidence %.2f\n", one.range_m, one.confidence);

  // The same directions as a cloud with attributes and normals, one point for each.
  const auto cloud = curlidar::reconstruct_directions(*scan, directions, {.normals = true});
  if (!cloud) return fail(cloud.error());
  std::printf("%zu of %zu points\n", curlidar::count_returns(*cloud), cloud->size());
  return seen[2] == curlidar::count_returns(*cloud) && seen[2] > 0 ? 0 : 1;
}
