// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/try.hpp"
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

double range_of(const Vec3& p, const ImageSettings& settings) {
  if (!is_return(p)) return 0;
  const double range = norm(p);
  return range >= settings.min_range && range <= settings.max_range ? range : 0;
}

double ratio(double part, std::size_t whole) {
  return whole > 0 ? part / static_cast<double>(whole) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Result<ImageMetrics> compare_images(const Cloud& a, const Cloud& b, const ImageSettings& settings) {
  CURLIDAR_TRY(check_shapes(a, b));
  if (!(settings.min_range >= 0) || !(settings.max_range > settings.min_range)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("ranges from {} to {} m: from at least 0, to more than that",
                             settings.min_range, settings.max_range)};
  }
  ImageMetrics metrics;
  metrics.pixels = a.size();
  double sum_all = 0;
  double sum_both = 0;
  double squares_both = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double range_a = range_of(a.positions[i], settings);
    const double range_b = range_of(b.positions[i], settings);
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
  return metrics;
}

}  // namespace curlidar
