// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/lattice_place.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace curlidar {
namespace {

constexpr std::uint32_t kNothing = 0xffffffff;
// A return so near that more positions than this are within reach says nothing about the encoder.
constexpr double kMostSteps = 64;

/// Steps of the encoder that `distance_m` is at a return.
double steps_of(double distance_m, const Sighting& sighting, std::uint32_t slots) {
  const double step_m = 2 * std::numbers::pi / slots * sighting.distance_m;
  return std::min(distance_m / step_m, kMostSteps);
}

std::uint32_t wrap(std::int64_t position, std::uint32_t slots) {
  const auto n = static_cast<std::int64_t>(slots);
  return static_cast<std::uint32_t>(((position % n) + n) % n);
}

/// The occupied position nearest to a return and within `reach` steps of it.
std::uint32_t nearest_occupied(const std::vector<std::uint8_t>& occupied, double encoder,
                               double reach) {
  const auto slots = static_cast<std::uint32_t>(occupied.size());
  const auto first = static_cast<std::int64_t>(std::ceil(encoder - reach));
  const auto last = static_cast<std::int64_t>(std::floor(encoder + reach));
  std::uint32_t best = kNothing;
  double best_distance = reach + 1;
  for (std::int64_t position = first; position <= last; ++position) {
    const double distance = std::abs(static_cast<double>(position) - encoder);
    const std::uint32_t wrapped = wrap(position, slots);
    if (occupied[wrapped] != 0 && distance < best_distance) {
      best = wrapped;
      best_distance = distance;
    }
  }
  return best;
}

/// Positions that returns on their beams' cones need: far returns first, which know theirs; nearer
/// ones, for which several are within the tolerance, join one of those if they can.
std::vector<std::uint8_t> occupied_positions(const std::vector<Sighting>& sightings,
                                             std::uint32_t slots, double tolerance_m) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < sightings.size(); ++i) {
    if (std::abs(sightings[i].up_m) <= tolerance_m) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double da = sightings[a].distance_m, db = sightings[b].distance_m;
    return da != db ? da > db : a < b;
  });
  std::vector<std::uint8_t> occupied(slots, 0);
  for (const std::uint32_t i : order) {
    const double x = sightings[i].encoder;
    const double reach = steps_of(tolerance_m, sightings[i], slots);
    if (reach >= .5 && nearest_occupied(occupied, x, reach) != kNothing) continue;
    const auto nearest = static_cast<std::int64_t>(std::lround(x));
    if (std::abs(static_cast<double>(nearest) - x) <= reach) occupied[wrap(nearest, slots)] = 1;
  }
  return occupied;
}

struct Candidate {
  std::uint32_t sighting = 0, firing = 0;
  double across_m = 0, residual_m = 0;

  /// Residuals that differ by less are equally good: of two returns along one ray, the first in the
  /// file is to have the place.
  int grade() const { return static_cast<int>(residual_m / .00025); }
};

/// Whether the place is on the same side of the seam as the azimuth for which the motion of a
/// return was undone; else the motion would take the place's point elsewhere.
bool same_side(const Sighting& sighting, const BeamModel& model, std::uint32_t position) {
  constexpr double kClear = .499;  // of a turn
  if (std::abs(sighting.s) < kClear) return true;
  const double azimuth =
      azimuth_of(lattice_point(model, sighting.ring, position, sighting.range_m));
  return (azimuth < 0) == (sighting.s < 0);
}

/// Every firing that a return may belong to.
std::vector<Candidate> find_candidates(const std::vector<Sighting>& sightings,
                                       const BeamModel& model,
                                       const std::vector<std::uint32_t>& firing_at,
                                       double reach_m) {
  const auto slots = static_cast<std::uint32_t>(firing_at.size());
  std::vector<Candidate> out;
  out.reserve(sightings.size());
  for (std::uint32_t i = 0; i < sightings.size(); ++i) {
    const Sighting& sighting = sightings[i];
    if (std::abs(sighting.up_m) > reach_m) continue;
    const double reach = steps_of(reach_m, sighting, slots), x = sighting.encoder;
    const double metres = reach_m / std::max(reach, 1e-12);
    const auto last = static_cast<std::int64_t>(std::floor(x + reach));
    for (auto p = static_cast<std::int64_t>(std::ceil(x - reach)); p <= last; ++p) {
      const std::uint32_t firing = firing_at[wrap(p, slots)];
      if (firing == kNothing || !same_side(sighting, model, wrap(p, slots))) continue;
      const double across = (x - static_cast<double>(p)) * metres;
      const double residual = std::hypot(across, sighting.up_m);
      if (residual <= reach_m) out.push_back({i, firing, across, residual});
    }
  }
  std::sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    if (a.grade() != b.grade()) return a.grade() < b.grade();
    if (a.sighting != b.sighting) return a.sighting < b.sighting;
    return a.residual_m != b.residual_m ? a.residual_m < b.residual_m : a.firing < b.firing;
  });
  return out;
}

/// Leaves out firings without a return.
void drop_unused(Placement& placement) {
  std::vector<std::uint32_t> renamed(placement.firings.size(), kNothing);
  for (const auto& place : placement.places) renamed[place.firing] = 0;
  std::vector<std::uint32_t> kept;
  for (std::size_t f = 0; f < renamed.size(); ++f) {
    if (renamed[f] == kNothing) continue;
    renamed[f] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(placement.firings[f]);
  }
  for (auto& place : placement.places) place.firing = renamed[place.firing];
  placement.firings = std::move(kept);
}

}  // namespace

Placement place_returns(const std::vector<Sighting>& sightings, const BeamModel& model,
                        double tolerance_m, double reach_m) {
  Placement placement;
  const auto occupied = occupied_positions(sightings, model.slots, tolerance_m);
  std::vector<std::uint32_t> firing_at(model.slots, kNothing);
  for (std::uint32_t position = 0; position < model.slots; ++position) {
    if (occupied[position] == 0) continue;
    firing_at[position] = static_cast<std::uint32_t>(placement.firings.size());
    placement.firings.push_back(position);
  }
  std::uint32_t last_slot = 0;
  for (const Sighting& sighting : sightings) last_slot = std::max(last_slot, sighting.slot);
  std::vector<std::uint8_t> placed(std::size_t{last_slot} + 1, 0);
  std::vector<std::uint8_t> taken(placement.firings.size() * model.beams.size(), 0);
  const std::vector<Candidate> candidates = find_candidates(sightings, model, firing_at, reach_m);
  for (const Candidate& candidate : candidates) {
    const Sighting& sighting = sightings[candidate.sighting];
    auto& cell = taken[sighting.ring * placement.firings.size() + candidate.firing];
    if (placed[sighting.slot] != 0 || cell != 0) continue;
    placed[sighting.slot] = cell = 1;
    placement.places.push_back({candidate.sighting, candidate.firing, candidate.across_m});
  }
  for (const Candidate& candidate : candidates) {
    auto& known = placed[sightings[candidate.sighting].slot];
    if (known != 0 || candidate.residual_m > tolerance_m) continue;
    known = 1;
    ++placement.sharing;
  }
  drop_unused(placement);
  return placement;
}

}  // namespace curlidar
