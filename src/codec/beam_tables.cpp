// SPDX-License-Identifier: BSD-3-Clause
#include "codec/beam_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/try.hpp"
#include "compact/geometry.hpp"
#include "compact/ray_tables.hpp"
#include "sensor/calibrate.hpp"

namespace curlidar {
namespace {

constexpr double kAngleUnits = 4294967296.0 / (2 * std::numbers::pi);

/// Calibration takes up to a second.
constexpr std::uint32_t kCalibrateFromEffort = 2;

constexpr double kUnitsOfRange = 281474976710656.0;  // 2^48 to a metre

/// Numbers are rounded this much finer than the wanted error: a motion adds to every point, and a
/// beam is one of many.
constexpr double kFinerMotion = 32, kFinerBeams = 16;
/// Distance at which angles are to be as exact as lengths.
constexpr double kUsualRange_m = 20;

std::uint32_t shift_below(double units) {
  return units < 2 ? 0 : static_cast<std::uint32_t>(std::min(std::log2(units), 20.0));
}

std::int32_t rounded(double value, std::uint32_t shift) {
  const std::int64_t unit = std::int64_t{1} << shift;
  return static_cast<std::int32_t>(std::llround(value / static_cast<double>(unit)) * unit);
}

std::int32_t angle_units(double radians, std::uint32_t shift) {
  const double turn = 2 * std::numbers::pi;
  const double within = radians - turn * std::round(radians / turn);
  // Half a turn is as good either way, but only one of them is a number.
  const std::int64_t unit = std::int64_t{1} << shift;
  const std::int64_t value = std::llround(within * kAngleUnits / static_cast<double>(unit)) * unit;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

std::int32_t length_units(double metres, std::uint32_t shift) {
  return rounded(metres * compact::kRangeUnit, shift);
}

compact::Motion::Triple lengths(const Vec3& v, std::uint32_t shift) {
  return {length_units(v.x, shift), length_units(v.y, shift), length_units(v.z, shift)};
}

compact::Motion::Triple rotation(const Vec3& v, std::uint32_t shift) {
  const auto units = [&](double radians) {
    return rounded(std::clamp(radians, -0.9, 0.9) * (1 << 30), shift);
  };
  return {units(v.x), units(v.y), units(v.z)};
}

BeamModel model_of(const compact::BeamTable& table) {
  BeamModel model;
  model.table = table.name;
  model.slots = table.slots;
  model.range_unit_m = static_cast<double>(table.range_unit_q48) / kUnitsOfRange;
  for (std::size_t row = 0; row < table.rays.size(); ++row) {
    const compact::Ray& ray = table.rays[row];
    const auto metres = [](std::int32_t units) {
      return static_cast<double>(units) / compact::kRangeUnit;
    };
    model.beams.push_back({radians_from_angle(table.elevation[row]),
                           radians_from_angle(ray.azimuth_offset), metres(ray.height),
                           metres(ray.lateral), metres(ray.range_phase)});
  }
  return model;
}

/// Rows of an image run from top to bottom.
bool descending(const BeamModel& model) {
  return std::adjacent_find(model.beams.begin(), model.beams.end(),
                            [](const Beam& a, const Beam& b) {
                              return !(a.elevation > b.elevation);
                            }) == model.beams.end();
}

void set_beams(const BeamModel& beams, double error_m, compact::RowTable& table) {
  compact::RayTable& rays = *table.rays;
  rays.slots = beams.slots;
  if (const compact::BeamTable* frozen = compact::beam_table(beams.table)) {
    rays.table = frozen->number;
    rays.rays = frozen->rays;
    table.elevation = frozen->elevation;
    return;
  }
  const double unit_m = error_m / kFinerBeams;
  table.elevation_shift = rays.azimuth_shift = shift_below(unit_m / kUsualRange_m * kAngleUnits);
  rays.height_shift = rays.lateral_shift = rays.phase_shift =
      shift_below(unit_m * compact::kRangeUnit);
  for (const Beam& beam : beams.beams) {
    table.elevation.push_back(angle_units(beam.elevation, table.elevation_shift));
    rays.rays.push_back({angle_units(beam.azimuth_offset, rays.azimuth_shift),
                         length_units(beam.height_m, rays.height_shift),
                         length_units(beam.lateral_m, rays.lateral_shift),
                         length_units(beam.range_phase_m, rays.phase_shift)});
  }
}

void set_motion(const MotionTwist& m, double error_m, compact::RayTable& rays) {
  if (m.none()) return;
  const double unit_m = error_m / kFinerMotion;
  rays.move_shift = shift_below(unit_m * compact::kRangeUnit);
  rays.turn_shift = shift_below(unit_m / kUsualRange_m * (1 << 30));
  const std::uint32_t turn = rays.turn_shift, move = rays.move_shift;
  rays.motion = {rotation(m.turn, turn), lengths(m.move, move),        rotation(m.turn2, turn),
                 lengths(m.move2, move), rotation(m.rigid_turn, turn), lengths(m.rigid_move, move)};
  if (rays.motion.none()) rays.turn_shift = rays.move_shift = 0;
}

}  // namespace

Result<std::optional<LatticeFit>> find_sensor_lattice(const Cloud& cloud, const Detection& rings,
                                                      const EncodeSettings& settings) {
  std::vector<BeamModel> candidates;
  for (const compact::BeamTable& table : compact::beam_tables()) {
    candidates.push_back(model_of(table));
  }
  if (settings.sensor) {
    if (auto model = beam_model_of(*settings.sensor)) candidates.push_back(*std::move(model));
  }
  CURLIDAR_TRY_ASSIGN(known, find_lattice(cloud, rings, candidates));
  if (known || settings.compact.effort < kCalibrateFromEffort) return known;
  const std::array scans{RingedScan{&cloud, &rings}};
  CURLIDAR_TRY_ASSIGN(calibration, calibrate(scans, {true, settings.threads, {}}));
  if (!calibration || !descending(calibration->model)) return known;
  candidates = {calibration->model};
  CURLIDAR_TRY_ASSIGN(own, find_lattice(cloud, rings, candidates));
  if (own) own->notes.push_back("The sensor's rays were calibrated from this scan alone.");
  return own;
}

compact::RowTable ray_rows(const LatticeFit& fit, double error_m) {
  compact::RowTable table;
  table.rays.emplace();
  table.turn_columns = static_cast<std::uint32_t>(fit.firings.size());
  table.rays->firings = fit.firings;
  set_beams(fit.beams, error_m, table);
  set_motion(fit.motion, error_m, *table.rays);
  return table;
}

std::uint64_t range_unit_of(const LatticeFit& fit) {
  if (const compact::BeamTable* frozen = compact::beam_table(fit.beams.table)) {
    return frozen->range_unit_q48;
  }
  return static_cast<std::uint64_t>(std::llround(fit.beams.range_unit_m * kUnitsOfRange));
}

RigidMotion rigid_motion(const compact::Motion& motion, double azimuth) {
  const auto scaled = [](const compact::Motion::Triple& units, double one) {
    return Vec3{units[0] / one, units[1] / one, units[2] / one};
  };
  const auto turn = [&](const compact::Motion::Triple& units) { return scaled(units, 1 << 30); };
  const auto move = [&](const compact::Motion::Triple& units) {
    return scaled(units, compact::kRangeUnit);
  };
  const MotionTwist twist{turn(motion.turn),  move(motion.move),       turn(motion.turn2),
                          move(motion.move2), turn(motion.rigid_turn), move(motion.rigid_move)};
  const double s = azimuth / (2 * std::numbers::pi);
  RigidMotion rigid;
  rigid.move = apply_motion_at(twist, {}, s);
  const Vec3 x = apply_motion_at(twist, {1, 0, 0}, s) - rigid.move;
  const Vec3 y = apply_motion_at(twist, {0, 1, 0}, s) - rigid.move;
  const Vec3 z = apply_motion_at(twist, {0, 0, 1}, s) - rigid.move;
  rigid.rotation = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
  return rigid;
}

}  // namespace curlidar
