// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/simulate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "simulate/random.hpp"

namespace curlidar {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What a beam brought back; range 0 means nothing.
struct Echo {
  Vec3 position{};
  float intensity = 0;
  bool moving = false;
};

enum Stream : std::uint64_t { dropout_stream, radius_stream, angle_stream };

Status check(const SimulateSettings& settings) {
  const auto bad = [](const char* name, double value, const char* wanted) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("simulate: {} is {}; give {}", name, value, wanted)};
  };
  const auto measure = [](double value) { return std::isfinite(value) && value >= 0; };
  if (!measure(settings.range_noise_m)) {
    return bad("range_noise_m", settings.range_noise_m, "metres, 0 or more");
  }
  if (!(settings.dropout >= 0 && settings.dropout <= 1)) {
    return bad("dropout", settings.dropout, "a share between 0 and 1");
  }
  if (!measure(settings.range_unit_m)) {
    return bad("range_unit_m", settings.range_unit_m, "metres, 0 or more");
  }
  if (!(std::isfinite(settings.turns_per_second) && settings.turns_per_second > 0)) {
    return bad("turns_per_second", settings.turns_per_second, "a rate above 0");
  }
  return {};
}

/// Fires beams of a sensor into a scene.
class Shooter {
 public:
  Shooter(const Scene& scene, const SensorProfile& sensor, const SimulateSettings& settings)
      : scene_(scene), sensor_(sensor), settings_(settings) {}

  /// False if there is no return.
  bool fire(std::size_t ring_index, std::uint32_t column, Echo& echo) const {
    const Ring& ring = sensor_.rings[ring_index];
    const double encoder =
        -std::numbers::pi + 2 * std::numbers::pi * column / static_cast<double>(sensor_.columns);
    const double azimuth = encoder + ring.azimuth_offset;
    const Vec3 direction = direction_of(ring.elevation, azimuth);
    Vec3 origin{};
    double lead = 0;  // metres of the measured range that lie before the beam's origin
    if (settings_.beam_origins) {
      lead = sensor_.beam_origin_radius_m;
      origin = Vec3{lead * std::cos(encoder), lead * std::sin(encoder), ring.vertical_offset_m} +
               Vec3{-std::sin(azimuth), std::cos(azimuth), 0} * ring.horizontal_offset_m;
    }
    Hit hit;
    if (!scene_.cast(origin, direction, hit)) return false;
    const double range = measure(hit.range_m + lead, ring_index, column);
    if (!(range >= sensor_.min_range_m && range <= sensor_.max_range_m)) return false;
    if (draw(ring_index, column, dropout_stream) < settings_.dropout) return false;
    echo.position = origin + direction * (range - lead);
    echo.intensity = static_cast<float>(hit.reflectivity * hit.cos_incidence);
    echo.moving = hit.moving;
    return is_return(echo.position);
  }

 private:
  std::uint64_t bits(std::size_t ring, std::uint32_t column, Stream stream) const {
    return scenery::keyed_bits(settings_.seed, ring, column, stream);
  }
  double draw(std::size_t ring, std::uint32_t column, Stream stream) const {
    return scenery::unit_interval(bits(ring, column, stream));
  }
  double measure(double range, std::size_t ring, std::uint32_t column) const {
    if (settings_.range_noise_m > 0) {
      range += settings_.range_noise_m * scenery::gaussian(bits(ring, column, radius_stream),
                                                           bits(ring, column, angle_stream));
    }
    const double unit = settings_.range_unit_m;
    return unit > 0 ? std::round(range / unit) * unit : range;
  }

  const Scene& scene_;
  const SensorProfile& sensor_;
  const SimulateSettings& settings_;
};

struct Return {
  std::uint32_t column;
  Echo echo;
};

