// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace curlidar::bench {
namespace {

constexpr double kClose_m = 0.05;
constexpr std::size_t kBins = 10;

double share(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
}

std::size_t close_ones(std::span<const double> errors_m) {
  return static_cast<std::size_t>(
      std::count_if(errors_m.begin(), errors_m.end(), [](double e) { return e <= kClose_m; }));
}

/// Scatters indices: equally trusted lines must not be taken from the top rows first.
std::uint64_t scattered(std::uint64_t i) {
  i = (i ^ (i >> 30)) * 0xbf58476d1ce4e5b9u;
  i = (i ^ (i >> 27)) * 0x94d049bb133111ebu;
  return i ^ (i >> 31);
}

struct Percentiles {
  double p50 = 0, p95 = 0;
};

Percentiles percentiles(std::vector<double> errors_m) {
  const DistanceStats stats = summarise(std::move(errors_m));
  return {stats.p50, stats.p95};
}

}  // namespace

Judge::Judge(std::vector<double> true_m, const RangeLimits& limits)
    : true_m_(std::move(true_m)), limits_(limits) {
  wanted_ = static_cast<std::size_t>(std::count_if(
      true_m_.begin(), true_m_.end(), [this](double range_m) { return limits_.hold(range_m); }));
}

bool Judge::is_told(const RangeEstimate& estimate) const {
  return estimate.valid() && limits_.hold(estimate.range_m);
}

RayErrors Judge::errors(std::span<const RangeEstimate> told) const {
  RayErrors errors;
  std::vector<double> errors_m;
  std::size_t found = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (!is_told(told[i])) continue;
    if (std::isnan(true_m_[i])) {
      ++errors.no_surface;
      continue;
    }
    errors_m.push_back(std::abs(told[i].range_m - true_m_[i]));
    found += limits_.hold(true_m_[i]) ? 1 : 0;
  }
  errors.points = errors_m.size() + errors.no_surface;
  errors.within_5cm = share(close_ones(errors_m), errors_m.size());
  errors.completeness = share(found, wanted_);
  errors.stats = summarise(std::move(errors_m));
  return errors;
}

std::vector<double> Judge::ranked(std::span<const RangeEstimate> told) const {
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (is_told(told[i]) && limits_.hold(true_m_[i])) lines.push_back(i);
  }
  const auto trust = [&](std::size_t i) {  // plain fields tell none
    return std::isnan(told[i].confidence) ? 0 : told[i].confidence;
  };
  std::sort(lines.begin(), lines.end(), [&](std::size_t a, std::size_t b) {
    if (trust(a) != trust(b)) return trust(a) > trust(b);
    return scattered(a) < scattered(b);
  });
  std::vector<double> errors_m(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    errors_m[i] = std::abs(told[lines[i]].range_m - true_m_[lines[i]]);
  }
  return errors_m;
}

EqualCut Judge::equal_cut(std::span<const RangeEstimate> told,
                          std::span<const RangeEstimate> other) const {
  std::vector<double> ours = ranked(told), others = ranked(other);
  const std::size_t count = std::min(ours.size(), others.size());
  ours.resize(count);
  others.resize(count);
  const Percentiles of_ours = percentiles(std::move(ours)),
                    of_others = percentiles(std::move(others));
  return {share(count, wanted_), of_ours.p50, of_ours.p95, of_others.p50, of_others.p95};
}

Trade Judge::trade_of(std::vector<double> errors_m) const {
  Trade trade;
  trade.completeness = share(errors_m.size(), wanted_);
  trade.within_5cm = share(close_ones(errors_m), errors_m.size());
  const Percentiles found = percentiles(std::move(errors_m));
  trade.p50 = found.p50;
  trade.p95 = found.p95;
  return trade;
}

Trade Judge::most_trusted(std::span<const RangeEstimate> told, double part) const {
  std::vector<double> errors_m = ranked(told);
  const auto count = static_cast<std::size_t>(std::ceil(part * static_cast<double>(wanted_)));
  errors_m.resize(std::min(count, errors_m.size()));
  return trade_of(std::move(errors_m));
}

std::vector<ConfidenceBin> Judge::confidence(std::span<const RangeEstimate> told) const {
  std::vector<ConfidenceBin> bins(kBins);
  std::array<std::size_t, kBins> close{};
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (std::isnan(told[i].range_m)) continue;
    const double confidence = static_cast<double>(told[i].confidence);
    const auto bin = static_cast<std::size_t>(std::clamp(confidence * kBins, 0.0, kBins - 1.0));
    ++bins[bin].count;
    bins[bin].told += confidence;
    close[bin] += std::abs(told[i].range_m - true_m_[i]) <= kClose_m ? 1 : 0;  // NaN is not
  }
  for (std::size_t i = 0; i < kBins; ++i) {
    bins[i].told /= static_cast<double>(std::max<std::size_t>(bins[i].count, 1));
    bins[i].observed = share(close[i], bins[i].count);
  }
  return bins;
}

std::vector<Trade> Judge::trades(std::span<const RangeEstimate> told) const {
  constexpr int kSteps = 20;
  std::vector<Trade> trades;
  std::vector<RangeEstimate> kept(told.begin(), told.end());
  for (int step = 0; step < kSteps; ++step) {
    const float least = static_cast<float>(step) / kSteps;
    for (RangeEstimate& estimate : kept) {
      if (estimate.confidence < least) estimate.seen = Seen::unknown;
    }
    trades.push_back(trade_of(ranked(kept)));
    trades.back().min_confidence = static_cast<double>(step) / kSteps;
  }
  return trades;
}

Json to_json(const RayErrors& errors) {
  return {{"points", errors.points},         {"mean", errors.stats.mean},
          {"rms", errors.stats.rms},         {"p50", errors.stats.p50},
          {"p95", errors.stats.p95},         {"max", errors.stats.max},
          {"within_5cm", errors.within_5cm}, {"completeness", errors.completeness},
          {"no_surface", errors.no_surface}};
}

Json to_json(const EqualCut& cut) {
  return {{"completeness", cut.completeness},
          {"p50", cut.p50},
          {"p95", cut.p95},
          {"other_p50", cut.other_p50},
          {"other_p95", cut.other_p95}};
}

Json to_json(const std::vector<ConfidenceBin>& bins) {
  Json rows = Json::array();
  for (const ConfidenceBin& bin : bins) {
    rows.push_back({{"count", bin.count}, {"told", bin.told}, {"observed", bin.observed}});
  }
  return rows;
}

Json to_json(const Trade& trade) {
  return {{"min_confidence", trade.min_confidence},
          {"completeness", trade.completeness},
          {"p50", trade.p50},
          {"p95", trade.p95},
          {"within_5cm", trade.within_5cm}};
}

Json to_json(const std::vector<Trade>& trades) {
  Json rows = Json::array();
  for (const Trade& trade : trades) {
    if (trade.completeness > 0) rows.push_back(to_json(trade));
  }
  return rows;
}

}  // namespace curlidar::bench
