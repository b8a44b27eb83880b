// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/motion_yaw.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kMostYaw = .35, kMostChange = .03;
constexpr double kNoise_m = .0006;  // of a coordinate rounded to millimetres, across a ray
constexpr std::size_t kReturns = 3000;
// A yaw that changes is still alike for returns within this part of the turn from the middle.
constexpr double kMiddle = .2;

/// Where in its step the encoder was at a return, as a wave: a whole turn of `angle` a step.
struct Wave {
  double s = 0, angle = 0, weight = 0;
};

std::vector<Wave> waves_of(const LatticeSample& sample, const BeamModel& model,
                           const MotionTwist& motion) {
  std::vector<Wave> waves;
  const double slots = model.slots;
  const std::size_t stride = std::max<std::size_t>(1, sample.points.size() / kReturns);
  for (std::size_t i = 0; i < sample.points.size(); i += stride) {
    const Unmoved unmoved = undo_motion(motion, sample.points[i]);
    const auto view = view_along(model.beams[sample.rings[i]], unmoved.point);
    if (!view) continue;
    const double blur = kNoise_m / view->distance_m * slots;  // radians
    const double weight = std::exp(-blur * blur);
    if (weight < .1) continue;  // so near that a step is lost in the rounding
    waves.push_back({unmoved.s, (view->encoder + std::numbers::pi) * slots, weight});
  }
  return waves;
}

/// The rate of azimuth, in all steps from -kMostYaw on, at which the waves are most alike.
double scan_rate(const std::vector<Wave>& waves, double slots, double pace) {
  struct Phasor {
    double x, y, cosine, sine;  // where it is, and its turn at every step
  };
  std::vector<Phasor> phasors;
  for (const Wave& wave : waves) {
    const double start = wave.angle + kMostYaw * wave.s * slots, turn = -pace * wave.s * slots;
    phasors.push_back({wave.weight * std::cos(start), wave.weight * std::sin(start), std::cos(turn),
                       std::sin(turn)});
  }
  double best = -1, best_rate = 0;
  const int steps = static_cast<int>(2 * kMostYaw / pace);
  for (int k = 0; k <= steps; ++k) {
    double x = 0, y = 0;
    for (Phasor& phasor : phasors) {
      x += phasor.x;
      y += phasor.y;
      const double turned = phasor.x * phasor.cosine - phasor.y * phasor.sine;
      phasor.y = phasor.x * phasor.sine + phasor.y * phasor.cosine;
      phasor.x = turned;
    }
    if (x * x + y * y > best) {
      best = x * x + y * y;
      best_rate = -kMostYaw + pace * k;
    }
  }
  return best_rate;
}

/// The same for a rate that changes, known about: all changes, and rates beside the given one.
Yaw scan_change(const std::vector<Wave>& waves, double slots, double pace, double rate) {
  constexpr int kRates = 10;  // as many paces as the middle alone leaves open, either way
  Yaw best{rate, 0};
  double most = -1;
  const int changes = static_cast<int>(kMostChange / (2 * pace));
  for (int i = -changes; i <= changes; ++i) {
    for (int k = -kRates; k <= kRates; ++k) {
      const Yaw yaw{rate + k * pace, 2 * i * pace};
      double x = 0, y = 0;
      for (const Wave& wave : waves) {
        const double angle = wave.angle - slots * wave.s * (yaw.turn + wave.s * yaw.turn2);
        x += wave.weight * std::cos(angle);
        y += wave.weight * std::sin(angle);
      }
      if (x * x + y * y <= most) continue;
      most = x * x + y * y;
      best = yaw;
    }
  }
  return best;
}

}  // namespace

Yaw scan_yaw(const LatticeSample& sample, const BeamModel& model, const MotionTwist& motion,
             bool changing) {
  const double slots = model.slots;
  const double pace = 1.2 / slots;  // .6 radians of a wave at most
  std::vector<Wave> waves = waves_of(sample, model, motion);
  Yaw yaw;
  if (changing) {
    std::vector<Wave> middle;
    std::copy_if(waves.begin(), waves.end(), std::back_inserter(middle),
                 [](const Wave& wave) { return std::abs(wave.s) < kMiddle; });
    waves.resize(std::min<std::size_t>(waves.size(), kReturns / 3));
    yaw = scan_change(waves, slots, pace, scan_rate(middle, slots, pace));
  } else {
    yaw.turn = scan_rate(waves, slots, pace);
  }
  // What was found is by the azimuth as it is. The motion goes by the azimuth as it was, which is
  // smaller by what the yaw added.
  const double grown = 1 / (1 - yaw.turn / kTurn);
  return {yaw.turn * grown, yaw.turn2 * grown * grown * grown};
}

}  // namespace curlidar
