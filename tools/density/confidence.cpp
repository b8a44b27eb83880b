// SPDX-License-Identifier: BSD-3-Clause
#include "density/confidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dense/dense_field.hpp"

namespace curlidar::density {
namespace {

constexpr double kRight_m = 0.05;

template <std::size_t kSize>
void add_sample(const std::array<float, kSize>& features, bool right, Samples& samples) {
  samples.values.resize(kSize);
  for (std::size_t i = 0; i < kSize; ++i) samples.values[i].push_back(features[i]);
  samples.wanted.push_back(right ? 1 : 0);
  samples.weight.push_back(1);
}

bool is_right(double told_m, const AskedScan::Place& place) {
  return place.range_m > 0 && std::abs(told_m - place.range_m) <= kRight_m;
}

}  // namespace

void add_answers(const AskedScan& scan, Samples& samples) {
  const DenseField field(scan.field, {});
  for (const AskedScan::Place& place : scan.places) {
    const DenseField::Found found = field.find(place.line);
    if (!(found.guess.r > 0)) continue;
    add_sample(field.features(found), is_right(found.guess.r, place), samples);
  }
}

void add_row_answers(const AskedScan& scan, const std::shared_ptr<const DensityProfile>& profile,
                     Samples& samples) {
  const DenseField field(scan.field, {.profile = profile, .rows_of_profile = true});
  for (const AskedScan::Place& place : scan.places) {
    const DenseField::Found found = field.find(place.line);
    const DenseField::Verdict verdict = field.judge(found);
    if (!verdict.row) continue;
    add_sample(field.features(found, *verdict.row), is_right(verdict.guess.r, place), samples);
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
  std::vector<float> features(samples.values.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t k = 0; k < features.size(); ++k) features[k] = samples.values[k][i];
    calibration.add(probability_of(confidence(features)), samples.wanted[i] > 0);
  }
  return calibration;
}

}  // namespace curlidar::density
