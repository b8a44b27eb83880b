// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "curlidar/sensor.hpp"
#include "sensor/angles.hpp"
#include "sensor/beams.hpp"
#include "sensor/cluster.hpp"
#include "sensor/columns.hpp"
#include "sensor/match.hpp"
#include "sensor/ring_labels.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// What a detection works on and hands from step to step.
struct Scan {
  const Cloud& cloud;
  Returns returns;
  Detection found;
  std::vector<std::uint16_t> ring_of_return;
  double stated_columns = 0;  ///< firings in a turn that the layout states, 0: none
};

std::string plural(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void count_slots(Scan& scan) {
  Detection& d = scan.found;
  d.points = scan.cloud.size();
  d.returns = scan.returns.size();
  for (const Vec3& p : scan.cloud.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) ++d.not_finite;
  }
  d.zero = d.points - d.returns - d.not_finite;
  if (d.zero > 0) d.notes.push_back(plural(d.zero, "(0,0,0) slot") + " skipped.");
  if (d.not_finite > 0)
    d.notes.push_back(plural(d.not_finite, "slot") + " without a finite point skipped.");
}

void measure(Scan& scan) {
  Detection& d = scan.found;
  const Returns& returns = scan.returns;
  std::bitset<360> sectors;
  for (const double azimuth : returns.azimuth) {
    const auto sector = static_cast<std::size_t>((azimuth / kTurn + 0.5) * 360);
    sectors.set(std::min<std::size_t>(359, sector));
  }
  d.azimuth_coverage = static_cast<double>(sectors.count()) / 360;
  std::vector<double> ranges(returns.range);
  d.range_p50_m = percentile(ranges, 0.5);
  d.range_p90_m = percentile(ranges, 0.9);
  const auto [near, far] = std::minmax_element(ranges.begin(), ranges.end());
  d.range_min_m = *near;
  d.range_max_m = *far;
  const auto [low, high] = std::minmax_element(returns.elevation.begin(), returns.elevation.end());
  d.elevation_min = *low;
  d.elevation_max = *high;
}

Result<Scan> start(const Cloud& cloud) {
  Scan scan{cloud, gather_returns(cloud), {}, {}, 0};
  if (scan.returns.size() == 0) {
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("the cloud has no return: all of its {} slots are empty, not finite or "
                    "(0,0,0)",
                    cloud.size())};
  }
  count_slots(scan);
  measure(scan);
  return scan;
}

/// Elevations of the rings as this scan shows them; rings without a return stay nominal.
void measure_rings(Scan& scan) {
  Detection& d = scan.found;
  const Labels labels{scan.ring_of_return, d.sensor.rings.size()};
  const std::vector<Cone> cones = fit_cones(scan.returns, labels);
  d.ring_elevations.clear();
  for (std::size_t ring = 0; ring < cones.size(); ++ring) {
    d.ring_elevations.push_back(cones[ring].returns > 0
                                    ? cones[ring].elevation
                                    : d.sensor.apparent_elevation(ring, d.range_p50_m));
  }
  make_strictly_descending(d.ring_elevations);
}

Detection finish(Scan scan) {
  Detection& d = scan.found;
  d.ring_of_point.assign(scan.cloud.size(), kNoRing);
  for (std::size_t i = 0; i < scan.returns.size(); ++i) {
    d.ring_of_point[scan.returns.slot[i]] = scan.ring_of_return[i];
  }
  const double cells = static_cast<double>(d.sensor.rings.size()) * d.sensor.columns;
  d.occupancy = std::min(1.0, static_cast<double>(d.returns) / cells);
  return std::move(scan.found);
}

/// Limits that hold every return of the scan.
void widen_range(Detection& d) {
  SensorProfile& sensor = d.sensor;
  if (d.range_max_m > sensor.max_range_m) sensor.max_range_m = std::ceil(d.range_max_m);
  if (d.range_min_m < sensor.min_range_m) {
    sensor.min_range_m = std::floor(d.range_min_m * 10) / 10;
  }
}

/// The columns of a sensor of unknown make, or a known one that turns at another speed.
void set_columns(Scan& scan, double measured, bool known_sensor) {
  SensorProfile& sensor = scan.found.sensor;
  const bool whole_turn = scan.found.azimuth_coverage > 0.9;
  const double columns = scan.stated_columns >= 4 && scan.stated_columns <= 65536 && whole_turn
                             ? scan.stated_columns
                             : usual_columns(measured);
  if (measured <= 0 && columns != scan.stated_columns) return;
  if (known_sensor && std::abs(columns / sensor.columns - 1) < 0.05) return;
  if (known_sensor) {
    scan.found.notes.push_back(
        fmt::format("The scan has {} columns in a turn, not the {} that are "
                    "usual for {}.",
                    columns, sensor.columns, sensor.name));
  }
  sensor.columns = static_cast<std::uint32_t>(columns);
}

