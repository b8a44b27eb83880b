// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate_refine.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.hpp"
#include "sensor/returns.hpp"

namespace curlidar::calibration {
namespace {

// Parameters: four of each beam (elevation, height, azimuth offset, lateral) and six of each
// motion (turn, move).
constexpr int kOfBeam = 4, kOfMotion = 6;
using BeamVector = Eigen::Matrix<double, kOfBeam, 1>;
using BeamMatrix = Eigen::Matrix<double, kOfBeam, kOfBeam>;
using MotionVector = Eigen::Matrix<double, kOfMotion, 1>;
using MotionMatrix = Eigen::Matrix<double, kOfMotion, kOfMotion>;
using MixedMatrix = Eigen::Matrix<double, kOfBeam, kOfMotion>;

/// A residual cannot be a metre per radian or metre exact to more than this.
constexpr double kFinestScale_m = 2e-7;

double& component(MotionTwist& motion, int i) {
  const std::array<double*, kOfMotion> all{&motion.turn.x, &motion.turn.y, &motion.turn.z,
                                           &motion.move.x, &motion.move.y, &motion.move.z};
  return *all[static_cast<std::size_t>(i)];
}

/// Distances of one point from its place.
struct Residual {
  double up = 0, across = 0;
};

/// How far the beam at `distance` from the axis reaches along its own direction.
double along(const Beam& beam, double distance) {
  return std::sqrt(std::max(0.0, distance * distance - beam.lateral_m * beam.lateral_m));
}

Residual residual_of(const BeamModel& model, std::size_t ring, const Vec3& p, bool azimuth) {
  const Beam& beam = model.beams[ring];
  const double distance = std::hypot(p.x, p.y);
  const double u = along(beam, distance);
  Residual r;
  r.up = (p.z - beam.height_m) * std::cos(beam.elevation) - u * std::sin(beam.elevation);
  if (!azimuth) return r;
  const double pitch = 2 * std::numbers::pi / model.slots;
  const double encoder = azimuth_of(p) - std::atan2(beam.lateral_m, u) - beam.azimuth_offset;
  r.across = std::remainder(encoder + std::numbers::pi, pitch) * distance;
  return r;
}

/// How the distances of a point from its place follow the point.
struct Gradient {
  Vec3 up, across;
};

Gradient gradient_of(const Beam& beam, const Vec3& p) {
  const double distance = std::max(std::hypot(p.x, p.y), 1e-3);
  const double u = std::max(along(beam, distance), 1e-3);
  const double c = std::cos(beam.elevation), s = std::sin(beam.elevation);
  const double aside = beam.lateral_m / (distance * u);
  return {{-s * p.x / u, -s * p.y / u, c},
          {-p.y / distance + aside * p.x, p.x / distance + aside * p.y, 0}};
}

/// How an undone point, at s of a turn, follows the six numbers of its motion: directly, and
/// because s is that of the undone point itself.
std::array<Vec3, kOfMotion> slopes_of(const MotionTwist& motion, const Vec3& p, double s) {
  const Vec3 back = motion.turn * -s;
  const Vec3 by_s = point_by_turn(motion, p, s);
  const double square = std::max(p.x * p.x + p.y * p.y, 1e-6);
  const Vec3 s_by_point = Vec3{-p.y, p.x, 0} * (1 / (2 * std::numbers::pi * square));
  const double loop = 1 - dot(s_by_point, by_s);
  std::array<Vec3, kOfMotion> out;
  constexpr std::array<Vec3, 3> kAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = cross(kAxes[k], p) * -s;
    out[k + 3] = rotate(back, kAxes[k]) * -s;
  }
  for (Vec3& slope : out) slope = slope + by_s * (dot(s_by_point, slope) / loop);
  return out;
}

/// What one scan adds to the normal equations: sums for each beam, for the scan's motion, and
/// between them.
struct Normal {
  explicit Normal(std::size_t beams)
      : beam(beams, BeamMatrix::Zero()),
        beam_right(beams, BeamVector::Zero()),
        mixed(beams, MixedMatrix::Zero()) {}

  void add(std::size_t ring, const BeamVector& by_beam, const MotionVector& by_motion,
           double residual, double weight) {
    beam[ring].noalias() += weight * by_beam * by_beam.transpose();
    beam_right[ring].noalias() += weight * residual * by_beam;
    mixed[ring].noalias() += weight * by_beam * by_motion.transpose();
    motion.noalias() += weight * by_motion * by_motion.transpose();
    motion_right.noalias() += weight * residual * by_motion;
  }

