// SPDX-License-Identifier: BSD-3-Clause
#include "density/boost.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/parallel.hpp"

namespace curlidar::density {
namespace {

constexpr double kLeastCurvature = 1e-3;
constexpr double kLeafSpan = 8000;  ///< the largest leaf in units

/// Cuts between `levels` about equally frequent kinds of values.
std::vector<float> quantile_cuts(std::vector<float> values, std::size_t levels) {
  std::sort(values.begin(), values.end());
  std::vector<float> cuts;
  for (std::size_t i = 1; i < levels; ++i) {
    const float cut = values[values.size() * i / levels];
    const bool told_apart = cut < values.back() && (cuts.empty() || cut > cuts.back());
    if (std::isfinite(cut) && told_apart) cuts.push_back(cut);
  }
  return cuts;
}

double weighted_median(std::vector<std::pair<float, float>>& values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  double whole = 0, below = 0;
  for (const auto& [value, weight] : values) whole += weight;
  for (const auto& [value, weight] : values) {
    below += weight;
    if (below >= whole / 2) return value;
  }
  return values.back().first;
}

class Booster {
 public:
  Booster(const Samples& samples, const BoostSettings& settings, std::size_t threads)
      : samples_(samples), settings_(settings), threads_(threads) {
    trees_.depth = settings.depth;
    trees_.cuts.resize(samples.values.size());
    levels_.resize(samples.values.size());
    parallel_for(levels_.size(), threads_, [&](std::size_t feature) { quantise(feature); });
    trees_.base = start();
    said_.assign(samples.size(), static_cast<float>(trees_.base));
    pull_.resize(samples.size());
    curvature_.resize(samples.size());
    leaf_.resize(samples.size());
  }

  ObliviousTrees run() {
    for (std::size_t tree = 0; tree < settings_.trees; ++tree) {
      take_gradients();
      std::fill(leaf_.begin(), leaf_.end(), std::uint8_t{0});
      for (std::size_t i = 0; i < settings_.depth; ++i) add_split(i);
      add_leaves();
    }
    round_leaves();
    forget_unasked();
    return trees_;
  }

 private:
  void quantise(std::size_t feature) {
    const std::vector<float>& values = samples_.values[feature];
    std::vector<float>& cuts = trees_.cuts[feature];
    cuts = quantile_cuts(values, settings_.levels);
    levels_[feature].resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto above = std::partition_point(cuts.begin(), cuts.end(),
                                              [&](float cut) { return values[i] > cut; });
      levels_[feature][i] = static_cast<std::uint8_t>(above - cuts.begin());
    }
  }

