// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sensor/returns.hpp"

namespace curlidar::calibration {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
/// Units of sensors known to us, metres, the largest first.
constexpr std::array<double, 11> kUnits{0.01,   0.008, 0.005, 0.004,  0.0039, 0.003,
                                        0.0025, 0.002, 0.001, 0.0005, 0.00025};
/// Resultants of fewer returns than this say little.
constexpr std::size_t kFewest = 40;
constexpr double kLeastResultant = 0.3;

/// Ranges along each beam, without phase.
std::vector<std::vector<double>> ranges_of(std::span<const ScanSample> samples,
                                           const BeamModel& model) {
  std::vector<std::vector<double>> out(model.beams.size());
  for (const ScanSample& sample : samples) {
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const Vec3 p = undo(sample.motion, sample.moved[i]);
      const Beam& beam = model.beams[sample.ring[i]];
      const double square = p.x * p.x + p.y * p.y - beam.lateral_m * beam.lateral_m;
      const double u = std::sqrt(std::max(0.0, square));
      out[sample.ring[i]].push_back(u * std::cos(beam.elevation) +
                                    (p.z - beam.height_m) * std::sin(beam.elevation));
    }
  }
  return out;
}

std::complex<double> resultant_of(const std::vector<double>& ranges, double unit) {
  std::complex<double> sum = 0;
  for (const double range : ranges)
    sum += std::polar(1.0, kTurn * std::remainder(range, unit) / unit);
  return sum / static_cast<double>(ranges.size());
}

/// Median over beams, what chance adds taken off.
double score(const std::vector<std::vector<double>>& ranges, double unit) {
  std::vector<double> all;
  for (const std::vector<double>& beam : ranges) {
    if (beam.size() < kFewest) continue;
    const double square = std::norm(resultant_of(beam, unit));
    all.push_back(std::sqrt(std::max(0.0, square - 1.0 / static_cast<double>(beam.size()))));
  }
  return all.empty() ? 0 : median(all);
}

/// The phase that the ranges share: that of their resultant, then the mean of those around it,
/// which returns of another beam do not reach.
double phase_of(const std::vector<double>& ranges, double unit) {
  double phase = std::arg(resultant_of(ranges, unit)) / kTurn * unit;
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> off, size;
    for (const double range : ranges) off.push_back(std::remainder(range - phase, unit));
    for (const double o : off) size.push_back(std::abs(o));
    const double near = 3 * median(size);
    double sum = 0, count = 0;
    for (const double o : off) {
      if (std::abs(o) > near) continue;
      sum += o;
      count += 1;
    }
    if (count > 0) phase += sum / count;
  }
  return std::remainder(phase, unit);
}

}  // namespace

double find_range_unit(std::span<const ScanSample> samples, BeamModel& model) {
  const std::vector<std::vector<double>> ranges = ranges_of(samples, model);
  model.range_unit_m = 0;
  for (Beam& beam : model.beams) beam.range_phase_m = 0;
  std::array<double, kUnits.size()> scores{};
  for (std::size_t i = 0; i < kUnits.size(); ++i) scores[i] = score(ranges, kUnits[i]);
  const double best = *std::max_element(scores.begin(), scores.end());
  if (best < kLeastResultant) return 0;
  const auto chosen =
      std::find_if(scores.begin(), scores.end(), [&](double s) { return s > 0.95 * best; });
  const double unit = kUnits[static_cast<std::size_t>(chosen - scores.begin())];
  model.range_unit_m = unit;
  for (std::size_t ring = 0; ring < ranges.size(); ++ring) {
    if (!ranges[ring].empty()) model.beams[ring].range_phase_m = phase_of(ranges[ring], unit);
  }
  return *chosen;
}

}  // namespace curlidar::calibration
