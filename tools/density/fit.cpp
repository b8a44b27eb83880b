// SPDX-License-Identifier: BSD-3-Clause
#include "density/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dense/features.hpp"
#include "dense/row_rules.hpp"
#include "sensor/angles.hpp"

namespace curlidar::density {
namespace {

constexpr std::size_t kBins = RangeTable::kBins;

/// Values by row and bin of range.
using Values = std::vector<std::array<std::vector<float>, kBins>>;

std::int16_t rounded(double value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -30000.0, 30000.0)));
}

double median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Medians of bins with enough values; others are as the nearest that has one, or `otherwise`.
void take_medians(const std::array<std::vector<float>, kBins>& values, std::size_t enough,
                  double otherwise, RangeTable::Row& row) {
  std::vector<std::size_t> known;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (values[bin].size() < enough) continue;
    known.push_back(bin);
    row[bin] = rounded(median(values[bin]));
  }
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (values[bin].size() >= enough) continue;
    const auto away = [&](std::size_t other) { return other > bin ? other - bin : bin - other; };
    const auto nearest = std::min_element(known.begin(), known.end(),
                                          [&](auto a, auto b) { return away(a) < away(b); });
    row[bin] = nearest == known.end() ? rounded(otherwise) : row[*nearest];
  }
}

/// How often there was something, by row and bin.
class Shares {
 public:
  explicit Shares(std::size_t rows) : there_(rows), all_(rows) {}
  void add(std::size_t row, double range_m, bool there) {
    const std::size_t bin = RangeTable::bin(range_m);
    all_[row][bin] += 1;
    there_[row][bin] += there ? 1 : 0;
  }
  /// In permille; bins with little in them lean on their row.
  RangeTable table() const {
    constexpr double kLean = 10;
    RangeTable table(all_.size());
    for (std::size_t row = 0; row < all_.size(); ++row) {
      double there = 0, all = 0;
      for (std::size_t bin = 0; bin < kBins; ++bin)
        there += there_[row][bin], all += all_[row][bin];
      const double usual = all > 0 ? there / all : 0.5;
      for (std::size_t bin = 0; bin < kBins; ++bin) {
        const double share = (there_[row][bin] + kLean * usual) / (all_[row][bin] + kLean);
        table.row(row)[bin] = rounded(1000 * share);
      }
    }
    return table;
  }

 private:
  std::vector<std::array<double, kBins>> there_, all_;
};

RangeTable fit_elevations(std::span<const RowScan> scans) {
  constexpr std::size_t kEnough = 40;
  const std::vector<double>& nominal = scans.front().elevations;
  Values values(nominal.size());
  for (const RowScan& scan : scans) {
    for (const RowCell& cell : scan.cells) {
      if (!(cell.range_m > 0)) continue;
      values[cell.row][RangeTable::bin(cell.range_m)].push_back(
          static_cast<float>(1000 * degrees_of(cell.elevation)));
    }
  }
  RangeTable table(nominal.size());
  for (std::size_t row = 0; row < nominal.size(); ++row) {
    take_medians(values[row], kEnough, 1000 * degrees_of(nominal[row]), table.row(row));
  }
  return table;
}

/// Whether a miss is one of the same surface.
bool near_miss(double wanted, double told) {
  return std::abs(wanted - told) < 0.08 * told + 0.3;
}

bool smooth(const Guess& guess) {
  return guess.mode == DenseMode::smooth || guess.mode == DenseMode::planar;
}

