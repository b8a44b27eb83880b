// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/register.hpp"

#include <fmt/format.h>

#include <deque>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "register/align.hpp"
#include "register/guesses.hpp"
#include "register/thinning.hpp"

namespace curlidar {

using registration::align;
using registration::TargetSurface;

Result<Registration> register_pair(const Cloud& source, const Cloud& target,
                                   const std::optional<RigidMotion>& guess,
                                   const RegisterSettings& settings) {
  CURLIDAR_TRY(registration::check_settings(settings));
  CURLIDAR_TRY_ASSIGN(from, registration::usable_points(source, settings));
  CURLIDAR_TRY_ASSIGN(onto, registration::usable_points(target, settings));
  const std::vector<Vec3> moved = registration::thinned(from, settings.source_voxel_m);
  TargetSurface surface(registration::thinned(onto, settings.target_voxel_m));
  if (!guess) return registration::align_from_many(moved, surface, {}, settings);
  Registration result =
      align(moved, surface, *guess, registration::full_descent(settings), settings);
  registration::judge(result, settings.min_matched_share);
  if (result.trusted() || settings.search_m <= 0) return result;
  Registration searched = registration::align_from_many(moved, surface, *guess, settings);
  return searched.trusted() ? searched : result;
}

struct ScanMatcher::State {
  /// A scan of the local map: its points in the matcher's own frame, which is that of the first
  /// scan, so that far maps (UTM) cost no digits.
  struct Keyframe {
    std::vector<Vec3> points;
    RigidMotion pose;
  };

  RegisterSettings settings;
  std::deque<Keyframe> keyframes;
  std::unique_ptr<TargetSurface> surface;
  RigidMotion T_map_first;                ///< of the first scan
  RigidMotion pose;                       ///< of the last scan, in the matcher's frame
  std::optional<RigidMotion> step;        ///< from the last scan but one to the last
  std::optional<RigidMotion> last_guess;  ///< what the caller said of the last scan
  bool started = false;

  bool wants_keyframe() const {
    const RigidMotion since = keyframes.back().pose.inverse() * pose;
    return norm(since.move) >= settings.keyframe_m ||
           registration::turn_of(since) * 180 / std::numbers::pi >= settings.keyframe_turn_deg;
  }

  void add_keyframe(const std::vector<Vec3>& thin) {
    Keyframe frame{{}, pose};
    frame.points.reserve(thin.size());
    for (const Vec3& p : thin) frame.points.push_back(pose(p));
    keyframes.push_back(std::move(frame));
    if (keyframes.size() > settings.keyframes) keyframes.pop_front();
    std::vector<Vec3> all;
    // The newest first: thinning keeps the first point of a cell.
    for (auto frame_at = keyframes.rbegin(); frame_at != keyframes.rend(); ++frame_at) {
      all.insert(all.end(), frame_at->points.begin(), frame_at->points.end());
    }
    surface = std::make_unique<TargetSurface>(registration::thinned(all, settings.target_voxel_m));
  }

  /// Where the next scan is expected, in the matcher's frame.
  std::optional<RigidMotion> expected(const std::optional<RigidMotion>& guess) const {
    if (guess && last_guess) return pose * (last_guess->inverse() * *guess);
    if (guess) return T_map_first.inverse() * *guess;
    if (step) return pose * *step;
    return std::nullopt;
  }

  Registration match(const std::vector<Vec3>& moved, const std::optional<RigidMotion>& expected) {
    if (!expected) return registration::align_from_many(moved, *surface, pose, settings);
    Registration result =
        align(moved, *surface, *expected, registration::full_descent(settings), settings);
    registration::judge(result, settings.min_matched_share);
    if (result.trusted() || settings.search_m <= 0) return result;
    const Registration searched =
        registration::align_from_many(moved, *surface, *expected, settings);
    return searched.trusted() ? searched : result;
  }
};

ScanMatcher::ScanMatcher(const RegisterSettings& settings) : state_(std::make_unique<State>()) {
  state_->settings = settings;
}
ScanMatcher::~ScanMatcher() = default;
ScanMatcher::ScanMatcher(ScanMatcher&&) noexcept = default;
ScanMatcher& ScanMatcher::operator=(ScanMatcher&&) noexcept = default;

Result<Registration> ScanMatcher::add(const Cloud& scan, const std::optional<RigidMotion>& guess) {
  State& state = *state_;
  CURLIDAR_TRY(registration::check_settings(state.settings));
  CURLIDAR_TRY_ASSIGN(points, registration::usable_points(scan, state.settings));
  const std::vector<Vec3> thin = registration::thinned(points, state.settings.target_voxel_m);
  Registration result;
  if (!state.started) {
    if (guess) state.T_map_first = *guess;
    result.matched_share = 1;
    state.started = true;
    state.add_keyframe(thin);
  } else {
    const std::vector<Vec3> moved = registration::thinned(points, state.settings.source_voxel_m);
    const auto expected = state.expected(guess);
    result = state.match(moved, expected);
    if (!result.trusted() && guess) result.T_target_source = *expected;
    state.step = state.pose.inverse() * result.T_target_source;
    state.pose = result.T_target_source;
    if (state.wants_keyframe()) state.add_keyframe(thin);
  }
  state.last_guess = guess;
  result.T_target_source = state.T_map_first * state.pose;
  return result;
}

Result<std::vector<Registration>> register_sequence(std::span<const Cloud> scans,
                                                    std::span<const RigidMotion> guesses,
                                                    const RegisterSettings& settings,
                                                    const ProgressCallback& progress) {
  if (!guesses.empty() && guesses.size() != scans.size()) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} poses of {} scans", guesses.size(), scans.size())};
  }
  ScanMatcher matcher(settings);
  std::vector<Registration> results;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (progress) progress("match", static_cast<double>(k) / static_cast<double>(scans.size()));
    const auto guess = guesses.empty() ? std::nullopt : std::optional(guesses[k]);
    Result<Registration> result = matcher.add(scans[k], guess);
    if (!result)
      return Error{result.error().code, fmt::format("scan {}: {}", k, result.error().message)};
    results.push_back(*std::move(result));
  }
  return results;
}

}  // namespace curlidar
