// SPDX-License-Identifier: BSD-3-Clause
#include "priors/fit.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/format.h>

namespace curlidar::training {
namespace {

/// What an extreme start costs, as if half a bit of either kind came in one scan more; nats.
constexpr double kDoubt = 0.15;
/// What confidence costs, in nats for each e-fold of a + b.
constexpr double kCaution = 0.5;

double mean_probability(std::span<const Observation> observations) {
  double ones = 0.2, all = 0.4;
  for (const Observation& o : observations) {
    const double n = o.zeros + o.ones;
    const double share = o.weight / std::sqrt(n + 1);  // long scans count for more, but not by n
    ones += o.ones * share;
    all += n * share;
  }
  return ones / all;
}

double cost(std::span<const Observation> observations, double p, double total) {
  const double a = total * p, b = total - a;
  const double base = std::lgamma(a) + std::lgamma(b) - std::lgamma(total);
  double nats = kCaution * std::log(total + 2) - kDoubt * std::log(p * (1 - p));
  for (const Observation& o : observations) {
    nats -= o.weight * (std::lgamma(o.ones + a) + std::lgamma(o.zeros + b) -
                        std::lgamma(o.zeros + o.ones + total) - base);
  }
  return nats;
}

std::string format_words(std::span<const std::uint16_t> words, const std::string& comment) {
  constexpr std::size_t kPerLine = 64;
  std::string text = comment;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += fmt::format("{:04x}", words[i]);
    if (i % kPerLine == kPerLine - 1 || i + 1 == words.size()) text += '\n';
  }
  return text;
}

}  // namespace

FirstState fit_first_state(std::span<const Observation> observations) {
  if (observations.empty()) return {};
  constexpr double kTotals[] = {0.7, 1.5, 3, 6, 12, 25, 50, 100, 255};
  const double mean = mean_probability(observations);
  const double middle = std::log(mean / (1 - mean));
  double best = std::numeric_limits<double>::infinity();
  FirstState state;
  for (const double total : kTotals) {
    for (int step = -3; step <= 3; ++step) {
      const double logit = std::clamp(middle + step * 0.25, -7.5, 7.5);
      const double nats = cost(observations, 1 / (1 + std::exp(-logit)), total);
      if (nats >= best) continue;
      best = nats;
      state.stretched = static_cast<std::int8_t>(std::lround(logit * 256 / 24));
      state.visits = static_cast<std::uint8_t>(std::clamp(std::lround(total - 0.5), 0L, 255L));
    }
  }
  return state;
}

std::vector<FirstState> fit_first_states(std::span<const BitCounts> counts,
                                         std::span<const double> weights) {
  const std::size_t models = counts.empty() ? 0 : counts.front().size();
  std::vector<FirstState> states(models);
  std::vector<Observation> observations;
  for (std::size_t m = 0; m < models; ++m) {
    observations.clear();
    for (std::size_t s = 0; s < counts.size(); ++s) {
      const auto& [zeros, ones] = counts[s][m];
      if (weights[s] > 0 && zeros + ones > 0) {
        observations.push_back({static_cast<double>(zeros), static_cast<double>(ones), weights[s]});
      }
    }
    states[m] = fit_first_state(observations);
  }
  return states;
}

void apply_states(std::span<const FirstState> states, std::span<BitModel> models) {
  for (std::size_t m = 0; m < models.size(); ++m) {
    models[m].probability = static_cast<std::uint16_t>(squash(states[m].stretched * 24));
    models[m].visits = states[m].visits;
  }
}

std::string format_states(std::span<const FirstState> states, const std::string& comment) {
  std::vector<std::uint16_t> words;
  for (const FirstState& state : states) {
    const auto high = static_cast<std::uint8_t>(state.stretched);
    words.push_back(static_cast<std::uint16_t>(high << 8 | state.visits));
  }
  return format_words(words, comment);
}

std::string format_weights(std::span<const std::int32_t> weights, const std::string& comment) {
  std::vector<std::uint16_t> words;
  for (const std::int32_t weight : weights) {
    words.push_back(
        static_cast<std::uint16_t>(static_cast<std::int16_t>(std::clamp(weight, -32767, 32767))));
  }
  return format_words(words, comment);
}

bool write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  return static_cast<bool>(file);
}

}  // namespace curlidar::training
