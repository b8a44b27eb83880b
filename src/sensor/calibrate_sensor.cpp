// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "curlidar/calibrate.hpp"
#include "sensor/calibrate.hpp"

namespace curlidar {
namespace {

/// The rings of a cloud: as the cloud itself tells them if their number is right.
Result<Detection> rings_of(const Cloud& cloud, const std::optional<SensorProfile>& start) {
  CURLIDAR_TRY_ASSIGN(found, detect_sensor(cloud));
  if (!start) return found;
  if (found.sensor.rings.size() != start->rings.size() || found.source == RingSource::uniform) {
    return assign_rings(cloud, *start);
  }
  found.sensor = *start;
  return found;
}

Error no_lattice(const char* why) {
  return {
      ErrorCode::unsupported,
      fmt::format("no lattice of a sensor's own rays found: {}. encode uses uniform columns for "
                  "such scans and needs no calibration",
                  why)};
}

bool descends(const BeamModel& model) {
  for (std::size_t i = 1; i < model.beams.size(); ++i) {
    if (!(model.beams[i].elevation < model.beams[i - 1].elevation)) return false;
  }
  return true;
}

/// Where each ring belongs: from top to bottom by the elevations of the beams, and rings that are
/// parts of one together (a turn that was cut where it does not end).
std::vector<std::uint16_t> places_of(const BeamModel& model) {
  constexpr double kSame = 3e-5, kSame_m = 5e-4;
  std::vector<std::uint16_t> order(model.beams.size()), places(model.beams.size());
  std::iota(order.begin(), order.end(), std::uint16_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::uint16_t a, std::uint16_t b) {
    return model.beams[a].elevation > model.beams[b].elevation;
  });
  std::uint16_t place = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Beam &above = model.beams[order[i - 1]], &beam = model.beams[order[i]];
    const bool same = above.elevation - beam.elevation < kSame &&
                      std::abs(above.height_m - beam.height_m) < kSame_m;
    places[order[i]] = same ? place : ++place;
  }
  return places;
}

/// The same rings at other places.
void relabel(Detection& found, const std::vector<std::uint16_t>& places) {
  const auto last = *std::max_element(places.begin(), places.end());
  std::vector<Ring> rings(last + std::size_t{1});
  std::vector<double> elevations(rings.size());
  for (std::size_t i = places.size(); i-- > 0;) {
    rings[places[i]] = found.sensor.rings[i];
    elevations[places[i]] = found.ring_elevations[i];
  }
  found.sensor.rings = std::move(rings);
  found.ring_elevations = std::move(elevations);
  for (std::uint16_t& ring : found.ring_of_point) {
    if (ring != kNoRing) ring = places[ring];
  }
}

ScanOnLattice describe(const LatticeFit& fit) {
  ScanOnLattice out;
  out.returns = fit.returns;
  out.placed = fit.placed;
  out.firings = fit.firings.size();
  out.share = fit.share;
  const LatticeResiduals& r = fit.residuals;
  out.across_median_m = r.across_median_m;
  out.across_p95_m = r.across_p95_m;
  out.up_median_m = r.up_median_m;
  out.up_p95_m = r.up_p95_m;
  out.range_median_m = r.range_median_m;
  out.range_p95_m = r.range_p95_m;
  out.compensated = !fit.motion.none();
  out.turn = fit.motion.turn;
  out.move = fit.motion.move;
  out.notes = fit.notes;
  return out;
}

}  // namespace

Result<SensorCalibration> calibrate_sensor(std::span<const Cloud> clouds,
                                           const SensorCalibrationSettings& settings) {
  const auto report = [&](std::string_view stage, double fraction) {
    if (settings.progress) settings.progress(stage, fraction);
  };
  std::vector<Detection> rings;
  std::vector<RingedScan> scans;
  report("rings", 0);
  for (const Cloud& cloud : clouds) {
    CURLIDAR_TRY_ASSIGN(found, rings_of(cloud, settings.start));
    rings.push_back(std::move(found));
  }
  for (std::size_t i = 0; i < clouds.size(); ++i) scans.push_back({&clouds[i], &rings[i]});
  CalibrateSettings inner;
  inner.motion = settings.motion;
  inner.threads = settings.threads;
  inner.progress = [&](std::string_view stage, double fraction) { report(stage, 0.7 * fraction); };
  CURLIDAR_TRY_ASSIGN(calibration, calibrate(scans, inner));
  if (calibration && !descends(calibration->model)) {
    const std::vector<std::uint16_t> places = places_of(calibration->model);
    for (Detection& found : rings) relabel(found, places);
    CURLIDAR_TRY_ASSIGN(again, calibrate(scans, inner));
    calibration = std::move(again);
  }
  if (!calibration) {
    return no_lattice(rings.front().source == RingSource::uniform
                          ? "the scan has no rings"
                          : "the returns of its rings are not at the positions of any encoder, or "
                            "not on cones");
  }
  SensorCalibration out;
  out.ring_source = rings.front().source;
  CURLIDAR_TRY_ASSIGN(sensor, profile_of(calibration->model, rings.front().sensor, settings.name));
  sensor.description =
      fmt::format("{}, calibrated from {} scan{}", rings.front().sensor.description, clouds.size(),
                  clouds.size() == 1 ? "" : "s");
  out.sensor = std::move(sensor);
  report("lattice", 0.7);
  LatticeSettings lattice;
  lattice.motion = settings.motion;
  out.scans.resize(clouds.size());
  parallel_for(clouds.size(), settings.threads, [&](std::size_t i) {
    // Its only error, rings of another cloud, cannot be.
    const auto fit = find_lattice(clouds[i], rings[i], std::span(&calibration->model, 1), lattice);
    if (fit && *fit) out.scans[i] = describe(**fit);
    out.scans[i].returns = rings[i].returns;
  });
  for (const Detection& found : rings) {
    out.sensor.min_range_m = std::min(out.sensor.min_range_m, found.sensor.min_range_m);
    out.sensor.max_range_m = std::max(out.sensor.max_range_m, found.sensor.max_range_m);
  }
  const auto on_lattice = [](const ScanOnLattice& scan) { return scan.placed > 0; };
  if (std::none_of(out.scans.begin(), out.scans.end(), on_lattice)) {
    return no_lattice("too few of the returns lie on the one that fits best");
  }
  report("done", 1);
  return out;
}

}  // namespace curlidar
