// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate_shifts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace curlidar::calibration {
namespace {

/// Lasers of a sensor look to azimuths that differ by less than this share of a turn.
constexpr double kMostShift = 1.0 / 12;
/// Scans that take part; more would only take longer.
constexpr std::size_t kMostScans = 3;

/// Encoder positions of the returns of one scan: [ring][position] marks, and each return's.
struct Positions {
  std::vector<std::vector<std::uint32_t>> of_ring;
  std::vector<std::int64_t> of_return;
};

Positions positions_of(const ScanSample& sample, const BeamModel& model) {
  Positions out;
  out.of_ring.resize(model.beams.size());
  const double pitch = 2 * std::numbers::pi / model.slots;
  std::vector<std::vector<std::uint8_t>> marked(model.beams.size(),
                                                std::vector<std::uint8_t>(model.slots, 0));
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const std::size_t ring = sample.ring[i];
    const Beam& beam = model.beams[ring];
    const Vec3 p = undo(sample.motion, sample.moved[i]);
    const double distance = std::hypot(p.x, p.y);
    const double sine = std::clamp(beam.lateral_m / distance, -1.0, 1.0);
    const double encoder =
        wrapped(azimuth_of(p) - std::asin(sine) - beam.azimuth_offset) + std::numbers::pi;
    const std::int64_t position = std::llround(encoder / pitch) % model.slots;
    out.of_return.push_back(position);
    if (marked[ring][static_cast<std::size_t>(position)] != 0) continue;
    marked[ring][static_cast<std::size_t>(position)] = 1;
    out.of_ring[ring].push_back(static_cast<std::uint32_t>(position));
  }
  return out;
}

/// What the columns of an organised cloud say: shift of each ring in positions; nothing if columns
/// are not positions.
std::optional<std::vector<std::int64_t>> shifts_from_columns(const ScanSample& sample,
                                                             const Positions& positions,
                                                             std::size_t rings,
                                                             std::uint32_t slots) {
  if (sample.columns != slots) return std::nullopt;
  std::optional<std::vector<std::int64_t>> found;
  for (const int direction : {-1, 1}) {
    std::vector<std::vector<std::uint32_t>> votes(rings, std::vector<std::uint32_t>(slots, 0));
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const std::int64_t column = direction * static_cast<std::int64_t>(sample.column[i]);
      const std::int64_t shift =
          (positions.of_return[i] - column + 2 * std::int64_t{slots}) % slots;
      ++votes[sample.ring[i]][static_cast<std::size_t>(shift)];
    }
    std::vector<std::int64_t> shifts;
    std::size_t agreeing = 0;
    for (const auto& ring : votes) {
      const auto most = std::max_element(ring.begin(), ring.end());
      agreeing += *most;
      shifts.push_back(most - ring.begin());
    }
    if (static_cast<double>(agreeing) > 0.9 * static_cast<double>(sample.size())) found = shifts;
  }
  if (!found) return std::nullopt;
  // The encoder's own zero is free: the first beam with returns keeps its offset near 0.
  for (std::size_t ring = 0; ring < rings; ++ring) {
    if (positions.of_ring[ring].empty()) continue;
    const std::int64_t zero = (*found)[ring];
    for (std::int64_t& shift : *found) {
      shift = (shift - zero + slots) % slots;
      if (shift > slots / 2) shift -= slots;
    }
    break;
  }
  return found;
}

/// How many returns are at positions where others fired, by the shift of their ring.
class Alignment {
 public:
  Alignment(std::span<const Positions> scans, std::uint32_t slots) : scans_(scans), slots_(slots) {
    const auto most = static_cast<std::int64_t>(slots * kMostShift);
    std::vector<std::int64_t> all;
    for (std::int64_t shift = -most; shift <= most; ++shift) all.push_back(shift);
    candidates_.assign(scans.front().of_ring.size(), all);
  }

