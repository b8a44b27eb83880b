// SPDX-License-Identifier: BSD-3-Clause
#include "density/confidence.hpp"

#include <algorithm>
#include <cmath>

#include "dense/features.hpp"

namespace curlidar::density {
namespace {

constexpr double kRight_m = 0.05;

PlaneLine line_to(const Vec3& direction) {
  return {azimuth_of(direction), {0, 0}, {std::hypot(direction.x, direction.y), direction.z}};
}

}  // namespace

void add_answers(const AskedScan& scan, Samples& samples) {
  const RingPoints points(*scan.field);
  const ScanErrors errors = errors_of(points, *scan.field);
  samples.values.resize(kPlainFeatures);
  for (const AskedScan::Place& place : scan.places) {
    const Look look = look_along(points, line_to(place.direction));
    const Guess guess = decide(points, look);
    if (!(guess.r > 0)) continue;
    const PlainFeatures features = plain_features(points, look, guess, errors);
    for (std::size_t i = 0; i < features.size(); ++i) samples.values[i].push_back(features[i]);
    const bool right = place.range_m > 0 && std::abs(guess.r - place.range_m) <= kRight_m;
    samples.wanted.push_back(right ? 1 : 0);
    samples.weight.push_back(1);
  }
}

void Calibration::add(double said_probability, bool was_right) {
  const auto bin = static_cast<std::size_t>(
      std::clamp(said_probability * kBins, 0.0, static_cast<double>(kBins) - 0.5));
  said[bin] += said_probability;
  right[bin] += was_right ? 1 : 0;
  count[bin] += 1;
}

double Calibration::worst(double least) const {
  double worst = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (count[bin] < least) continue;
    worst = std::max(worst, std::abs(said[bin] - right[bin]) / count[bin]);
  }
  return worst;
}

Calibration check(const ObliviousTrees& confidence, const Samples& samples) {
  Calibration calibration;
  PlainFeatures features{};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t k = 0; k < features.size(); ++k) features[k] = samples.values[k][i];
    calibration.add(probability_of(confidence(features)), samples.wanted[i] > 0);
  }
  return calibration;
}

}  // namespace curlidar::density
