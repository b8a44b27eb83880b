// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/match.hpp"

#include <algorithm>
#include <cmath>

#include "sensor/angles.hpp"
#include "sensor/beams.hpp"

namespace curlidar {
namespace {

constexpr double kSameRings = 0.02 * kRadiansPerDegree;

/// Parsed once; immutable afterwards.
const std::vector<SensorProfile>& builtin_profiles() {
  static const std::vector<SensorProfile> profiles = [] {
    std::vector<SensorProfile> out;
    for (const std::string& name : builtin_sensor_names()) {
      if (auto profile = builtin_sensor(name)) out.push_back(std::move(*profile));
    }
    return out;
  }();
  return profiles;
}

double median_angle_above(const Beams& beams, std::size_t ring, const Cone& cone,
                          const Returns& returns) {
  std::vector<double> angles;
  angles.reserve(cone.sample.size());
  for (const std::uint32_t i : cone.sample) {
    angles.push_back(beams.angle_above(ring, returns.distance[i], returns.height[i]));
  }
  return median(angles);
}

/// The return that stands for the cone.
std::uint32_t middle_return(const Cone& cone, const Returns& returns) {
  return *std::min_element(cone.sample.begin(), cone.sample.end(),
                           [&](std::uint32_t a, std::uint32_t b) {
                             return std::abs(returns.elevation[a] - cone.elevation) <
                                    std::abs(returns.elevation[b] - cone.elevation);
                           });
}

/// As many cones as rings: ring i is cone i. Returns the rms angle, or nothing if it is large.
std::optional<double> match_all(const Beams& beams, const std::vector<Cone>& cones,
                                const Returns& returns) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < cones.size(); ++i) {
    if (cones[i].returns == 0) continue;
    const double angle = median_angle_above(beams, i, cones[i], returns);
    if (std::abs(angle) > 1 * kRadiansPerDegree) return std::nullopt;
    sum += angle * angle;
    count += 1;
  }
  const double rms = std::sqrt(sum / count);
  if (count < 2 || rms > 0.15 * kRadiansPerDegree) return std::nullopt;
  return rms;
}

/// Fewer cones than rings, because some rings have no return.
std::optional<double> match_some(const Beams& beams, const std::vector<Cone>& cones,
                                 const Returns& returns, std::vector<std::uint16_t>& rings) {
  double sum = 0, count = 0;
  int previous = -1;
  rings.assign(cones.size(), kNoRing);
  for (std::size_t i = 0; i < cones.size(); ++i) {
    if (cones[i].returns == 0) continue;
    const std::uint32_t middle = middle_return(cones[i], returns);
    const std::uint16_t ring = beams.nearest(returns.distance[middle], returns.height[middle]);
    if (static_cast<int>(ring) <= previous) return std::nullopt;
    const double angle = median_angle_above(beams, ring, cones[i], returns);
    if (std::abs(angle) > beams.half_gap(ring)) return std::nullopt;
    sum += std::pow(angle / (2 * beams.half_gap(ring)), 2);
    count += 1;
    previous = ring;
    rings[i] = ring;
  }
  const bool enough = count >= 8 && 2 * count >= static_cast<double>(beams.size());
  if (!enough || sum / count > 0.1 * 0.1) return std::nullopt;
  return std::sqrt(sum / count) * beams.half_gap(beams.size() / 2) * 2;
}

/// How far two numbers of columns are apart; a sensor also turns at half or twice its nominal
/// speed.
double column_distance(double columns, const SensorProfile& profile) {
  if (!(columns > 0)) return 0;
  const double octaves = std::log2(columns / profile.columns);
  return std::abs(octaves - std::round(octaves));
}

