// SPDX-License-Identifier: BSD-3-Clause
#include "density/asked_scan.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/simulate.hpp"
#include "protocol/held_out_lines.hpp"
#include "protocol/ring_split.hpp"

namespace curlidar::density {
namespace {

EncodeSettings settings_for(const SensorProfile& sensor, double step_m) {
  EncodeSettings settings;
  settings.profile = Profile::compact;
  settings.compact.coverage = Coverage::every_return;
  settings.compact.keep_order = false;
  settings.compact.target = CompactTarget::step;
  settings.compact.target_value = step_m;
  settings.compact.index = false;
  settings.attributes.emplace();
  settings.sensor = sensor;
  settings.threads = 1;
  return settings;
}

/// Numbers that are the same everywhere.
class Luck {
 public:
  explicit Luck(std::uint64_t seed) : state_(seed * 2654435769u + 1) {}
  double uniform() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 40) / (1 << 24);
  }

 private:
  std::uint64_t state_;
};

/// As the simulator takes it.
SensorProfile with_beams_from_origin(SensorProfile sensor) {
  sensor.name += "-from-origin";
  sensor.beam_origin_radius_m = 0;
  sensor.slots = 0;
  sensor.range_unit_m = 0;
  for (Ring& ring : sensor.rings) {
    ring.vertical_offset_m = ring.horizontal_offset_m = ring.range_phase_m = 0;
  }
  return sensor;
}

}  // namespace

Result<AskedScan> Coder::code(const std::string& name, const Cloud& cloud,
                              const SensorProfile& sensor, double step_m) const {
  const std::string path =
      folder_.empty() ? "" : fmt::format("{}/{}-{}.curl", folder_, name, step_m);
  std::vector<std::byte> bytes;
  if (!path.empty() && std::filesystem::exists(path)) {
    CURLIDAR_TRY_ASSIGN(read, read_file(path));
    bytes.assign(read.begin(), read.end());
  } else {
    CURLIDAR_TRY_ASSIGN(encoded, encode(cloud, settings_for(sensor, step_m)));
    bytes = std::move(encoded.bytes);
    if (!path.empty()) CURLIDAR_TRY(write_file(path, bytes));
  }
  CURLIDAR_TRY_ASSIGN(decoded, decode(bytes));
  if (!decoded.field || !decoded.compact ||
      (decoded.records && decoded.records->lattice == RecordLattice::none)) {
    return Error{ErrorCode::unsupported, name + ": coded without a field"};
  }
  AskedScan scan;
  scan.field = decoded.field;
  return scan;
}

Result<AskedScan> ask_simulated(const Coder& coder, const SimulatedScan& what, double step_m,
                                std::size_t places) {
  CURLIDAR_TRY_ASSIGN(scene, make_scene(what.scene, what.seed));
  CURLIDAR_TRY_ASSIGN(profile, builtin_sensor(what.sensor));
  const SensorProfile sensor = with_beams_from_origin(std::move(profile));
  CURLIDAR_TRY_ASSIGN(cloud, simulate(*scene, sensor, {.seed = what.seed}));
  cloud.attributes.clear();
  const std::string name = fmt::format("{}-{}-{}", what.scene, what.sensor, what.seed);
  CURLIDAR_TRY_ASSIGN(scan, coder.code(name, cloud, sensor, step_m));
  scan.group = what.scene;
  Luck luck(what.seed);
  const std::vector<double> elevations = sensor.elevations();
  for (std::size_t i = 0; i < places; ++i) {
    const double row = luck.uniform() * static_cast<double>(elevations.size() - 1);
    // Between the rings at quarters, as rows four times as dense look.
    const auto below = std::min(static_cast<std::size_t>(row), elevations.size() - 2);
    const double share = 0.25 * std::floor(1 + 3 * luck.uniform());
    const double elevation =
        elevations[below] + (elevations[below + 1] - elevations[below]) * share;
    // Every other one on a column, where most grids look.
    double column = luck.uniform() * sensor.columns;
    if (i % 2 == 0) column = std::floor(column);
    const double azimuth = (2 * column / sensor.columns - 1) * std::numbers::pi;
    const Vec3 direction = direction_of(elevation, azimuth);
    Hit hit;
    const bool met = scene->cast({}, direction, hit) && hit.range_m <= sensor.max_range_m;
    scan.places.push_back({{{}, direction}, met ? hit.range_m : 0});
  }
  return scan;
}

Result<AskedScan> ask_held_out(const Coder& coder, const OwnScan& own, std::size_t every,
                               double step_m, std::size_t places) {
  constexpr std::size_t kLeastRings = 5;
  const bench::RingSplit split =
      bench::split_rings(own.cloud, own.rings, static_cast<std::uint32_t>(every));
  if (split.sensor.rings.size() < kLeastRings || split.held_out.empty()) {
    return Error{ErrorCode::unsupported, fmt::format("{}: too few rings", own.path)};
  }
  std::string name = fmt::format("{}-every-{}", own.path, every);
  std::replace(name.begin(), name.end(), '/', '_');
  CURLIDAR_TRY_ASSIGN(scan, coder.code(name, split.coded, split.sensor, step_m));
  const bench::AskedLines asked = bench::lines_of(split, own.beams());
  const std::size_t step = std::max<std::size_t>(asked.lines.size() / places, 1);
  for (std::size_t i = 0; i < asked.lines.size(); i += step) {
    const double range_m = asked.true_m[i];
    scan.places.push_back({asked.lines[i], range_m > 0 ? range_m : 0});
  }
  return scan;
}

}  // namespace curlidar::density