void fit_predicted_rows(std::span<const RowScan> scans, DensityProfile& profile) {
  constexpr std::size_t kEnough = 60;
  Shares shares(profile.rows);
  Values misses(profile.rows);
  for (const RowScan& scan : scans) {
    const RingPoints points = rings_of(scan, profile, true);
    const RowRules rules(points, profile);
    for (const RowCell& cell : scan.cells) {
      if (profile.is_given(cell.row)) continue;
      const Guess guess = rules.look_along_row(cell.row, cell.azimuth).guess;
      if (!(guess.r > 0)) continue;
      shares.add(cell.row, guess.r, cell.range_m > 0);
      if (cell.range_m > 0 && smooth(guess) && near_miss(cell.range_m, guess.r)) {
        misses[cell.row][RangeTable::bin(guess.r)].push_back(
            static_cast<float>(1000 * (cell.range_m - guess.r)));
      }
    }
  }
  profile.return_permille = shares.table();
  profile.bias_mm = RangeTable(profile.rows);
  for (std::size_t row = 0; row < profile.rows; ++row) {
    take_medians(misses[row], kEnough, 0, profile.bias_mm.row(row));
    for (std::int16_t& bias : profile.bias_mm.row(row)) {  // a few far misses make no metres
      bias = std::clamp<std::int16_t>(bias, -kMaxBias_mm, kMaxBias_mm);
    }
  }
}

/// Given rows as if they had been left out and the others given.
void fit_given_rows(std::span<const RowScan> scans, DensityProfile& profile) {
  Shares shares(profile.rows);
  for (const RowScan& scan : scans) {
    const RingPoints points = rings_of(scan, profile, false);
    const RowRules rules(points, profile);
    for (const RowCell& cell : scan.cells) {
      if (!profile.is_given(cell.row)) continue;
      const Guess guess = rules.look_along_row(cell.row, cell.azimuth).guess;
      if (guess.r > 0) shares.add(cell.row, guess.r, cell.range_m > 0);
    }
  }
  profile.given_return_permille = shares.table();
}

void add_sample(const RowFeatures& features, double wanted, double weight, Samples& samples) {
  samples.values.resize(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) samples.values[i].push_back(features[i]);
  samples.wanted.push_back(static_cast<float>(wanted));
  samples.weight.push_back(static_cast<float>(weight));
}

}  // namespace

DensityProfile fit_tables(std::span<const RowScan> scans, const GivenRows& given) {
  DensityProfile profile;
  profile.rows = scans.front().elevations.size();
  profile.given_first = given.first;
  profile.given_every = given.every;
  profile.elevation_mdeg = fit_elevations(scans);
  fit_predicted_rows(scans, profile);
  fit_given_rows(scans, profile);
  return profile;
}

void fit_trees(std::span<const RowScan> scans, const TreeSettings& settings,
               DensityProfile& profile, std::size_t threads) {
  constexpr double kMostWeight_m = 60, kMostShare = 0.5;
  Samples returns, residuals;
  std::size_t number = 0;
  for (const RowScan& scan : scans) {
    const RingPoints points = rings_of(scan, profile, true);
    const RowRules rules(points, profile);
    for (const RowCell& cell : scan.cells) {
      if (profile.is_given(cell.row) || number++ % settings.every != 0) continue;
      const RowGuess found = rules.look_along_row(cell.row, cell.azimuth);
      const double r = found.guess.r;
      if (!(r > 0)) continue;
      const RowFeatures features = rules.features(cell.row, found);
      // What a wrong decision costs in metres.
      add_sample(features, cell.range_m > 0 ? 1 : 0, std::min(r, kMostWeight_m) / 20 + 0.1,
                 returns);
      if (cell.range_m > 0 && smooth(found.guess)) {
        const double told = r + profile.bias_m(cell.row, r);
        const double miss = std::clamp(cell.range_m / told - 1, -kMostShare, kMostShare);
        add_sample(features, miss, 1, residuals);
      }
    }
  }
  if (settings.return_trees > 0) {
    profile.returns =
        boost(returns, {.trees = settings.return_trees, .depth = settings.depth}, threads);
  }
  if (settings.residual_trees > 0) {
    profile.residual = boost(residuals,
                             {.loss = Loss::absolute,
                              .trees = settings.residual_trees,
                              .depth = settings.residual_depth,
                              .rate = 0.3,
                              .damping = settings.residual_damping},
                             threads);
  }
}

}  // namespace curlidar::density
