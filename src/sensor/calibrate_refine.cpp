// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate_refine.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

/// The normal equations, one beam at a time on one side and one motion at a time on the other.
struct Normal {
  Normal(std::size_t beams, std::size_t scans)
      : scan_count(scans),
        beam(beams, BeamMatrix::Zero()),
        beam_right(beams, BeamVector::Zero()),
        mixed(beams * scans, MixedMatrix::Zero()),
        motion(scans, MotionMatrix::Zero()),
        motion_right(scans, MotionVector::Zero()) {}

  void add(std::size_t ring, std::size_t scan, const BeamVector& by_beam,
           const MotionVector& by_motion, double residual, double weight) {
    beam[ring].noalias() += weight * by_beam * by_beam.transpose();
    beam_right[ring].noalias() += weight * residual * by_beam;
    mixed[ring * scan_count + scan].noalias() += weight * by_beam * by_motion.transpose();
    motion[scan].noalias() += weight * by_motion * by_motion.transpose();
    motion_right[scan].noalias() += weight * residual * by_motion;
  }

  std::size_t scan_count;
  std::vector<BeamMatrix> beam;
  std::vector<BeamVector> beam_right;
  std::vector<MixedMatrix> mixed;  // [ring * scan_count + scan]
  std::vector<MotionMatrix> motion;
  std::vector<MotionVector> motion_right;
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
Step solve(Normal& normal) {
  const std::size_t scans = normal.scan_count;
  const auto size = static_cast<Eigen::Index>(scans) * kOfMotion;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right(size);
  const auto at = [](std::size_t scan) { return static_cast<Eigen::Index>(scan) * kOfMotion; };
  for (std::size_t s = 0; s < scans; ++s) {
    hold_unmoved(normal.motion[s]);
    matrix.block<kOfMotion, kOfMotion>(at(s), at(s)) = normal.motion[s];
    right.segment<kOfMotion>(at(s)) = normal.motion_right[s];
  }
  std::vector<Eigen::LDLT<BeamMatrix>> solvers;
  for (std::size_t ring = 0; ring < normal.beam.size(); ++ring) {
    hold_unmoved(normal.beam[ring]);
    solvers.emplace_back(normal.beam[ring]);
    const MixedMatrix* mixed = &normal.mixed[ring * scans];
    for (std::size_t s = 0; s < scans; ++s) {
      const MixedMatrix solved = solvers.back().solve(mixed[s]);
      right.segment<kOfMotion>(at(s)).noalias() -= solved.transpose() * normal.beam_right[ring];
      for (std::size_t t = 0; t < scans; ++t) {
        matrix.block<kOfMotion, kOfMotion>(at(s), at(t)).noalias() -= solved.transpose() * mixed[t];
      }
    }
  }
  Step step;
  step.motions = matrix.ldlt().solve(right);
  if (!step.motions.allFinite()) step.motions.setZero();
  for (std::size_t ring = 0; ring < normal.beam.size(); ++ring) {
    BeamVector rest = normal.beam_right[ring];
    for (std::size_t s = 0; s < scans; ++s) {
      rest.noalias() -= normal.mixed[ring * scans + s] * step.motions.segment<kOfMotion>(at(s));
    }
    step.beams.push_back(solvers[ring].solve(rest));
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
      std::vector<Vec3>& undone = undone_.emplace_back();
      undone.resize(sample.size());
    }
  }

  /// Median residuals with the parameters as they are.
  Misfit measure() {
    std::vector<double> up, across;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const ScanSample& sample = samples_[s];
      for (std::size_t i = 0; i < sample.size(); ++i) {
        undone_[s][i] = undo(sample.motion, sample.moved[i]);
        const Residual r = residual_of(model_, sample.ring[i], undone_[s][i], settings_.azimuth);
        up.push_back(std::abs(r.up));
        across.push_back(std::abs(r.across));
      }
    }
    if (up.empty()) return {};
    return {median(up), settings_.azimuth ? median(across) : 0};
  }

  void step(double up_scale, double across_scale) {
    Normal normal(model_.beams.size(), samples_.size());
    for (std::size_t s = 0; s < samples_.size(); ++s) accumulate(normal, s, up_scale, across_scale);
    const Step step = solve(normal);
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
    constexpr double kDelta = 1e-5;
    std::array<MotionTwist, kOfMotion> shifted;
    for (int i = 0; i < kOfMotion; ++i) {
      shifted[static_cast<std::size_t>(i)] = sample.motion;
      component(shifted[static_cast<std::size_t>(i)], i) += kDelta;
    }
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const std::size_t ring = sample.ring[i];
      const Vec3& p = undone_[s][i];
      const Residual r = residual_of(model_, ring, p, settings_.azimuth);
      MotionVector up_by_motion = MotionVector::Zero(), across_by_motion = MotionVector::Zero();
      if (settings_.motion) {
        for (int k = 0; k < kOfMotion; ++k) {
          if (!settings_.azimuth && k == 2) continue;
          const Vec3 q = undo_motion(shifted[static_cast<std::size_t>(k)], sample.moved[i]).point;
          const Residual moved = residual_of(model_, ring, q, settings_.azimuth);
          up_by_motion[k] = (moved.up - r.up) / kDelta;
          across_by_motion[k] = (moved.across - r.across) / kDelta;
        }
      }
      add_up(normal, ring, s, p, r.up, up_by_motion, up_scale);
      if (settings_.azimuth) {
        add_across(normal, ring, s, p, r.across, across_by_motion, across_scale);
      }
    }
  }

  /// Geman and McClure's weight.
  static double weight_of(double residual, double scale) {
    const double x = residual / scale;
    const double w = 1 / (1 + x * x);
    return w * w;
  }

  void add_up(Normal& normal, std::size_t ring, std::size_t scan, const Vec3& p, double residual,
              const MotionVector& by_motion, double scale) const {
    const Beam& beam = model_.beams[ring];
    const double c = std::cos(beam.elevation), s = std::sin(beam.elevation);
    const double u = along(beam, std::hypot(p.x, p.y));
    BeamVector by_beam = BeamVector::Zero();
    by_beam[0] = -(p.z - beam.height_m) * s - u * c;
    by_beam[1] = -c;
    normal.add(ring, scan, by_beam, by_motion, -residual, weight_of(residual, scale));
  }

  void add_across(Normal& normal, std::size_t ring, std::size_t scan, const Vec3& p,
                  double residual, const MotionVector& by_motion, double scale) const {
    const Beam& beam = model_.beams[ring];
    const double distance = std::hypot(p.x, p.y);
    BeamVector by_beam = BeamVector::Zero();
    by_beam[2] = -distance;
    by_beam[3] = -distance / std::max(along(beam, distance), 1e-3);
    // Where half a pitch is not well above the scale, the nearest position may be the wrong one.
    const double half_pitch = std::numbers::pi / model_.slots * distance;
    const double ambiguity = std::min(1.0, half_pitch / (4 * scale));
    normal.add(ring, scan, by_beam, by_motion, -residual,
               weight_of(residual, scale) * ambiguity * ambiguity);
  }

  std::span<ScanSample> samples_;
  BeamModel& model_;
  const RefineSettings& settings_;
  std::vector<std::vector<Vec3>> undone_;
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
