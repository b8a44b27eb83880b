// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/motion_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "sensor/motion_yaw.hpp"
#include "sensor/returns.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// Places of the parts of a motion in the vector of unknowns.
constexpr std::array<Vec3 MotionTwist::*, 6> kParts{
    &MotionTwist::turn,  &MotionTwist::move,       &MotionTwist::turn2,
    &MotionTwist::move2, &MotionTwist::rigid_turn, &MotionTwist::rigid_move};
constexpr std::array<double Vec3::*, 3> kAxes{&Vec3::x, &Vec3::y, &Vec3::z};
constexpr int kUnknowns = 18;
using Row = Eigen::Matrix<double, kUnknowns, 1>;

double& unknown(MotionTwist& motion, int index) {
  return motion.*kParts[static_cast<std::size_t>(index / 3)].*
         kAxes[static_cast<std::size_t>(index % 3)];
}

/// One return with the motion undone, as its beam sees it.
struct Undone {
  Vec3 fixed, point;  ///< rigid part taken off; all of the motion taken off
  double s = 0;
  double up = 0, across = 0;    ///< metres from the cone, and from the nearest encoder position
  Vec3 up_slope, across_slope;  ///< their derivatives by `point`
};

std::optional<Undone> undo(const MotionTwist& motion, const BeamModel& model, const Vec3& moved,
                           const Beam& beam) {
  const Unmoved unmoved = undo_motion(motion, moved);
  const auto view = view_along(beam, unmoved.point);
  if (!view) return std::nullopt;
  Undone out;
  out.fixed = rotate(motion.rigid_turn * -1, moved - motion.rigid_move);
  out.point = unmoved.point;
  out.s = unmoved.s;
  out.up = view->up_m;
  const double pitch = kTurn / model.slots, rho = view->distance_m;
  // Position 0 is at -pi, a whole number of steps from 0 only if there is an even number of them.
  out.across = std::remainder(view->encoder + std::numbers::pi, pitch) * rho;
  const Vec3& p = out.point;
  const double u = std::sqrt(rho * rho - beam.lateral_m * beam.lateral_m);
  const double fall = -std::sin(beam.elevation) / u, lean = beam.lateral_m / u;
  out.up_slope = {fall * p.x, fall * p.y, std::cos(beam.elevation)};
  out.across_slope = {(lean * p.x - p.y) / rho, (lean * p.y + p.x) / rho, 0};
  return out;
}

/// Derivative of a residual, whose slope by the undone point is given, by the 18 unknowns. The
/// change of s is left out: it is smaller by |turn| / 2 pi.
Row derivative(const MotionTwist& motion, const Undone& at, const Vec3& slope) {
  const double s = at.s, square = s * s;
  const Vec3 by_turn = cross(slope, at.point);
  const Vec3 before = rotate(motion.turn * s + motion.turn2 * square, slope);
  const Vec3 by_rigid_turn = cross(before, at.fixed);
  const Vec3 by_rigid_move = rotate(motion.rigid_turn, before) * -1;
  const std::array<Vec3, 6> parts{by_turn * s,      before * -s,   by_turn * square,
                                  before * -square, by_rigid_turn, by_rigid_move};
  Row row;
  for (int i = 0; i < 6; ++i) {
    const Vec3& part = parts[static_cast<std::size_t>(i)];
    row.segment<3>(3 * i) << part.x, part.y, part.z;
  }
  return row;
}

struct Step {
  std::span<const int> free;  ///< unknowns to be found
  double scale_m = 0;         ///< residuals beyond it count little
  bool with_across = false;   ///< fit encoder positions too
  std::size_t stride = 1;     ///< use every so many returns of the sample
};

/// Metres or radians: no vehicle's motion; the returns do not determine it.
constexpr double kMostChange = 50;

