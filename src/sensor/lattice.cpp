// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sensor/lattice_place.hpp"
#include "sensor/motion_search.hpp"
#include "sensor/returns.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::size_t kSampleReturns = 20000;
/// Nearer to the axis than this, returns say little about their beams.
constexpr double kNear_m = 1;
/// A share that needs no better explanation.
constexpr double kSurelyRight = .97;
/// Of elevations, rms, radians: those seen from the sensor's origin, of beams that start beside it,
/// are a degree off.
constexpr double kAlike = .06;
/// Searches for the motion with rings set right in between: labels by elevation need one or two.
constexpr int kMostRounds = 4;

std::vector<std::uint32_t> slots_with_returns(const Cloud& cloud) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) slots.push_back(i);
  }
  return slots;
}

/// About kSampleReturns returns spread over the file as a hash has it: no stride of the file's
/// order (rings, columns) shows in them.
LatticeSample draw_sample(const Cloud& cloud, const Detection& rings,
                          const std::vector<std::uint32_t>& returns) {
  LatticeSample sample;
  const std::uint64_t keep =
      returns.size() <= kSampleReturns ? 1ull << 32 : (kSampleReturns << 32) / returns.size();
  for (const std::uint32_t slot : returns) {
    const std::uint64_t hash = (slot * 0x9e3779b97f4a7c15ull) >> 32;
    const Vec3& p = cloud.positions[slot];
    if (hash >= keep || rings.ring_of_point[slot] == kNoRing) continue;
    if (std::hypot(p.x, p.y) < kNear_m || norm(p) > 1e4) continue;
    sample.points.push_back(p);
    sample.rings.push_back(rings.ring_of_point[slot]);
  }
  return sample;
}

/// Root mean square difference of the elevations; infinite for another number of rings.
double elevation_difference(const BeamModel& model, const Detection& rings) {
  const std::size_t n = rings.sensor.rings.size();
  if (model.beams.size() != n || model.slots == 0 || model.slots > kMaxSlots || n == 0) {
    return std::numeric_limits<double>::infinity();
  }
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double difference = model.beams[k].elevation - rings.sensor.rings[k].elevation;
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(n));
}

/// One candidate, and the motion under which the sample fits it best.
struct Attempt {
  const BeamModel* model = nullptr;
  MotionTwist motion;
  SampleQuality quality;
};

Attempt attempt(const BeamModel& model, const LatticeSample& drawn,
                const LatticeSettings& settings) {
  LatticeSample sample = drawn;
  Attempt out{&model, {}, measure(sample, model, {}, settings.tolerance_m)};
  const auto done = [&] { return out.quality.share > kSurelyRight; };
  // More numbers always fit a little better; they must do so clearly.
  const auto consider = [&](const MotionTwist& motion) {
    const SampleQuality quality = measure(sample, model, motion, settings.tolerance_m);
    if (quality.share > out.quality.share + .01) out = {&model, motion, quality};
    return quality.up_median_m;
  };
  // Wrong rings spoil the search for the motion, and an unknown motion spoils the rings.
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds && !done() && settings.motion; ++round) {
    const MotionTwist motion = search_motion(sample, model);
    consider(motion);
    if (done() || relabel(sample, model, motion) == 0) break;
    const double after = consider(motion);
    if (after > .8 * before) break;
    before = after;
  }
  if (!done() && settings.motion) {
    sample = drawn;
    consider(search_motion(sample, model, MotionFreedom::quadratic));
  }
  if (!done()) {
    relabel(sample, model, out.motion);
    consider(out.motion);
  }
  return out;
}

class Sightings {
 public:
  Sightings(const Attempt& found, double reach_m) : found_(found), reach_m_(reach_m) {}

  /// The return as its ring sees it; or, where it is not on that ring's cone, as every beam that
  /// may have seen it does. Beside the seam of a compensated scan a return may come from either
  /// end.
  void add(std::uint32_t slot, const Vec3& moved, std::uint16_t ring) {
    if (found_.motion.none()) return add_unmoved(slot, {moved, 0}, ring);
    for (const double turns : {0.0, 1.0, -1.0}) {
      const Unmoved unmoved = undo_motion(found_.motion, moved, turns);
      if (std::abs(unmoved.s) < .5 + kSlack) add_unmoved(slot, unmoved, ring);
      if (turns == 0 && std::abs(unmoved.s) < .5 - kSeam) return;
    }
  }
  const std::vector<Sighting>& list() const { return list_; }

 private:
  static constexpr double kSeam = .1;     ///< of a turn: more than any motion shifts the seam
  static constexpr double kSlack = 2e-4;  ///< of a turn: what rounding may do to an azimuth

  void add_unmoved(std::uint32_t slot, const Unmoved& p, std::uint16_t ring) {
    if (ring < found_.model->beams.size() && add_if_near(slot, p, ring)) return;
    for (std::size_t k = 0; k < found_.model->beams.size(); ++k) {
      if (k != ring) add_if_near(slot, p, static_cast<std::uint16_t>(k));
    }
  }
  bool add_if_near(std::uint32_t slot, const Unmoved& p, std::uint16_t ring) {
    const auto view = view_along(found_.model->beams[ring], p.point);
    if (!view || !(view->range > 0) || !(std::abs(view->up_m) <= reach_m_)) return false;
    const double encoder = (view->encoder + std::numbers::pi) / kTurn * found_.model->slots;
    list_.push_back({slot, ring, encoder, view->up_m, view->distance_m, view->range, p.s});
    return true;
  }