/// Keeps the better of two matches; those with the same rings are told apart by their columns.
void keep_better(std::optional<SensorMatch>& best, SensorMatch next, double tolerance,
                 double columns) {
  const auto name = next.profile.name;
  if (!best || next.error < best->error - tolerance) {
    best = std::move(next);
    return;
  }
  if (next.error > best->error + tolerance) return;
  const bool wins =
      column_distance(columns, next.profile) < column_distance(columns, best->profile);
  if (wins) std::swap(*best, next);
  best->also_fits = std::move(wins ? next.also_fits : best->also_fits);
  best->also_fits.push_back(next.profile.name);
}

/// Median distance of the returns to their beams, as a share of half the gap between beams: 0.5 by
/// chance. Nothing if the field of view differs or rings stay empty.
std::optional<double> share_of_gap(const SensorProfile& profile, const Returns& returns,
                                   const std::vector<std::uint32_t>& sample) {
  const Beams beams(profile);
  std::vector<double> shares, angles;
  std::vector<std::size_t> hits(beams.size(), 0);
  std::size_t outside = 0;
  for (const std::uint32_t i : sample) {
    const std::uint16_t ring = beams.nearest(returns.distance[i], returns.height[i]);
    const double angle = std::abs(beams.angle_above(ring, returns.distance[i], returns.height[i]));
    ++hits[ring];
    // Two extra gaps: outermost beams often stand apart.
    if (angle > 2 * beams.half_gap(ring)) ++outside;
    if (outside * 10 > sample.size()) return std::nullopt;
    shares.push_back(std::min(1.0, angle / beams.half_gap(ring)));
    angles.push_back(angle);
  }
  const double share = median(shares);
  if (share > 0.36 || median(angles) > 0.15 * kRadiansPerDegree) return std::nullopt;
  const auto empty = std::count(hits.begin(), hits.end(), std::size_t{0});
  if (4 * static_cast<std::size_t>(empty) > beams.size()) return std::nullopt;
  return share;
}

/// Some thousand far returns, drawn by a fixed sequence: every n-th one could always be of the same
/// few lasers.
std::vector<std::uint32_t> sample_of(const Returns& returns) {
  constexpr std::size_t kSample = 4096;
  std::vector<std::uint32_t> far;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (returns.is_far(i)) far.push_back(static_cast<std::uint32_t>(i));
  }
  if (far.size() <= kSample) return far;
  std::vector<std::uint32_t> sample;
  std::uint64_t state = 0;
  for (std::size_t k = 0; k < kSample; ++k) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    sample.push_back(far[static_cast<std::size_t>((state >> 33) % far.size())]);
  }
  return sample;
}

}  // namespace

std::optional<SensorMatch> match_cones(const std::vector<Cone>& cones, const Returns& returns,
                                       double columns) {
  std::optional<SensorMatch> best;
  bool best_is_whole = false;
  for (const SensorProfile& profile : builtin_profiles()) {
    const bool whole = profile.rings.size() == cones.size();
    if (profile.rings.size() < cones.size() || (best_is_whole && !whole)) continue;
    const Beams beams(profile);
    SensorMatch next{profile, {}, 0, {}};
    const auto error = whole ? match_all(beams, cones, returns)
                             : match_some(beams, cones, returns, next.ring_of_cone);
    if (!error) continue;
    next.error = *error;
    if (whole) {
      for (std::size_t i = 0; i < cones.size(); ++i) {
        next.ring_of_cone.push_back(static_cast<std::uint16_t>(i));
      }
      if (!best_is_whole) best.reset();
      best_is_whole = true;
    }
    keep_better(best, std::move(next), kSameRings, columns);
  }
  return best;
}

std::optional<SensorMatch> match_returns(const Returns& returns, double columns) {
  const std::vector<std::uint32_t> sample = sample_of(returns);
  std::optional<SensorMatch> best;
  for (const SensorProfile& profile : builtin_profiles()) {
    if (sample.size() < 8 * profile.rings.size()) continue;
    if (const auto share = share_of_gap(profile, returns, sample)) {
      keep_better(best, {profile, {}, *share, {}}, 0.02, columns);
    }
  }
  return best;
}

}  // namespace curlidar