/// One Gauss-Newton step with weights that fall off with the residual.
void improve(MotionTwist& motion, const LatticeSample& sample, const BeamModel& model,
             const Step& step) {
  Eigen::Matrix<double, kUnknowns, kUnknowns> normal;
  normal.setZero();
  Row right = Row::Zero();
  const auto add = [&](const Undone& at, double residual, const Vec3& slope) {
    const double ratio = residual / step.scale_m;
    const double weight = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
    const Row row = derivative(motion, at, slope);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    right -= row * (weight * residual);
  };
  for (std::size_t i = 0; i < sample.points.size(); i += step.stride) {
    const auto at = undo(motion, model, sample.points[i], model.beams[sample.rings[i]]);
    if (!at) continue;
    add(*at, at->up, at->up_slope);
    if (step.with_across) add(*at, at->across, at->across_slope);
  }
  const auto n = static_cast<Eigen::Index>(step.free.size());
  Eigen::MatrixXd small(n, n);
  Eigen::VectorXd small_right(n);
  for (Eigen::Index r = 0; r < n; ++r) {
    const int row = step.free[static_cast<std::size_t>(r)];
    small_right(r) = right(row);
    for (Eigen::Index c = 0; c <= r; ++c) {
      const int column = step.free[static_cast<std::size_t>(c)];
      small(r, c) = normal(std::max(row, column), std::min(row, column));
    }
    small(r, r) *= 1 + 1e-9;
    small(r, r) += 1e-12;
  }
  const Eigen::VectorXd change = small.selfadjointView<Eigen::Lower>().ldlt().solve(small_right);
  if (!change.allFinite() || change.cwiseAbs().maxCoeff() > kMostChange) return;
  for (Eigen::Index r = 0; r < n; ++r) {
    unknown(motion, step.free[static_cast<std::size_t>(r)]) += change(r);
  }
}

constexpr std::array kAllButYaw{0, 1, 3, 4, 5};
constexpr std::array kRigidButYaw{0, 1, 3, 4, 5, 12, 13, 15, 16, 17};
constexpr std::array kQuadraticButYaw{0, 1, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 15, 16, 17};
constexpr std::array kTwist{0, 1, 2, 3, 4, 5};
// A rigid turn about the axis only renames the encoder positions.
constexpr std::array kQuadratic{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 15, 16, 17};

}  // namespace

SampleQuality measure(const LatticeSample& sample, const BeamModel& model,
                      const MotionTwist& motion, double tolerance_m) {
  std::vector<double> up, across;
  std::size_t good = 0;
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    const auto at = undo(motion, model, sample.points[i], model.beams[sample.rings[i]]);
    if (!at) continue;
    up.push_back(std::abs(at->up));
    across.push_back(std::abs(at->across));
    if (up.back() < tolerance_m && across.back() < tolerance_m) ++good;
  }
  if (up.empty()) return {};
  return {median(up), median(across),
          static_cast<double>(good) / static_cast<double>(sample.points.size())};
}

std::size_t relabel(LatticeSample& sample, const BeamModel& model, const MotionTwist& motion) {
  std::vector<double> sines, cosines;
  for (const Beam& beam : model.beams) {
    sines.push_back(std::sin(beam.elevation));
    cosines.push_back(std::cos(beam.elevation));
  }
  std::size_t changed = 0;
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    const Vec3 p = undo_motion(motion, sample.points[i]).point;
    const double square = p.x * p.x + p.y * p.y;
    double nearest = std::numeric_limits<double>::infinity();
    std::uint16_t ring = sample.rings[i];
    for (std::size_t k = 0; k < model.beams.size(); ++k) {
      const double lateral = model.beams[k].lateral_m;
      const double u = std::sqrt(std::max(0.0, square - lateral * lateral));
      const double up = std::abs((p.z - model.beams[k].height_m) * cosines[k] - u * sines[k]);
      if (up >= nearest) continue;
      nearest = up;
      ring = static_cast<std::uint16_t>(k);
    }
    if (ring != sample.rings[i]) ++changed;
    sample.rings[i] = ring;
  }
  return changed;
}

MotionTwist search_motion(const LatticeSample& sample, const BeamModel& model,
                          MotionFreedom freedom) {
  const bool rich = freedom == MotionFreedom::quadratic;
  MotionTwist motion;
  // Elevations say all but the yaw. Scales shrink as the residuals do; few returns do at first.
  const auto fit = [&](std::span<const int> free, double scale, bool across, std::size_t returns,
                       int steps) {
    const std::size_t stride = std::max<std::size_t>(1, sample.points.size() / returns);
    for (int i = 0; i < steps; ++i) improve(motion, sample, model, {free, scale, across, stride});
  };
  const std::span<const int> first = rich ? std::span<const int>(kRigidButYaw) : kAllButYaw;
  for (const double scale : {.3, .1, .05, .02}) fit(first, scale, false, 4000, 4);
  const std::span<const int> second = rich ? std::span<const int>(kQuadraticButYaw) : kAllButYaw;
  for (const double scale : {.01, .003}) fit(second, scale, false, 8000, 3);
  const Yaw yaw = scan_yaw(sample, model, motion, rich);
  motion.turn.z = yaw.turn;
  motion.turn2.z = yaw.turn2;
  const std::span<const int> last = rich ? std::span<const int>(kQuadratic) : kTwist;
  for (const double scale : {.01, .003}) fit(last, scale, true, 4000, 3);
  fit(last, .002, true, 8000, 1);
  fit(last, .001, true, sample.points.size(), 1);
  return motion;
}

}  // namespace curlidar