  const Attempt& found_;
  double reach_m_;
  std::vector<Sighting> list_;
};

void measure_residuals(LatticeFit& fit, const Placement& placement,
                       const std::vector<Sighting>& sightings, double tolerance_m) {
  std::vector<double> across, up, range;
  std::size_t good = 0;
  for (const auto& place : placement.places) {
    const Sighting& sighting = sightings[place.sighting];
    across.push_back(std::abs(place.across_m));
    up.push_back(std::abs(sighting.up_m));
    if (std::hypot(across.back(), up.back()) <= tolerance_m) ++good;
    if (fit.beams.range_unit_m > 0) {
      range.push_back(std::abs(std::remainder(sighting.range_m, fit.beams.range_unit_m)));
    }
  }
  fit.placed = placement.places.size();
  fit.sharing = placement.sharing;
  fit.share = static_cast<double>(good + fit.sharing) / static_cast<double>(fit.returns);
  if (across.empty()) return;
  fit.residuals = {percentile(across, .5), percentile(across, .95), percentile(up, .5),
                   percentile(up, .95)};
  if (range.empty()) return;
  fit.residuals.range_median_m = percentile(range, .5);
  fit.residuals.range_p95_m = percentile(range, .95);
}

void add_notes(LatticeFit& fit) {
  const auto& r = fit.residuals;
  fit.notes.push_back(fmt::format(
      "{:.2f} % of the returns lie on the sensor's own lattice ({} firings among {} "
      "encoder positions), {:.2f} mm across and {:.2f} mm above their rays (median).",
      100.0 * static_cast<double>(fit.placed) / static_cast<double>(fit.returns),
      fit.firings.size(), fit.beams.slots, r.across_median_m * 1e3, r.up_median_m * 1e3));
  if (fit.sharing > 0) {
    fit.notes.push_back(
        fmt::format("{} returns lie along a ray that another return has already (second returns, "
                    "or the turn is "
                    "a little more than full); they are kept as single points.",
                    fit.sharing));
  }
  if (fit.motion.none()) return;
  fit.notes.push_back(
      fmt::format("The scan is motion-compensated: {:.2f} m and {:.2f} degrees a "
                  "turn, which is undone.",
                  norm(fit.motion.move), norm(fit.motion.turn) * 180 / std::numbers::pi));
}

LatticeFit place_all(const Cloud& cloud, const Detection& rings,
                     const std::vector<std::uint32_t>& returns, const Attempt& found,
                     const LatticeSettings& settings) {
  LatticeFit fit;
  fit.beams = *found.model;
  fit.motion = found.motion;
  fit.returns = returns.size();
  Sightings sightings(found, settings.reach_m);
  for (const std::uint32_t slot : returns) {
    sightings.add(slot, cloud.positions[slot], rings.ring_of_point[slot]);
  }
  const Placement placement =
      place_returns(sightings.list(), fit.beams, settings.tolerance_m, settings.reach_m);
  fit.firings = placement.firings;
  fit.ring_of_point = rings.ring_of_point;
  fit.firing_of_point.assign(cloud.size(), kNoFiring);
  fit.range_of_point.assign(cloud.size(), 0);
  for (const auto& place : placement.places) {
    const Sighting& sighting = sightings.list()[place.sighting];
    fit.ring_of_point[sighting.slot] = sighting.ring;
    fit.firing_of_point[sighting.slot] = place.firing;
    fit.range_of_point[sighting.slot] = sighting.range_m;
  }
  measure_residuals(fit, placement, sightings.list(), settings.tolerance_m);
  add_notes(fit);
  return fit;
}

}  // namespace

Result<std::optional<LatticeFit>> find_lattice(const Cloud& cloud, const Detection& rings,
                                               std::span<const BeamModel> candidates,
                                               const LatticeSettings& settings) {
  if (rings.ring_of_point.size() != cloud.size()) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("rings of {} points were given for a cloud of {}",
                             rings.ring_of_point.size(), cloud.size())};
  }
  const std::vector<std::uint32_t> returns = slots_with_returns(cloud);
  const LatticeSample sample = draw_sample(cloud, rings, returns);
  if (sample.points.empty()) return std::optional<LatticeFit>();
  std::vector<const BeamModel*> fitting;
  for (const BeamModel& model : candidates) {
    if (elevation_difference(model, rings) < kAlike) fitting.push_back(&model);
  }
  std::stable_sort(fitting.begin(), fitting.end(), [&](const BeamModel* a, const BeamModel* b) {
    return elevation_difference(*a, rings) < elevation_difference(*b, rings);
  });
  Attempt best;
  for (const BeamModel* model : fitting) {
    const Attempt next = attempt(*model, sample, settings);
    if (best.model == nullptr || next.quality.share > best.quality.share) best = next;
    if (best.quality.share > kSurelyRight) break;
  }
  if (best.model == nullptr || best.quality.share < settings.min_share) {
    return std::optional<LatticeFit>();
  }
  LatticeFit fit = place_all(cloud, rings, returns, best, settings);
  const double cells = static_cast<double>(fit.firings.size() * fit.beams.beams.size());
  if (fit.share < settings.min_share ||
      static_cast<double>(fit.placed) < settings.min_occupancy * cells) {
    return std::optional<LatticeFit>();
  }
  return std::optional<LatticeFit>(std::move(fit));
}

}  // namespace curlidar
