// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/tulip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/try.hpp"
#include "curlidar/compare.hpp"

namespace curlidar::bench::tulip {
namespace {

bool judged(double range_m) {
  return range_m >= kLeast_m && range_m <= kMost_m;
}

double share(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

double mean_square(const std::vector<double>& distances) {
  double sum = 0;
  for (const double d : distances) sum += d * d;
  return share(sum, static_cast<double>(distances.size()));
}

/// The voxels that hold a point, each once, in order.
std::vector<std::array<std::int64_t, 3>> voxels(const Cloud& cloud) {
  std::vector<std::array<std::int64_t, 3>> out;
  for (const Vec3& p : cloud.positions) {
    const auto index = [](double metres) {
      return static_cast<std::int64_t>(std::floor(metres / kVoxel_m));
    };
    out.push_back({index(p.x), index(p.y), index(p.z)});
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// What was predicted, beside what was given.
Image completed(const Image& predicted, const Image& given) {
  Image image = given_rows(given);
  for (std::size_t row = 0; row < kRows; ++row) {
    if (row % kEvery == 0) continue;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double range = predicted.at(row, column);
      if (judged(range)) image.at(row, column) = range;
    }
  }
  return image;
}

void score_cells(const Image& image, const Image& truth, Scores& scores) {
  double sum = 0, either = 0, both = 0, wanted = 0;
  std::vector<double> errors;
  for (std::size_t cell = 0; cell < image.range_m.size(); ++cell) {
    const double is = image.range_m[cell], should = truth.range_m[cell];
    sum += std::abs(is - should);
    if (cell / kColumns % kEvery == 0) continue;
    wanted += should > 0 ? 1 : 0;
    either += is > 0 || should > 0 ? 1 : 0;
    both += is > 0 && should > 0 ? 1 : 0;
    if (is > 0 && should > 0) errors.push_back(std::abs(is - should));
  }
  const DistanceStats stats = summarise(std::move(errors));
  scores.mae_m = sum / static_cast<double>(image.range_m.size());
  scores.both_valid_mae_m = stats.mean;
  scores.median_m = stats.p50;
  scores.p95_m = stats.p95;
  scores.mask_iou = share(both, either);
  scores.completeness = share(both, wanted);
}

void score_voxels(const Cloud& is, const Cloud& should, Scores& scores) {
  const auto ours = voxels(is), theirs = voxels(should);
  std::vector<std::array<std::int64_t, 3>> shared;
  std::set_intersection(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                        std::back_inserter(shared));
  const auto count = [](const auto& list) { return static_cast<double>(list.size()); };
  scores.precision = share(count(shared), count(ours));
  scores.recall = share(count(shared), count(theirs));
  scores.f1 = share(2 * count(shared), count(ours) + count(theirs));
  scores.iou = share(count(shared), count(ours) + count(theirs) - count(shared));
}

}  // namespace

Result<Scores> score(const Image& predicted, const Image& given, const Image& truth) {
  Scores scores;
  const Image image = completed(predicted, given);
  score_cells(image, truth, scores);
  const Cloud is = points_of(image), should = points_of(truth);
  if (is.size() == 0 || should.size() == 0) {
    return Error{ErrorCode::invalid_argument, "an image without a range cannot be judged"};
  }
  CURLIDAR_TRY_ASSIGN(to_truth, nearest_distances(is, should));
  CURLIDAR_TRY_ASSIGN(to_prediction, nearest_distances(should, is));
  scores.chamfer_m2 = mean_square(to_truth) + mean_square(to_prediction);
  score_voxels(is, should, scores);
  return scores;
}

}  // namespace curlidar::bench::tulip
