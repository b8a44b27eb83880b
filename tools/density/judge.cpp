// SPDX-License-Identifier: BSD-3-Clause
#include "density/judge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "dense/features.hpp"
#include "dense/row_rules.hpp"

namespace curlidar::density {

RowScores judge_rows(const RowScan& scan, const DensityProfile& profile, bool with_profile) {
  const RingPoints points = rings_of(scan, profile, true);
  const RowRules rules(points, profile);
  const ScanErrors errors = errors_of(points);
  struct Answer {
    double confidence = 0, error_m = 0;
  };
  std::vector<Answer> answers;
  std::size_t wanted = 0;
  for (const RowCell& cell : scan.cells) {
    if (!(cell.range_m > 0) || profile.is_given(cell.row)) continue;
    ++wanted;
    const PlaneLine line{
        cell.azimuth, {0, 0}, {std::cos(cell.elevation), std::sin(cell.elevation)}};
    RowGuess found;
    found.look = look_along(points, line);
    found.guess = decide(points, found.look);
    if (!(found.guess.r > 0)) continue;
    const PlainFeatures features = plain_features(points, found.look, found.guess, errors);
    if (with_profile) rules.judge(cell.row, RowSays::all, found);
    if (found.guess.seen != Seen::surface) continue;
    answers.push_back({generic_confidence()(features), std::abs(found.guess.r - cell.range_m)});
  }
  std::stable_sort(answers.begin(), answers.end(),
                   [](const Answer& a, const Answer& b) { return a.confidence > b.confidence; });
  std::vector<double> all, trusted;
  for (const Answer& answer : answers) {
    all.push_back(answer.error_m);
    if (2 * trusted.size() < wanted) trusted.push_back(answer.error_m);
  }
  RowScores scores;
  scores.completeness = static_cast<double>(all.size()) / static_cast<double>(wanted);
  scores.median_m = percentile(all, 0.5);
  scores.p95_m = percentile(all, 0.95);
  scores.half_median_m = percentile(trusted, 0.5);
  scores.half_p95_m = percentile(trusted, 0.95);
  return scores;
}

}  // namespace curlidar::density