void note_match(Detection& d, const SensorMatch& match) {
  for (const std::string& other : match.also_fits) {
    d.notes.push_back(fmt::format("The rings fit {} as well as {}; the azimuth step decided.",
                                  other, d.sensor.name));
  }
}

void note_coverage(Detection& d) {
  if (d.azimuth_coverage >= 0.9) return;
  d.notes.push_back(
      fmt::format("Returns cover {:.0f} of 360 degrees of azimuth.", d.azimuth_coverage * 360));
}

/// A profile named "auto" with these rings (descending).
SensorProfile auto_profile(const std::vector<double>& elevations, const char* description) {
  SensorProfile sensor;
  sensor.name = "auto";
  sensor.description = description;
  for (const double elevation : elevations) sensor.rings.push_back({elevation, 0, 0, 0});
  sensor.fov_up = elevations.front();
  sensor.fov_down = elevations.back();
  return sensor;
}

/// Labels that turned out to be rings become the scan's rings.
void accept_labels(Scan& scan, const Labels& labels, const std::vector<Cone>& cones,
                   RingSource source) {
  Detection& d = scan.found;
  const double measured = columns_from_steps(scan.returns, labels);
  const std::vector<Cone> ordered = top_to_bottom(cones);
  const auto match =
      match_cones(ordered, scan.returns, scan.stated_columns > 0 ? scan.stated_columns : measured);
  d.source = source;
  std::vector<std::uint16_t> ring_of_label(labels.count, kNoRing);
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    ring_of_label[ordered[i].label] =
        match ? match->ring_of_cone[i] : static_cast<std::uint16_t>(i);
  }
  d.sensor = match ? match->profile
                   : auto_profile(elevations_of(ordered), "Rings found in the scan itself");
  if (match) note_match(d, *match);
  scan.ring_of_return.clear();
  for (const std::uint16_t label : labels.of_return) {
    scan.ring_of_return.push_back(ring_of_label[label]);
  }
  set_columns(scan, measured, match.has_value());
}

bool try_attribute(Scan& scan) {
  const Attribute* attribute = find_ring_attribute(scan.cloud);
  if (attribute == nullptr) return false;
  if (const auto labels = labels_from_attribute(scan.cloud, *attribute, scan.returns)) {
    const std::vector<Cone> cones = fit_cones(scan.returns, *labels);
    // One value for everything is a field that nobody filled in, unless the scan is planar.
    const bool constant = std::count_if(cones.begin(), cones.end(),
                                        [](const Cone& cone) { return cone.returns > 0; }) < 2;
    if (!constant && are_rings(cones)) {
      const auto rings = static_cast<std::uint32_t>(labels->count);
      if (scan.cloud.organised()) {
        scan.stated_columns = scan.cloud.height == rings  ? scan.cloud.width
                              : scan.cloud.width == rings ? scan.cloud.height
                                                          : 0;
      }
      accept_labels(scan, *labels, cones, RingSource::ring_attribute);
      return true;
    }
  }
  scan.found.notes.push_back(fmt::format("The attribute \"{}\" does not number rings; ignored.",
                                         attribute->name.substr(0, 64)));
  return false;
}

bool try_rows(Scan& scan) {
  for (const bool transposed : {false, true}) {
    const auto labels = labels_from_rows(scan.cloud, scan.returns, transposed);
    if (!labels) continue;
    const std::vector<Cone> cones = fit_cones(scan.returns, *labels);
    if (!are_rings(cones)) continue;
    scan.stated_columns = transposed ? scan.cloud.height : scan.cloud.width;
    accept_labels(scan, *labels, cones, RingSource::organised_rows);
    return true;
  }
  return false;
}

bool try_turns(Scan& scan) {
  std::optional<Labels> best;
  std::vector<Cone> best_cones;
  double best_tail = 0;
  const EmptyArc empty = widest_empty_arc(scan.returns);
  for (const double start : guess_turn_starts(scan.returns, empty)) {
    auto labels = labels_from_turns(scan.returns, start, empty);
    if (!labels) continue;
    std::vector<Cone> cones = fit_cones(scan.returns, *labels);
    if (!are_rings(cones)) continue;
    // A start in the middle of the returns joins parts of two rings, which shows in the tail.
    std::vector<double> tails;
    for (const Cone& cone : cones) tails.push_back(cone.tail);
    const double tail = median(tails);
    if (best && tail >= best_tail) continue;
    best = std::move(labels);
    best_cones = std::move(cones);
    best_tail = tail;
    // As thin as beams are: no other start can be better.
    if (tail < 0.04 * kRadiansPerDegree) break;
  }
  if (!best) return false;
  accept_labels(scan, *best, best_cones, RingSource::azimuth_wraps);
  return true;
}

void assign_nearest(Scan& scan) {
  const Beams beams(scan.found.sensor);
  scan.ring_of_return.resize(scan.returns.size());
  for (std::size_t i = 0; i < scan.returns.size(); ++i) {
    scan.ring_of_return[i] = beams.nearest(scan.returns.distance[i], scan.returns.height[i]);
  }
}

