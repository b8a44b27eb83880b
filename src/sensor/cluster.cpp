// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/cluster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "curlidar/sensor.hpp"
#include "sensor/angles.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kBins = 8192;

/// Three passes of a running mean over 2 radius + 1 bins: nearly a Gaussian.
std::vector<double> smoothed(std::vector<double> values, std::size_t radius) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (int pass = 0; pass < 3; ++pass) {
    for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t from = i > radius ? i - radius : 0;
      const std::size_t to = std::min(values.size(), i + radius + 1);
      values[i] = (sums[to] - sums[from]) / static_cast<double>(2 * radius + 1);
    }
  }
  return values;
}

/// Bins that part the crowds of a histogram: between two peaks it falls below half of either.
std::vector<std::size_t> valleys(const std::vector<double>& density, double floor) {
  std::vector<std::size_t> cuts;
  bool climbing = true;
  double peak = 0, lowest = 0;
  std::size_t first = 0, last = 0;  // bins of the lowest density since the peak
  for (std::size_t i = 0; i < density.size(); ++i) {
    const double d = density[i];
    if (climbing) {
      peak = std::max(peak, d);
      if (peak > floor && d < peak / 2) {
        climbing = false;
        lowest = d;
        first = last = i;
      }
      continue;
    }
    if (d < lowest) {
      lowest = d;
      first = last = i;
    } else if (d == lowest && last + 1 == i) {
      last = i;
    }
    if (d > floor && d > 2 * lowest) {
      cuts.push_back((first + last + 1) / 2);
      climbing = true;
      peak = d;
    }
  }
  return cuts;
}

/// The histogram of elevations, with the elevations themselves sorted by bin.
struct Histogram {
  double lowest = 0, step = 0;
  std::vector<double> counts;
  std::vector<std::size_t> starts;  ///< of each bin in `sorted`
  std::vector<double> sorted;

  std::size_t bin(double elevation) const {
    return std::min(kBins - 1, static_cast<std::size_t>((elevation - lowest) / step));
  }
};

Histogram make_histogram(const std::vector<double>& elevations) {
  const auto [low, high] = std::minmax_element(elevations.begin(), elevations.end());
  Histogram h{*low, (*high - *low) / static_cast<double>(kBins), std::vector<double>(kBins, 0.0),
              std::vector<std::size_t>(kBins + 1, 0), std::vector<double>(elevations.size())};
  for (const double e : elevations) ++h.starts[h.bin(e) + 1];
  for (std::size_t i = 0; i < kBins; ++i) {
    h.counts[i] = static_cast<double>(h.starts[i + 1]);
    h.starts[i + 1] += h.starts[i];
  }
  std::vector<std::size_t> next(h.starts.begin(), h.starts.end() - 1);
  for (const double e : elevations) h.sorted[next[h.bin(e)]++] = e;
  return h;
}

/// Medians of the crowds between the cuts, ascending; crowds of a few strays do not count.
std::vector<double> crowd_centres(const Histogram& h, const std::vector<std::size_t>& cuts) {
  std::vector<std::pair<std::size_t, double>> crowds;
  std::vector<double> sizes, values;
  for (std::size_t k = 0; k <= cuts.size(); ++k) {
    const std::size_t from = h.starts[k == 0 ? 0 : cuts[k - 1]];
    const std::size_t to = h.starts[k == cuts.size() ? kBins : cuts[k]];
    if (from == to) continue;
    values.assign(h.sorted.begin() + static_cast<std::ptrdiff_t>(from),
                  h.sorted.begin() + static_cast<std::ptrdiff_t>(to));
    crowds.emplace_back(to - from, median(values));
    sizes.push_back(static_cast<double>(to - from));
  }
  const double usual = median(sizes);
  std::vector<double> centres;
  for (const auto& [size, centre] : crowds) {
    if (static_cast<double>(size) >= std::max(4.0, usual / 100)) centres.push_back(centre);
  }
  return centres;
}

/// Median distance to the nearest centre as a share of half the gap there: 0.5 without crowds.
double looseness(const Histogram& h, const std::vector<double>& centres) {
  std::vector<double> shares;
  shares.reserve(h.sorted.size());
  std::size_t next = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const double middle = h.lowest + (static_cast<double>(bin) + 0.5) * h.step;
    while (next < centres.size() && centres[next] < middle) ++next;
    const double above =
        next < centres.size() ? centres[next] : std::numeric_limits<double>::infinity();
    const double below = next > 0 ? centres[next - 1] : -std::numeric_limits<double>::infinity();
    double gap = above - below;
    if (!std::isfinite(gap)) {
      gap = next == 0 ? centres[1] - centres[0] : centres[next - 1] - centres[next - 2];
    }
    for (std::size_t i = h.starts[bin]; i < h.starts[bin + 1]; ++i) {
      const double distance = std::min(above - h.sorted[i], h.sorted[i] - below);
      shares.push_back(std::abs(distance) / (gap / 2));
    }
  }
  return median(shares);
}

std::vector<double> cluster(const std::vector<double>& elevations) {
  const Histogram h = make_histogram(elevations);
  const double mean = static_cast<double>(elevations.size()) / static_cast<double>(kBins);
  std::vector<double> best;
  double best_looseness = 0.25;
  for (std::size_t radius = 1; radius <= 64; radius *= 2) {
    const std::vector<double> centres =
        crowd_centres(h, valleys(smoothed(h.counts, radius), mean / 4));
    if (centres.size() < 2 || centres.size() > kMaxRings) continue;
    if (elevations.size() < 20 * centres.size()) continue;
    const double loose = looseness(h, centres);
    if (loose < best_looseness) {
      best_looseness = loose;
      best = centres;
    }
  }
  std::reverse(best.begin(), best.end());
  return best;
}

}  // namespace

std::vector<double> cluster_elevations(const Returns& returns) {
  const std::vector<double>& all = returns.elevation;
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  if (*high - *low < 0.3 * kRadiansPerDegree) {
    std::vector<double> values(all);
    return {median(values)};
  }
  // Beams that do not start at the origin blur the clusters of near returns; but some beams may
  // have near returns only.
  if (std::vector<double> centres = cluster(all); !centres.empty()) return centres;
  std::vector<double> far;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (returns.is_far(i)) far.push_back(all[i]);
  }
  const auto [far_low, far_high] = std::minmax_element(far.begin(), far.end());
  return *far_high > *far_low ? cluster(far) : std::vector<double>();
}

}  // namespace curlidar