  std::vector<BeamMatrix> beam;
  std::vector<BeamVector> beam_right;
  std::vector<MixedMatrix> mixed;
  MotionMatrix motion = MotionMatrix::Zero();
  MotionVector motion_right = MotionVector::Zero();
};

/// Parameters that no residual moves stay where they are.
template <class Matrix>
void hold_unmoved(Matrix& matrix) {
  const double largest = std::max(matrix.diagonal().maxCoeff(), 1e-12);
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    matrix(i, i) = matrix(i, i) > 1e-12 * largest ? matrix(i, i) * (1 + 1e-9) : largest;
  }
}

struct Step {
  std::vector<BeamVector> beams;
  Eigen::VectorXd motions;
};

/// Solves for the motions first (the Schur complement), then for each beam.
Step solve(std::vector<Normal>& scans) {
  const std::size_t beams = scans.front().beam.size();
  const auto size = static_cast<Eigen::Index>(scans.size()) * kOfMotion;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right(size);
  const auto at = [](std::size_t scan) { return static_cast<Eigen::Index>(scan) * kOfMotion; };
  for (std::size_t s = 0; s < scans.size(); ++s) {
    hold_unmoved(scans[s].motion);
    matrix.block<kOfMotion, kOfMotion>(at(s), at(s)) = scans[s].motion;
    right.segment<kOfMotion>(at(s)) = scans[s].motion_right;
  }
  std::vector<Eigen::LDLT<BeamMatrix>> solvers;
  std::vector<BeamVector> rests;
  for (std::size_t ring = 0; ring < beams; ++ring) {
    BeamMatrix all = BeamMatrix::Zero();
    rests.push_back(BeamVector::Zero());
    for (const Normal& scan : scans) {
      all += scan.beam[ring];
      rests.back() += scan.beam_right[ring];
    }
    hold_unmoved(all);
    solvers.emplace_back(all);
    for (std::size_t s = 0; s < scans.size(); ++s) {
      const MixedMatrix solved = solvers.back().solve(scans[s].mixed[ring]);
      right.segment<kOfMotion>(at(s)).noalias() -= solved.transpose() * rests.back();
      for (std::size_t t = 0; t < scans.size(); ++t) {
        matrix.block<kOfMotion, kOfMotion>(at(s), at(t)).noalias() -=
            solved.transpose() * scans[t].mixed[ring];
      }
    }
  }
  Step step;
  step.motions = matrix.ldlt().solve(right);
  if (!step.motions.allFinite()) step.motions.setZero();
  for (std::size_t ring = 0; ring < beams; ++ring) {
    for (std::size_t s = 0; s < scans.size(); ++s) {
      rests[ring].noalias() -= scans[s].mixed[ring] * step.motions.segment<kOfMotion>(at(s));
    }
    step.beams.push_back(solvers[ring].solve(rests[ring]));
    if (!step.beams.back().allFinite()) step.beams.back().setZero();
  }
  return step;
}

/// One evaluation of everything: residuals, and how they follow the parameters.
class Problem {
 public:
  Problem(std::span<ScanSample> samples, BeamModel& model, const RefineSettings& settings)
      : samples_(samples), model_(model), settings_(settings) {
    for (const ScanSample& sample : samples) {
      std::vector<Unmoved>& undone = undone_.emplace_back();
      undone.resize(sample.size());
    }
  }