bool try_known_beams(Scan& scan) {
  // Which of two sensors with the same rings it is needs the columns, those need the rings.
  auto match = match_returns(scan.returns, 0);
  if (!match) return false;
  Detection& d = scan.found;
  d.source = RingSource::clustered;
  d.sensor = match->profile;
  assign_nearest(scan);
  const double measured =
      columns_from_steps(scan.returns, {scan.ring_of_return, d.sensor.rings.size()});
  if (!match->also_fits.empty()) {
    match = match_returns(scan.returns, measured);
    d.sensor = match->profile;
    assign_nearest(scan);
    note_match(d, *match);
  }
  set_columns(scan, measured, true);
  return true;
}

bool try_clusters(Scan& scan) {
  const std::vector<double> centres = cluster_elevations(scan.returns);
  if (centres.empty()) return false;
  scan.found.source = RingSource::clustered;
  scan.found.sensor = auto_profile(centres, "Rings found as clusters of elevation");
  assign_nearest(scan);
  set_columns(scan, columns_from_steps(scan.returns, {scan.ring_of_return, centres.size()}), false);
  return true;
}

/// The power of two nearest to `value`, within limits.
double power_of_two(double value, double low, double high) {
  return std::clamp(std::exp2(std::round(std::log2(value))), low, high);
}

/// Rows and columns of about square cells, one for each return of an evenly filled field of view.
void use_uniform_rows(Scan& scan) {
  Detection& d = scan.found;
  const double fov = d.elevation_max - d.elevation_min;
  const double field = fov * d.azimuth_coverage * kTurn;
  const double step = std::sqrt(field / static_cast<double>(d.returns));
  const auto rows = static_cast<std::size_t>(power_of_two(fov / step, 4, 512));
  std::vector<double> elevations;
  for (std::size_t i = 0; i < rows; ++i) {
    elevations.push_back(d.elevation_max -
                         fov * static_cast<double>(i) / static_cast<double>(rows - 1));
  }
  elevations.back() = d.elevation_min;
  d.source = RingSource::uniform;
  d.sensor = auto_profile(elevations, "Uniform rows over the observed field of view");
  d.sensor.columns = static_cast<std::uint32_t>(power_of_two(kTurn / step, 16, 4096));
  assign_nearest(scan);
  if (d.azimuth_coverage < 0.6) {
    d.sensor.pattern = ScanPattern::limited_field;
    d.notes.push_back(
        fmt::format("No rings, and returns cover {:.0f} of 360 degrees of azimuth: a "
                    "limited-field scanner, which the paper's profiles cannot code.",
                    d.azimuth_coverage * 360));
    return;
  }
  d.notes.push_back(
      fmt::format("No rings found; {} uniform rows cover the observed field of view.", rows));
  note_coverage(d);
}

}  // namespace

const char* to_string(RingSource source) {
  switch (source) {
    case RingSource::ring_attribute:
      return "ring attribute";
    case RingSource::organised_rows:
      return "organised rows";
    case RingSource::azimuth_wraps:
      return "file order, ring by ring";
    case RingSource::clustered:
      return "clusters of elevation";
    case RingSource::profile:
      return "given profile";
    case RingSource::uniform:
      return "uniform rows";
  }
  return "unknown";
}

Result<Detection> detect_sensor(const Cloud& cloud) {
  CURLIDAR_TRY_ASSIGN(scan, start(cloud));
  const bool rings = try_attribute(scan) || try_rows(scan) || try_turns(scan) ||
                     try_known_beams(scan) || try_clusters(scan);
  if (rings) {
    note_coverage(scan.found);
  } else {
    use_uniform_rows(scan);
  }
  widen_range(scan.found);
  measure_rings(scan);
  CURLIDAR_TRY(validate(scan.found.sensor));
  return finish(std::move(scan));
}

Result<Detection> assign_rings(const Cloud& cloud, const SensorProfile& profile) {
  CURLIDAR_TRY(validate(profile));
  CURLIDAR_TRY_ASSIGN(scan, start(cloud));
  Detection& d = scan.found;
  d.source = RingSource::profile;
  d.sensor = profile;
  assign_nearest(scan);
  const Beams beams(profile);
  std::size_t far_off = 0;
  for (std::size_t i = 0; i < scan.returns.size(); ++i) {
    const std::uint16_t ring = scan.ring_of_return[i];
    const double angle = beams.angle_above(ring, scan.returns.distance[i], scan.returns.height[i]);
    if (std::abs(angle) > 4 * beams.half_gap(ring)) ++far_off;
  }
  if (far_off > 0) {
    d.notes.push_back(plural(far_off, "return") +
                      " more than two ring steps away from the nearest ring of " + profile.name +
                      ".");
  }
  measure_rings(scan);
  return finish(std::move(scan));
}

}  // namespace curlidar