  /// The best constant.
  double start() const {
    if (settings_.loss == Loss::absolute) {
      std::vector<std::pair<float, float>> values;
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        values.emplace_back(samples_.wanted[i], samples_.weight[i]);
      }
      return weighted_median(values);
    }
    double ones = 0, all = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      ones += double{samples_.weight[i]} * samples_.wanted[i];
      all += samples_.weight[i];
    }
    const double share = std::clamp(ones / all, 1e-6, 1 - 1e-6);
    return std::log(share / (1 - share));
  }

  void take_gradients() {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double wanted = samples_.wanted[i], weight = samples_.weight[i];
      double pull = 0, curvature = 1;
      if (settings_.loss == Loss::logistic) {
        const double p = probability_of(said_[i]);
        pull = wanted - p;
        curvature = std::max(p * (1 - p), kLeastCurvature);
      } else {
        pull = wanted > said_[i] ? 1 : wanted < said_[i] ? -1 : 0;
      }
      pull_[i] = static_cast<float>(weight * pull);
      curvature_[i] = static_cast<float>(weight * curvature);
    }
  }

  /// What every level of a feature would gain as the next split, all leaves together.
  std::vector<double> gains(std::size_t feature, std::size_t leaves) const {
    struct Sum {
      double pull = 0, curvature = 0;
      double worth(double damping) const { return pull * pull / (curvature + damping); }
    };
    const std::size_t levels = trees_.cuts[feature].size() + 1;
    std::vector<Sum> sums(leaves * levels);
    for (std::size_t i = 0; i < leaf_.size(); ++i) {
      Sum& sum = sums[leaf_[i] * levels + levels_[feature][i]];
      sum.pull += pull_[i];
      sum.curvature += curvature_[i];
    }
    std::vector<double> gain(levels - 1, 0);
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      const auto begin = sums.begin() + static_cast<std::ptrdiff_t>(leaf * levels);
      Sum above, below;
      for (std::size_t level = 0; level < levels; ++level) {
        above.pull += begin[static_cast<std::ptrdiff_t>(level)].pull;
        above.curvature += begin[static_cast<std::ptrdiff_t>(level)].curvature;
      }
      for (std::size_t level = 0; level + 1 < levels; ++level) {
        const Sum& moved = begin[static_cast<std::ptrdiff_t>(level)];
        below.pull += moved.pull, above.pull -= moved.pull;
        below.curvature += moved.curvature, above.curvature -= moved.curvature;
        gain[level] += below.worth(settings_.damping) + above.worth(settings_.damping);
      }
    }
    return gain;
  }

  void add_split(std::size_t place) {
    std::vector<std::pair<double, std::size_t>> best(levels_.size(), {-1, 0});
    parallel_for(levels_.size(), threads_, [&](std::size_t feature) {
      const std::vector<double> gain = gains(feature, std::size_t{1} << place);
      for (std::size_t level = 0; level < gain.size(); ++level) {
        if (gain[level] > best[feature].first) best[feature] = {gain[level], level};
      }
    });
    std::size_t feature = 0;
    for (std::size_t i = 1; i < best.size(); ++i) {
      if (best[i].first > best[feature].first) feature = i;
    }
    const auto level = static_cast<std::uint8_t>(best[feature].second);
    trees_.splits.push_back({static_cast<std::uint8_t>(feature), level});
    for (std::size_t i = 0; i < leaf_.size(); ++i) {
      const unsigned above = levels_[feature][i] > level ? 1u : 0u;
      leaf_[i] = static_cast<std::uint8_t>(leaf_[i] | above << place);
    }
  }

  void add_leaves() {
    const std::size_t count = std::size_t{1} << settings_.depth;
    std::vector<double> steps(count, 0);
    if (settings_.loss == Loss::logistic) {
      std::vector<double> pull(count, 0), curvature(count, settings_.damping);
      for (std::size_t i = 0; i < leaf_.size(); ++i) {
        pull[leaf_[i]] += pull_[i];
        curvature[leaf_[i]] += curvature_[i];
      }
      for (std::size_t leaf = 0; leaf < count; ++leaf) steps[leaf] = pull[leaf] / curvature[leaf];
    } else {
      std::vector<std::vector<std::pair<float, float>>> missing(count);
      for (std::size_t i = 0; i < leaf_.size(); ++i) {
        missing[leaf_[i]].emplace_back(samples_.wanted[i] - said_[i], samples_.weight[i]);
      }
      for (std::size_t leaf = 0; leaf < count; ++leaf) {
        if (static_cast<double>(missing[leaf].size()) < settings_.damping) continue;
        steps[leaf] = weighted_median(missing[leaf]);
      }
    }
    for (const double step : steps) leaves_.push_back(settings_.rate * step);
    const double* tree = leaves_.data() + (leaves_.size() - count);
    for (std::size_t i = 0; i < leaf_.size(); ++i) said_[i] += static_cast<float>(tree[leaf_[i]]);
  }

  void round_leaves() {
    double largest = 0;
    for (const double leaf : leaves_) largest = std::max(largest, std::abs(leaf));
    // A decimal number of few digits, so that text holds it exactly.
    trees_.unit = 1e-6;
    while (largest / trees_.unit > kLeafSpan) trees_.unit *= 2;
    for (const double leaf : leaves_) {
      trees_.leaves.push_back(static_cast<std::int16_t>(std::lround(leaf / trees_.unit)));
    }
  }

  /// Features that no tree asks for need no cuts.
  void forget_unasked() {
    std::vector<bool> asked(trees_.cuts.size(), false);
    for (const ObliviousTrees::Split& split : trees_.splits) asked[split.feature] = true;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (!asked[i]) trees_.cuts[i].clear();
    }
  }

  const Samples& samples_;
  BoostSettings settings_;
  std::size_t threads_;
  ObliviousTrees trees_;
  std::vector<std::vector<std::uint8_t>> levels_;
  std::vector<double> leaves_;
  std::vector<float> said_, pull_, curvature_;
  std::vector<std::uint8_t> leaf_;
};

}  // namespace

void Samples::add(const Samples& other) {
  const auto append = [](std::vector<float>& to, const std::vector<float>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  values.resize(std::max(values.size(), other.values.size()));
  for (std::size_t i = 0; i < other.values.size(); ++i) append(values[i], other.values[i]);
  append(wanted, other.wanted);
  append(weight, other.weight);
}

ObliviousTrees boost(const Samples& samples, const BoostSettings& settings, std::size_t threads) {
  return Booster(samples, settings, threads).run();
}

}  // namespace curlidar::density
