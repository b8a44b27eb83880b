// SPDX-License-Identifier: BSD-3-Clause
#include "register/align.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/parallel.hpp"

namespace curlidar::registration {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kPointsPerTask = 1024;
constexpr double kNear_m = 0.3;          ///< a point this near to the target counts as matched
constexpr double kOverlapScale_m = 0.2;  ///< of the score that compares guesses
/// Steps below these end a descent.
constexpr double kStill_m = 1e-4, kStill_rad = 1e-5;

/// The normal equations of a step: turn about the sensor, then move.
struct Equations {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  Eigen::Matrix3d planes = Eigen::Matrix3d::Zero();  ///< weighted sum of n n^T
  double weight = 0;
  double squared = 0;  ///< sum of squared distances to planes
  std::size_t matched = 0;

  void add(const Equations& other) {
    matrix += other.matrix;
    right += other.right;
    planes += other.planes;
    weight += other.weight;
    squared += other.squared;
    matched += other.matched;
  }
};

std::size_t tasks_of(std::size_t points) {
  return (points + kPointsPerTask - 1) / kPointsPerTask;
}

template <class Body>
void over_points(std::size_t points, std::size_t threads, const Body& body) {
  parallel_for(tasks_of(points), threads, [&](std::size_t task) {
    const std::size_t end = std::min(points, (task + 1) * kPointsPerTask);
    for (std::size_t i = task * kPointsPerTask; i < end; ++i) body(task, i);
  });
}

void add_point(const Vec3& arm, const Vec3& normal, double distance, double scale, Equations& out) {
  const double ratio = distance / scale;
  const double weight = 1 / (1 + ratio * ratio);
  const Vec3 turning = cross(arm, normal);
  Vector6 row;
  row << turning.x, turning.y, turning.z, normal.x, normal.y, normal.z;
  out.matrix.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
  out.right -= row * (weight * distance);
  const auto n = row.tail<3>();
  out.planes += weight * n * n.transpose();
  out.weight += weight;
  out.squared += distance * distance;
  ++out.matched;
}

RigidMotion small_motion(const Vector6& step) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  const Eigen::Matrix3d matrix = angle > 0
                                     ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()
                                     : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  RigidMotion motion;
  for (int row = 0; row < 3; ++row) {
    motion.rotation[static_cast<std::size_t>(row)] = {matrix(row, 0), matrix(row, 1),
                                                      matrix(row, 2)};
  }
  return motion;
}

/// Takes out what rounding did to a rotation in many products.
void straighten(RigidMotion& motion) {
  auto& [x, y, z] = motion.rotation;
  x = x * (1 / norm(x));
  y = y - x * dot(x, y);
  y = y * (1 / norm(y));
  z = cross(x, y);
}

/// The state of one descent.
class Aligner {
 public:
  Aligner(std::span<const Vec3> source, TargetSurface& target, const RegisterSettings& settings)
      : source_(source), target_(target), settings_(settings), matches_(source.size()) {}

  Equations equations(const RigidMotion& motion, double gate_m) {
    over_points(source_.size(), settings_.threads, [&](std::size_t, std::size_t i) {
      matches_[i] = target_.nearest(motion(source_[i]), gate_m);
    });
    target_.make_planes(matches_, settings_.threads);
    // Sums are made in the order of tasks, so that threads do not change their rounding.
    std::vector<Equations> parts(tasks_of(source_.size()));
    over_points(source_.size(), settings_.threads, [&](std::size_t task, std::size_t i) {
      if (matches_[i] == kNoTarget) return;
      const Vec3& normal = target_.normal(matches_[i]);
      if (normal == Vec3{}) return;
      const Vec3 arm = motion.turned(source_[i]);
      const double distance = dot(arm + motion.move - target_.points()[matches_[i]], normal);
      add_point(arm, normal, distance, settings_.weight_scale_m, parts[task]);
    });
    Equations sum;
    for (const Equations& part : parts) sum.add(part);
    return sum;
  }

  double share_near(const RigidMotion& motion) {
    std::vector<std::size_t> near(tasks_of(source_.size()));
    over_points(source_.size(), settings_.threads, [&](std::size_t task, std::size_t i) {
      near[task] += target_.nearest(motion(source_[i]), kNear_m) != kNoTarget;
    });
    std::size_t sum = 0;
    for (const std::size_t part : near) sum += part;
    return static_cast<double>(sum) / static_cast<double>(source_.size());
  }

 private:
  std::span<const Vec3> source_;
  TargetSurface& target_;
  const RegisterSettings& settings_;
  std::vector<std::uint32_t> matches_;
};

/// Fewer matches than this hold nothing.
constexpr std::size_t kFewestMatches = 30;

}  // namespace

Registration align(std::span<const Vec3> source, TargetSurface& target, const RigidMotion& guess,
                   const Descent& descent, const RegisterSettings& settings) {
  Registration result;
  result.T_target_source = guess;
  Aligner aligner(source, target, settings);
  double gate = descent.first_gate_m;
  for (; result.iterations < descent.iterations; ++result.iterations) {
    RigidMotion& motion = result.T_target_source;
    const Equations sum = aligner.equations(motion, gate);
    if (sum.matched < kFewestMatches) break;
    const Matrix6 full = sum.matrix.selfadjointView<Eigen::Lower>();
    // A little of nothing: directions that no plane holds stay as they were guessed.
    const Matrix6 damped = full + Matrix6::Identity() * (1e-9 * full.trace());
    const Vector6 step = damped.ldlt().solve(sum.right);
    if (!step.allFinite()) break;
    const RigidMotion turn = small_motion(step);
    const Vec3 move = motion.move + Vec3{step[3], step[4], step[5]};
    motion.move = {};
    motion = turn * motion;
    motion.move = move;
    straighten(motion);
    result.rms_m = std::sqrt(sum.squared / static_cast<double>(sum.matched));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> holding(sum.planes / sum.weight);
    result.weakest_share = holding.eigenvalues()[0];
    const bool still = step.head<3>().cwiseAbs().maxCoeff() < kStill_rad &&
                       step.tail<3>().cwiseAbs().maxCoeff() < kStill_m;
    if (still && gate <= descent.last_gate_m) break;
    gate = std::max(descent.last_gate_m, gate * settings.gate_factor);
  }
  result.matched_share = source.empty() ? 0 : aligner.share_near(result.T_target_source);
  return result;
}

double overlap(std::span<const Vec3> source, const TargetSurface& target, const RigidMotion& motion,
               std::size_t threads) {
  constexpr double kFar_m = 1.5;
  std::vector<double> parts(tasks_of(source.size()));
  over_points(source.size(), threads, [&](std::size_t task, std::size_t i) {
    const Vec3 p = motion(source[i]);
    const std::uint32_t near = target.nearest(p, kFar_m);
    if (near == kNoTarget) return;
    const double ratio = norm(p - target.points()[near]) / kOverlapScale_m;
    parts[task] += 1 / (1 + ratio * ratio);
  });
  double sum = 0;
  for (const double part : parts) sum += part;
  return source.empty() ? 0 : sum / static_cast<double>(source.size());
}

double turn_of(const RigidMotion& motion) {
  const auto& [x, y, z] = motion.rotation;
  return std::acos(std::clamp((x.x + y.y + z.z - 1) / 2, -1.0, 1.0));
}

}  // namespace curlidar::registration
