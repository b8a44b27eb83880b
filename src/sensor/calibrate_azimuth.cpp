// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate_azimuth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>

namespace curlidar::calibration {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
/// No beam is further from the spin axis than this.
constexpr double kMostLateral_m = 0.12;
/// Yaw of a turn, two radians a second at ten turns a second. With a yaw of 2 pi x a turn's slots
/// seem to be 1 + x times as many: that 4000 are not 4096 shows only below half of their distance.
constexpr double kMostYaw = 0.2, kMostYawOfUnknown = 0.07;
/// Resultants above this are no chance, of a hundred returns or more.
constexpr double kLeastResultant = 0.35;
/// Beams with fewer returns say nothing.
constexpr std::size_t kFewest = 24;
/// Enough returns of a beam for a search over all lateral offsets.
constexpr std::size_t kFew = 300;
/// Resultants above this leave no doubt.
constexpr double kClearResultant = 0.6;
/// With finer encoders the search for the yaw leaves lateral offsets out: it would take too long.
constexpr std::uint32_t kMostSlotsForBoth = 8192;

/// Returns of one beam: azimuth from the encoder's position 0, 1 / distance, weight.
struct Arc {
  std::vector<double> azimuth, inverse, weight;
  std::size_t size() const { return azimuth.size(); }
};

/// Far returns tell more about angles, up to where the beam is wider than its place.
double weight_of(double distance) {
  return std::min(distance, 20.0);
}

/// A return, and what azimuth it has if the motion had another yaw.
class Turned {
 public:
  Turned(const MotionTwist& motion, const Vec3& moved) : yaw_(motion.turn.z) {
    const Unmoved unmoved = undo_motion(motion, moved);
    const Vec3& p = unmoved.point;
    distance_ = std::hypot(p.x, p.y);
    s_ = unmoved.s;
    // The azimuth decides how much of the motion is undone, and that moves the azimuth.
    const Vec3 by_s = point_by_turn(motion, p, s_);
    stiffness_ = kTurn - (p.x * by_s.y - p.y * by_s.x) / (distance_ * distance_);
  }

  double distance() const { return distance_; }
  /// First order in the displacement that changes with s, exact in the rotation.
  double azimuth(double yaw) const { return kTurn * s_ * stiffness_ / (stiffness_ + yaw - yaw_); }

 private:
  double yaw_, distance_, s_, stiffness_;
};

void append(Arc& arc, const Turned& point, double yaw) {
  arc.azimuth.push_back(point.azimuth(yaw) + std::numbers::pi);
  arc.inverse.push_back(1 / point.distance());
  arc.weight.push_back(weight_of(point.distance()));
}

/// The step of lateral offsets that turns the phase of a near return by half a radian.
double lateral_step(const Arc& arc, std::uint32_t slots) {
  std::vector<double> inverse = arc.inverse;
  const auto near = inverse.begin() + static_cast<std::ptrdiff_t>(inverse.size() * 9 / 10);
  std::nth_element(inverse.begin(), near, inverse.end());
  return std::clamp(0.5 / (slots * *near), 1e-5, 0.01);
}

/// About `count` of the returns.
Arc every(const Arc& arc, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, arc.size() / count);
  Arc out;
  for (std::size_t i = 0; i < arc.size(); i += stride) {
    out.azimuth.push_back(arc.azimuth[i]);
    out.inverse.push_back(arc.inverse[i]);
    out.weight.push_back(arc.weight[i]);
  }
  return out;
}

struct Lattice {
  double resultant = 0, lateral = 0, offset = 0;
};

/// The best of lateral offsets from -most to most.
Lattice scan_laterals(const Arc& arc, std::uint32_t slots, double middle, double most,
                      double step) {
  const std::size_t n = arc.size();
  const auto half = static_cast<int>(std::ceil(most / step));
  std::vector<std::complex<double>> phase(n), turn(n);
  double total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double first = middle - half * step;
    phase[i] = std::polar(arc.weight[i], slots * (arc.azimuth[i] - first * arc.inverse[i]));
    turn[i] = std::polar(1.0, -static_cast<double>(slots) * step * arc.inverse[i]);
    total += arc.weight[i];
  }
  Lattice best;
  for (int k = -half; k <= half; ++k) {
    double real = 0, imaginary = 0;
    for (std::size_t i = 0; i < n; ++i) {
      real += phase[i].real();
      imaginary += phase[i].imag();
      const double re = phase[i].real() * turn[i].real() - phase[i].imag() * turn[i].imag();
      const double im = phase[i].real() * turn[i].imag() + phase[i].imag() * turn[i].real();
      phase[i] = {re, im};
    }
    const double resultant = std::hypot(real, imaginary) / total;
    if (resultant > best.resultant) {
      best = {resultant, middle + k * step, std::atan2(imaginary, real) / slots};
    }
  }
  return best;
}

