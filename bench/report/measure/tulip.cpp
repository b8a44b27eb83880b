// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/tulip.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/try.hpp"
#include "curlidar/compare.hpp"
#include "sensor/angles.hpp"

namespace curlidar::bench::tulip {
namespace {

constexpr double kRowStep_deg = (kHighest_deg - kLowest_deg) / (kRows - 1);
constexpr double kColumnStep_deg = 360.0 / kColumns;

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

double elevation_of_row(double row) {
  return radians_of(kLowest_deg + kRowStep_deg * row);
}

double azimuth_of_column(double column) {
  return radians_of((column + 1 - kColumns / 2.0) * kColumnStep_deg);
}

bool locate(const Vec3& point, std::size_t& row, std::size_t& column) {
  const double up = std::round((degrees_of(elevation_of(point)) - kLowest_deg) / kRowStep_deg);
  const double turned_deg = degrees_of(std::atan2(point.x, point.y)) - 90;
  double across = kColumns / 2.0 - std::trunc(turned_deg / kColumnStep_deg);
  if (across >= kColumns) across -= kColumns;
  if (!(up >= 0 && up < kRows && across >= 0 && across < kColumns)) return false;
  row = static_cast<std::size_t>(up);
  column = static_cast<std::size_t>(across);
  return true;
}

Image project(const Cloud& cloud) {
  Image image;
  for (const Vec3& p : cloud.positions) {
    std::size_t row = 0, column = 0;
    if (!is_return(p) || !locate(p, row, column)) continue;
    const double range = norm(p);
    image.at(row, column) = range <= kLongest_m ? range : 0;
  }
  for (double& range : image.range_m) range = range <= kMost_m ? range : 0;
  return image;
}

Image given_rows(const Image& image) {
  Image given;
  for (std::size_t row = 0; row < kRows; row += kEvery) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      given.at(row, column) = image.at(row, column);
    }
  }
  return given;
}

Cloud points_of(const Image& image) {
  Cloud cloud;
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double range = image.at(row, column);
      if (range <= 0) continue;
      const Vec3 direction = direction_of(elevation_of_row(static_cast<double>(row)),
                                          azimuth_of_column(static_cast<double>(column)));
      cloud.positions.push_back(direction * range);
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

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
