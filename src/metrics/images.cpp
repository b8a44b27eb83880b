// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "curlidar/metrics.hpp"

namespace curlidar {
namespace {

Status check_shapes(const Cloud& a, const Cloud& b) {
  for (const auto& [name, cloud] : {std::pair{"first", &a}, std::pair{"second", &b}}) {
    if (!cloud->organised()) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("the {} cloud is not organised (its height is 1): images are "
                               "compared pixel by pixel",
                               name)};
    }
  }
  if (a.width != b.width || a.height != b.height || a.size() != b.size()) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("the images differ in shape: {} x {} and {} x {} (rows x columns)",
                             a.height, a.width, b.height, b.width)};
  }
  return {};
}

/// The image with (0, 0, 0) for every empty pixel.
Cloud within_range(const Cloud& image, const ImageSettings& settings) {
  Cloud kept;
  kept.positions = image.positions;
  for (Vec3& p : kept.positions) {
    const double range = norm(p);
    const bool valid = range >= settings.min_range && range <= settings.max_range;
    if (!is_return(p) || !valid) p = {0, 0, 0};
  }
  return kept;
}

/// Mean over all pixels of the squared distance to the nearest one, empty ones at the origin.
double mean_squared_all(const Cloud& from, const Cloud& to, std::size_t threads) {
  const ReturnTree tree(to, from);
  const bool has_empty = tree.size() < to.size();
  std::vector<double> squares(from.size());
  const std::size_t tasks = (from.size() + kQueriesPerTask - 1) / kQueriesPerTask;
  const auto square_at = [&](const Vec3& p) {
    Neighbour nearest;
    tree.nearest(p, {&nearest, 1});
    const double distance = has_empty ? std::min(nearest.distance, norm(p)) : nearest.distance;
    return distance * distance;
  };
  const double at_origin = has_empty ? 0 : square_at({0, 0, 0});
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(from.size(), (task + 1) * kQueriesPerTask);
    for (std::size_t i = task * kQueriesPerTask; i < end; ++i) {
      const Vec3& p = from.positions[i];
      squares[i] = is_return(p) ? square_at(p) : at_origin;
    }
  });
  return std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(from.size());
}

double ratio(double part, std::size_t whole) {
  return whole > 0 ? part / static_cast<double>(whole) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Result<ImageMetrics> compare_images(const Cloud& a, const Cloud& b, const ImageSettings& settings,
                                    std::size_t threads) {
  CURLIDAR_TRY(check_shapes(a, b));
  if (!(settings.min_range >= 0) || !(settings.max_range > settings.min_range)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("ranges from {} to {} m: from at least 0, to more than that",
                             settings.min_range, settings.max_range)};
  }
  const Cloud image_a = within_range(a, settings);
  const Cloud image_b = within_range(b, settings);
  ImageMetrics metrics;
  metrics.pixels = a.size();
  double sum_all = 0;
  double sum_both = 0;
  double squares_both = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double range_a = norm(image_a.positions[i]);
    const double range_b = norm(image_b.positions[i]);
    const double error = std::abs(range_a - range_b);
    sum_all += error;
    if (range_a > 0) ++metrics.valid_a;
    if (range_b > 0) ++metrics.valid_b;
    if (range_a > 0 && range_b > 0) {
      ++metrics.valid_both;
      sum_both += error;
      squares_both += error * error;
    }
  }
  metrics.missed = metrics.valid_a - metrics.valid_both;
  metrics.invented = metrics.valid_b - metrics.valid_both;
  metrics.mask_iou = ratio(static_cast<double>(metrics.valid_both),
                           metrics.valid_a + metrics.valid_b - metrics.valid_both);
  metrics.mae_all = ratio(sum_all, metrics.pixels);
  metrics.mae_both = ratio(sum_both, metrics.valid_both);
  metrics.rmse_both = std::sqrt(ratio(squares_both, metrics.valid_both));
  metrics.chamfer_squared_all =
      mean_squared_all(image_a, image_b, threads) + mean_squared_all(image_b, image_a, threads);
  return metrics;
}

}  // namespace curlidar