/// Returns of the beams that see most, thinned, and where they are with any yaw.
class Probe {
 public:
  Probe(const ScanSample& sample, std::size_t rings, std::size_t beams, std::size_t returns) {
    std::vector<std::size_t> count(rings, 0), order(rings), place(rings, rings);
    for (const std::uint16_t ring : sample.ring) ++count[ring];
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
    beams_.resize(std::min(beams, rings));
    for (std::size_t i = 0; i < beams_.size(); ++i) place[order[i]] = i;
    std::vector<std::size_t> seen(rings, 0);
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const std::size_t ring = sample.ring[i];
      if (place[ring] == rings) continue;
      const std::size_t stride = std::max<std::size_t>(1, count[ring] / returns);
      if (seen[ring]++ % stride == 0) {
        beams_[place[ring]].emplace_back(sample.motion, sample.moved[i]);
      }
    }
    std::erase_if(beams_, [](const auto& beam) { return beam.size() < kFewest; });
  }

  bool empty() const { return beams_.empty(); }

  std::vector<Arc> arcs(double yaw) const {
    std::vector<Arc> out(beams_.size());
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      for (const Turned& point : beams_[i]) append(out[i], point, yaw);
    }
    return out;
  }

 private:
  std::vector<std::vector<Turned>> beams_;
};

/// Steps of azimuth between near neighbours of a beam, which neither the yaw of a motion nor the
/// lateral offset of a beam changes much.
class StepProbe {
 public:
  StepProbe(const ScanSample& sample, std::size_t rings) {
    std::vector<std::vector<std::pair<double, double>>> beams(rings);  // azimuth, distance
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const Vec3 p = undo(sample.motion, sample.moved[i]);
      beams[sample.ring[i]].emplace_back(azimuth_of(p), std::hypot(p.x, p.y));
    }
    for (auto& beam : beams) {
      std::sort(beam.begin(), beam.end());
      for (std::size_t i = 0; i < beam.size(); ++i) add_steps(beam, i);
    }
  }

  double resultant(std::uint32_t slots) const {
    std::complex<double> sum = 0;
    for (const double step : steps_) sum += std::polar(1.0, slots * step);
    return std::abs(sum) / static_cast<double>(std::max<std::size_t>(1, steps_.size()));
  }

 private:
  void add_steps(const std::vector<std::pair<double, double>>& beam, std::size_t i) {
    constexpr std::size_t kNeighbours = 4;
    constexpr double kWidest = 0.03, kNear_m = 4, kAlike = 0.02;
    for (std::size_t j = i + 1; j < std::min(beam.size(), i + 1 + kNeighbours); ++j) {
      const auto [azimuth, distance] = beam[i];
      const double step = beam[j].first - azimuth;
      if (distance < kNear_m || step > kWidest) continue;
      if (std::abs(beam[j].second - distance) < kAlike * distance) steps_.push_back(step);
    }
  }

  std::vector<double> steps_;
};

/// The candidates, those first whose multiples the steps are.
std::vector<std::uint32_t> by_steps(const StepProbe& probe,
                                    std::span<const std::uint32_t> candidates) {
  std::vector<std::pair<double, std::uint32_t>> scored;
  for (const std::uint32_t slots : candidates) scored.emplace_back(probe.resultant(slots), slots);
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::uint32_t> out;
  for (const auto& [resultant, slots] : scored) out.push_back(slots);
  return out;
}

/// Mean of the best resultants of the beams.
double mean_resultant(const std::vector<Arc>& arcs, std::uint32_t slots, double most_lateral) {
  double sum = 0;
  for (const Arc& arc : arcs) {
    sum += scan_laterals(arc, slots, 0, most_lateral, lateral_step(arc, slots)).resultant;
  }
  return sum / static_cast<double>(arcs.size());
}

/// The yaw with the best resultant, first coarse, then ever finer.
template <class Score>
Encoder scan_yaws(std::uint32_t slots, double most, const Score& score) {
  // A step turns the phase of a return half a turn away by one radian.
  double step = 2.0 / slots;
  Encoder best{slots, 0, 0};
  double middle = 0;
  auto half = static_cast<int>(std::ceil(most / step));
  for (int level = 0; level < 4; ++level) {
    for (int k = -half; k <= half; ++k) {
      const double yaw = middle + k * step;
      const double resultant = score(yaw);
      if (resultant > best.resultant) best = {slots, yaw, resultant};
    }
    middle = best.yaw;
    step /= 4;
    half = 4;
  }
  return best;
}