/// The coordinates as a driver stores them.
Vec3 to_float(const Vec3& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

Cloud collect(const std::vector<std::vector<Return>>& rings, double seconds_per_column,
              bool mark_moving) {
  Cloud cloud;
  std::vector<float> intensity, time;
  std::vector<std::uint16_t> ring_of;
  std::vector<std::uint8_t> moving;
  std::size_t total = 0;
  for (const auto& ring : rings) total += ring.size();
  cloud.positions.reserve(total);
  intensity.reserve(total);
  time.reserve(total);
  ring_of.reserve(total);
  for (std::size_t r = 0; r < rings.size(); ++r) {
    for (const Return& back : rings[r]) {
      cloud.positions.push_back(to_float(back.echo.position));
      intensity.push_back(back.echo.intensity);
      ring_of.push_back(static_cast<std::uint16_t>(r));
      if (mark_moving) moving.push_back(back.echo.moving ? 1 : 0);
      time.push_back(static_cast<float>(back.column * seconds_per_column));
    }
  }
  cloud.width = static_cast<std::uint32_t>(total);
  cloud.attributes = {{"intensity", 1, std::move(intensity)},
                      {"ring", 1, std::move(ring_of)},
                      {"time", 1, std::move(time)}};
  if (mark_moving) cloud.attributes.push_back({"moving", 1, std::move(moving)});
  return cloud;
}

Status check_truth(const Lattice& lattice, double row_factor, double column_factor,
                   double min_range_m, double max_range_m) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(row_factor) || !positive(column_factor)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("simulate_truth: factors {} x {}; give finite numbers above 0",
                             row_factor, column_factor)};
  }
  if (!(min_range_m >= 0 && min_range_m < max_range_m)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("simulate_truth: range limits {} .. {} m; give 0 <= min < max",
                             min_range_m, max_range_m)};
  }
  const double rows = std::max(1.0, lattice.rows() * row_factor);
  const double columns = std::max(1.0, lattice.columns() * column_factor);
  constexpr double kMaxPoints = 0x1.0p31;
  if (lattice.cells() == 0 || rows * columns > kMaxPoints) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("simulate_truth: a grid of {:.0f} x {:.0f} directions; give one of 1 "
                             "to 2^31",
                             rows, columns)};
  }
  return {};
}

}  // namespace

Result<Cloud> simulate(const Scene& scene, const SensorProfile& sensor,
                       const SimulateSettings& settings) {
  CURLIDAR_TRY(validate(sensor));
  CURLIDAR_TRY(check(settings));
  const Shooter shooter(scene, sensor, settings);
  std::vector<std::vector<Return>> rings(sensor.rings.size());
  parallel_for(rings.size(), settings.threads, [&](std::size_t ring) {
    Echo echo;
    for (std::uint32_t column = 0; column < sensor.columns; ++column) {
      if (shooter.fire(ring, column, echo)) rings[ring].push_back({column, echo});
    }
  });
  Cloud cloud =
      collect(rings, 1 / (settings.turns_per_second * sensor.columns), settings.mark_moving);
  cloud.metadata["source"] =
      fmt::format("simulated, sensor {}, seed {}", sensor.name, settings.seed);
  return cloud;
}

Result<Cloud> simulate_truth(const Scene& scene, const Lattice& lattice, double row_factor,
                             double column_factor, double min_range_m, double max_range_m,
                             std::size_t threads) {
  CURLIDAR_TRY(check_truth(lattice, row_factor, column_factor, min_range_m, max_range_m));
  const DenseGrid grid(lattice, row_factor, column_factor);
  Cloud cloud;
  cloud.position_type = ScalarType::float64;
  cloud.width = static_cast<std::uint32_t>(grid.columns);
  cloud.height = static_cast<std::uint32_t>(grid.rows);
  cloud.positions.assign(grid.rows * grid.columns, {kNaN, kNaN, kNaN});
  std::vector<float> intensity(cloud.positions.size());
  parallel_for(grid.rows, threads, [&](std::size_t i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      const Vec3 direction = lattice.direction(grid.row(i), grid.column(j));
      Hit hit;
      if (!scene.cast({}, direction, hit)) continue;
      if (hit.range_m < min_range_m || hit.range_m > max_range_m) continue;
      const std::size_t slot = i * grid.columns + j;
      cloud.positions[slot] = direction * hit.range_m;
      intensity[slot] = static_cast<float>(hit.reflectivity * hit.cos_incidence);
    }
  });
  cloud.attributes = {{"intensity", 1, std::move(intensity)}};
  cloud.metadata["source"] = "simulated, exact";
  return cloud;
}

}  // namespace curlidar