  /// Median residuals with the parameters as they are.
  Misfit measure() {
    std::vector<std::vector<double>> ups(samples_.size()), acrosses(samples_.size());
    parallel_for(samples_.size(), settings_.threads, [&](std::size_t s) {
      const ScanSample& sample = samples_[s];
      for (std::size_t i = 0; i < sample.size(); ++i) {
        undone_[s][i] = undo_motion(sample.motion, sample.moved[i]);
        const Residual r =
            residual_of(model_, sample.ring[i], undone_[s][i].point, settings_.azimuth);
        ups[s].push_back(std::abs(r.up));
        acrosses[s].push_back(std::abs(r.across));
      }
    });
    std::vector<double> up, across;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      up.insert(up.end(), ups[s].begin(), ups[s].end());
      across.insert(across.end(), acrosses[s].begin(), acrosses[s].end());
    }
    if (up.empty()) return {};
    return {median(up), settings_.azimuth ? median(across) : 0};
  }

  void step(double up_scale, double across_scale) {
    std::vector<Normal> scans(samples_.size(), Normal(model_.beams.size()));
    parallel_for(samples_.size(), settings_.threads,
                 [&](std::size_t s) { accumulate(scans[s], s, up_scale, across_scale); });
    const Step step = solve(scans);
    for (std::size_t ring = 0; ring < model_.beams.size(); ++ring) {
      Beam& beam = model_.beams[ring];
      beam.elevation += step.beams[ring][0];
      beam.height_m += step.beams[ring][1];
      beam.azimuth_offset += step.beams[ring][2];
      beam.lateral_m += step.beams[ring][3];
    }
    if (!settings_.motion) return;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      for (int i = 0; i < kOfMotion; ++i) {
        component(samples_[s].motion, i) +=
            step.motions[static_cast<Eigen::Index>(s) * kOfMotion + i];
      }
    }
  }

 private:
  void accumulate(Normal& normal, std::size_t s, double up_scale, double across_scale) const {
    const ScanSample& sample = samples_[s];
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const std::size_t ring = sample.ring[i];
      const Vec3& p = undone_[s][i].point;
      const Residual r = residual_of(model_, ring, p, settings_.azimuth);
      MotionVector up_by_motion = MotionVector::Zero(), across_by_motion = MotionVector::Zero();
      if (settings_.motion) {
        const Gradient gradient = gradient_of(model_.beams[ring], p);
        const auto slopes = slopes_of(sample.motion, p, undone_[s][i].s);
        for (std::size_t k = 0; k < slopes.size(); ++k) {
          if (!settings_.azimuth && k == 2) continue;  // the yaw does not show
          up_by_motion[static_cast<Eigen::Index>(k)] = dot(gradient.up, slopes[k]);
          across_by_motion[static_cast<Eigen::Index>(k)] = dot(gradient.across, slopes[k]);
        }
      }
      add_up(normal, ring, p, r.up, up_by_motion, up_scale);
      if (settings_.azimuth) {
        add_across(normal, ring, p, r.across, across_by_motion, across_scale);
      }
    }
  }

  /// Geman and McClure's weight.
  static double weight_of(double residual, double scale) {
    const double x = residual / scale;
    const double w = 1 / (1 + x * x);
    return w * w;
  }

  void add_up(Normal& normal, std::size_t ring, const Vec3& p, double residual,
              const MotionVector& by_motion, double scale) const {
    const Beam& beam = model_.beams[ring];
    const double c = std::cos(beam.elevation), s = std::sin(beam.elevation);
    const double u = along(beam, std::hypot(p.x, p.y));
    BeamVector by_beam = BeamVector::Zero();
    by_beam[0] = -(p.z - beam.height_m) * s - u * c;
    by_beam[1] = -c;
    normal.add(ring, by_beam, by_motion, -residual, weight_of(residual, scale));
  }

  void add_across(Normal& normal, std::size_t ring, const Vec3& p, double residual,
                  const MotionVector& by_motion, double scale) const {
    const Beam& beam = model_.beams[ring];
    const double distance = std::hypot(p.x, p.y);
    BeamVector by_beam = BeamVector::Zero();
    by_beam[2] = -distance;
    by_beam[3] = -distance / std::max(along(beam, distance), 1e-3);
    // Where half a pitch is not well above the scale, the nearest position may be the wrong one.
    const double half_pitch = std::numbers::pi / model_.slots * distance;
    const double ambiguity = std::min(1.0, half_pitch / (4 * scale));
    normal.add(ring, by_beam, by_motion, -residual,
               weight_of(residual, scale) * ambiguity * ambiguity);
  }

  std::span<ScanSample> samples_;
  BeamModel& model_;
  const RefineSettings& settings_;
  std::vector<std::vector<Unmoved>> undone_;
};

}  // namespace

Misfit refine(std::span<ScanSample> samples, BeamModel& model, const RefineSettings& settings) {
  Problem problem(samples, model, settings);
  Misfit misfit = problem.measure();
  double last = 0;
  for (int i = 0; i < settings.most_steps; ++i) {
    const double up_scale = std::clamp(3 * misfit.up_m, kFinestScale_m, settings.start_scale_m);
    const double across_scale =
        std::clamp(3 * misfit.across_m, kFinestScale_m, settings.start_scale_m);
    problem.step(up_scale, across_scale);
    misfit = problem.measure();
    const double now = misfit.up_m + misfit.across_m;
    if (i >= 2 && std::abs(now - last) <= 1e-3 * now) break;
    last = now;
  }
  return misfit;
}

}  // namespace curlidar::calibration
