// SPDX-License-Identifier: BSD-3-Clause
#include "register/guesses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "register/thinning.hpp"

namespace curlidar::registration {
namespace {

constexpr std::size_t kFewestPoints = 100;
constexpr double kGuessStep_m = 2;       ///< between guesses; a descent reaches about as far
constexpr double kSamePlace_m = 0.5;     ///< results nearer than this are one
constexpr double kClearlyBetter = 0.95;  ///< a second place must score below this share of the best
constexpr double kLeastHeld = 0.005;     ///< see Registration::weakest_share
constexpr double kMost_rms_m = 0.12;

/// A descent of few steps with few points.
constexpr Descent kQuick{1.5, 0.3, 12};

struct Candidate {
  Registration result;
  double score = 0;
};

}  // namespace

Status check_settings(const RegisterSettings& s) {
  const bool ranges = s.min_range_m >= 0 && s.min_range_m < s.max_range_m;
  const bool voxels = s.target_voxel_m > 0 && s.source_voxel_m > 0;
  const bool gates = s.last_gate_m > 0 && s.last_gate_m <= s.first_gate_m && s.gate_factor > 0 &&
                     s.gate_factor <= 1 && s.weight_scale_m > 0;
  const bool rest = s.iterations > 0 && s.search_m >= 0 && s.keyframe_m >= 0 && s.keyframes > 0;
  if (ranges && voxels && gates && rest) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("registration: {} make no sense",
                           !ranges   ? "the limits of range"
                           : !voxels ? "the sizes of voxels"
                           : !gates  ? "the gates"
                                     : "the numbers of iterations or keyframes")};
}

Result<std::vector<Vec3>> usable_points(const Cloud& scan, const RegisterSettings& settings) {
  std::vector<Vec3> points = returns_in_range(scan, settings.min_range_m, settings.max_range_m);
  if (points.size() >= kFewestPoints) return points;
  return Error{
      ErrorCode::invalid_argument,
      fmt::format("{} returns between {} and {} m are too few to match a scan by: leave it "
                  "out, or widen the limits",
                  points.size(), settings.min_range_m, settings.max_range_m)};
}

Descent full_descent(const RegisterSettings& settings) {
  return {settings.first_gate_m, settings.last_gate_m, settings.iterations};
}

void judge(Registration& result, double least_matched_share) {
  if (!result.doubt.empty()) return;
  if (result.matched_share < least_matched_share) {
    result.doubt =
        fmt::format("only {:.0f} % of the points have a match", 100 * result.matched_share);
  } else if (result.rms_m > kMost_rms_m) {
    result.doubt =
        fmt::format("matched points lie {:.0f} cm from their planes", 100 * result.rms_m);
  } else if (result.weakest_share < kLeastHeld) {
    result.doubt = "nothing in the scan says how far the sensor went in one direction";
  }
}

Registration align_from_many(std::span<const Vec3> source, TargetSurface& target,
                             const RigidMotion& guess, const RegisterSettings& settings) {
  const std::vector<Vec3> few = thinned(source, 2 * settings.source_voxel_m);
  std::vector<Candidate> candidates;
  const int reach = static_cast<int>(std::floor(settings.search_m / kGuessStep_m));
  for (int i = -reach; i <= reach; ++i) {
    RigidMotion start = guess;
    start.move = guess({kGuessStep_m * i, 0, 0});
    Candidate candidate{align(few, target, start, kQuick, settings), 0};
    candidate.score = overlap(few, target, candidate.result.T_target_source, settings.threads);
    candidates.push_back(std::move(candidate));
  }
  const auto best =
      std::max_element(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  const RigidMotion coarse = best->result.T_target_source;
  double second = 0;
  for (const Candidate& other : candidates) {
    if (norm(other.result.T_target_source.move - coarse.move) > kSamePlace_m) {
      second = std::max(second, other.score);
    }
  }
  Registration result = align(source, target, coarse, full_descent(settings), settings);
  judge(result, settings.min_matched_share / 2);
  if (result.doubt.empty() && second > kClearlyBetter * best->score) {
    result.doubt = "another place fits nearly as well";
  }
  return result;
}

}  // namespace curlidar::registration