/// Offsets that are about the same belong on one side of half a pitch.
void gather_offsets(BeamModel& model) {
  std::complex<double> sum = 0;
  for (const Beam& beam : model.beams) sum += std::polar(1.0, model.slots * beam.azimuth_offset);
  if (std::abs(sum) < 0.5 * static_cast<double>(model.beams.size())) return;
  const double middle = std::arg(sum) / model.slots;
  for (Beam& beam : model.beams) {
    beam.azimuth_offset =
        middle + std::remainder(beam.azimuth_offset - middle, kTurn / model.slots);
  }
}

}  // namespace

std::vector<std::uint32_t> slot_candidates(std::span<const std::uint32_t> hints) {
  std::vector<std::uint32_t> out{512,  600,  720,  900,  1024,  1200,  1440,  1500, 1800,
                                 2000, 2048, 2400, 3000, 3600,  4000,  4096,  4800, 6000,
                                 7200, 8000, 8192, 9000, 12000, 14400, 18000, 36000};
  for (const std::uint32_t hint : hints) {
    if (hint >= 64 && hint <= 72000) out.push_back(hint);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::optional<Encoder> find_encoder(const ScanSample& sample, std::size_t rings,
                                    std::span<const std::uint32_t> candidates, bool search_yaw) {
  const Probe probe = search_yaw ? Probe(sample, rings, 5, 240) : Probe(sample, rings, 8, 400);
  if (probe.empty()) return std::nullopt;
  std::vector<std::uint32_t> order(candidates.begin(), candidates.end());
  Encoder best{0, sample.motion.turn.z, 0};
  if (search_yaw) {
    order = by_steps(StepProbe(sample, rings), order);
    const double most_yaw = candidates.size() == 1 ? kMostYaw : kMostYawOfUnknown;
    for (const std::uint32_t slots : order) {
      const double most_lateral = slots <= kMostSlotsForBoth ? kMostLateral_m / 2 : 0;
      const Encoder found = scan_yaws(slots, most_yaw, [&](double yaw) {
        return mean_resultant(probe.arcs(yaw), slots, most_lateral);
      });
      if (found.resultant > best.resultant) best = found;
      if (best.resultant > kClearResultant) break;
    }
    // A multiple of the encoder may have come first: it is among the divisors tried below.
    std::erase_if(order,
                  [&](std::uint32_t slots) { return best.slots == 0 || best.slots % slots != 0; });
  }
  std::sort(order.begin(), order.end());
  const std::vector<Arc> arcs = probe.arcs(best.yaw);
  Encoder chosen{0, best.yaw, 0};
  for (const std::uint32_t slots : order) {
    const double resultant = mean_resultant(arcs, slots, kMostLateral_m);
    // Multiples of an encoder explain as much as itself: they must explain more.
    const double least = chosen.resultant > kLeastResultant ? 0.02 : 0;
    if (resultant > chosen.resultant + least) chosen = {slots, best.yaw, resultant};
    if (chosen.resultant > 0.999) break;
  }
  if (chosen.resultant < kLeastResultant) return std::nullopt;
  return chosen;
}

std::optional<Encoder> find_yaw(const ScanSample& sample, const BeamModel& model) {
  const std::size_t stride = std::max<std::size_t>(1, sample.size() / 2000);
  std::vector<std::pair<Turned, double>> points;  // and the offset of its beam from the encoder
  for (std::size_t i = 0; i < sample.size(); i += stride) {
    const Beam& beam = model.beams[sample.ring[i]];
    const Turned point(sample.motion, sample.moved[i]);
    points.emplace_back(point, beam.lateral_m / point.distance() + beam.azimuth_offset);
  }
  const Encoder best = scan_yaws(model.slots, kMostYaw, [&](double yaw) {
    std::complex<double> sum = 0;
    double total = 0;
    for (const auto& [point, offset] : points) {
      const double weight = weight_of(point.distance());
      sum += std::polar(weight, model.slots * (point.azimuth(yaw) - offset));
      total += weight;
    }
    return std::abs(sum) / std::max(total, 1e-9);
  });
  if (best.resultant < kLeastResultant) return std::nullopt;
  return best;
}

void start_azimuths(const ScanSample& sample, BeamModel& model) {
  std::vector<Arc> arcs(model.beams.size());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    append(arcs[sample.ring[i]], {sample.motion, sample.moved[i]}, sample.motion.turn.z);
  }
  for (std::size_t ring = 0; ring < arcs.size(); ++ring) {
    const Arc& arc = arcs[ring];
    if (arc.size() < kFewest) continue;
    const double step = lateral_step(arc, model.slots);
    Lattice found = scan_laterals(every(arc, kFew), model.slots, 0, kMostLateral_m, step);
    found = scan_laterals(arc, model.slots, found.lateral, 2 * step, step / 8);
    model.beams[ring].lateral_m = found.lateral;
    model.beams[ring].azimuth_offset = found.offset;
  }
  gather_offsets(model);
}

}  // namespace curlidar::calibration