  std::vector<std::int64_t> solve() {
    const std::size_t rings = scans_.front().of_ring.size();
    std::vector<std::int64_t> shifts(rings, 0);
    std::size_t first = 0;
    for (std::size_t ring = 1; ring < rings; ++ring) {
      if (count(ring) > count(first)) first = ring;
    }
    // Against the fullest beam first, then against all others.
    for (int round = 0; round < 3; ++round) {
      fired_.assign(scans_.size(), std::vector<std::uint8_t>(slots_, 0));
      for (std::size_t ring = 0; ring < rings; ++ring) {
        if (round > 0 || ring == first) mark(ring, shifts[ring]);
      }
      for (auto& scan : fired_) {
        for (std::uint8_t& mark : scan) mark = mark >= (round > 0 ? threshold(rings) : 1) ? 1 : 0;
      }
      for (std::size_t ring = 0; ring < rings; ++ring) {
        if (ring != first) shifts[ring] = best_shift(ring);
      }
    }
    return shifts;
  }

 private:
  static std::uint8_t threshold(std::size_t rings) {
    return static_cast<std::uint8_t>(std::clamp<std::size_t>(rings / 5, 1, 12));
  }
  std::size_t count(std::size_t ring) const {
    std::size_t sum = 0;
    for (const Positions& scan : scans_) sum += scan.of_ring[ring].size();
    return sum;
  }
  std::size_t wrap(std::int64_t position) const {
    const std::int64_t slots = slots_;
    return static_cast<std::size_t>((position % slots + slots) % slots);
  }
  void mark(std::size_t ring, std::int64_t shift) {
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      for (const std::uint32_t position : scans_[s].of_ring[ring]) {
        std::uint8_t& mark = fired_[s][wrap(position - shift)];
        if (mark < 255) ++mark;
      }
    }
  }
  /// The best of the ring's candidates, of which only good ones are kept; 0 where that does about
  /// as well, as when lasers fire at every position.
  std::int64_t best_shift(std::size_t ring) {
    const std::size_t total = count(ring);
    if (total == 0) return 0;
    std::vector<std::pair<std::size_t, std::int64_t>> scored;
    for (const std::int64_t shift : candidates_[ring]) {
      scored.emplace_back(hits_at(ring, shift), shift);
    }
    std::size_t best = hits_at(ring, 0) + total / 50;
    std::int64_t chosen = 0;
    for (const auto& [hits, shift] : scored) {
      if (hits <= best) continue;
      best = hits;
      chosen = shift;
    }
    candidates_[ring].clear();
    for (const auto& [hits, shift] : scored) {
      if (5 * hits >= 4 * best) candidates_[ring].push_back(shift);
    }
    return chosen;
  }
  std::size_t hits_at(std::size_t ring, std::int64_t shift) const {
    std::size_t sum = 0;
    const auto lift = static_cast<std::uint32_t>(wrap(-shift));
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      const std::uint8_t* fired = fired_[s].data();
      for (const std::uint32_t position : scans_[s].of_ring[ring]) {
        const std::uint32_t at = position + lift;
        sum += fired[at >= slots_ ? at - slots_ : at];
      }
    }
    return sum;
  }

  std::span<const Positions> scans_;
  std::uint32_t slots_;
  std::vector<std::vector<std::int64_t>> candidates_;  // [ring]
  std::vector<std::vector<std::uint8_t>> fired_;       // [scan][position]
};

}  // namespace

void align_firings(std::span<const ScanSample> samples, BeamModel& model) {
  std::vector<Positions> positions;
  for (const ScanSample& sample : samples.first(std::min(samples.size(), kMostScans))) {
    positions.push_back(positions_of(sample, model));
  }
  auto shifts =
      shifts_from_columns(samples.front(), positions.front(), model.beams.size(), model.slots);
  if (!shifts) shifts = Alignment(positions, model.slots).solve();
  const double pitch = 2 * std::numbers::pi / model.slots;
  for (std::size_t ring = 0; ring < model.beams.size(); ++ring) {
    Beam& beam = model.beams[ring];
    beam.azimuth_offset += static_cast<double>((*shifts)[ring]) * pitch;
  }
}

}  // namespace curlidar::calibration
