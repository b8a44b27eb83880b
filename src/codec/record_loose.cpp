// SPDX-License-Identifier: BSD-3-Clause
#include "codec/record_loose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "compact/scan_header.hpp"

namespace curlidar {
namespace {

/// Mean distance of a point in a cube to its middle, in sides.
constexpr double kMeanInCube = 0.4803;

double mean_error(const std::vector<Vec3>& points, const std::vector<Vec3>& decoded) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += norm(decoded[i] - points[i]);
  return sum / static_cast<double>(std::max<std::size_t>(points.size(), 1));
}

/// The larger of the two mean nearest-neighbour distances.
Result<double> neighbour_error(const std::vector<Vec3>& points, const std::vector<Vec3>& decoded,
                               std::size_t threads) {
  Cloud a, b;
  a.positions = points;
  b.positions = decoded;
  return worse_mean_distance(a, b, threads);
}

/// How far a coding misses the target: at most 1 is within.
Result<double> miss_of(const std::vector<Vec3>& points, const CodedPoints& coded,
                       const CompactSettings& settings, double beside_bits, std::size_t threads) {
  if (settings.target == CompactTarget::bits_per_point) {
    const std::size_t bytes = compact::frame_size(coded.bytes.size()) + coded.bytes.size();
    const double bits = 8.0 * static_cast<double>(bytes) + beside_bits;
    return bits / static_cast<double>(points.size()) / settings.target_value;
  }
  if (settings.target == CompactTarget::error_nn) {
    CURLIDAR_TRY_ASSIGN(distance, neighbour_error(points, coded.decoded, threads));
    return distance / settings.target_value;
  }
  return mean_error(points, coded.decoded) / settings.target_value;
}

/// The coarsest steps within an error, or the finest within so many bits, to a few percent.
Result<CodedPoints> search_step(const std::vector<Vec3>& points, ScalarType type,
                                const CompactSettings& settings, double beside_bits,
                                std::size_t threads) {
  constexpr double kNearEnough = 0.95;
  constexpr int kMostTrials = 14;
  const bool bits = settings.target == CompactTarget::bits_per_point;
  double step = bits ? 0.05 : settings.target_value / kMeanInCube;
  double good = 0, bad = 0;  // steps that reach the target, and that do not
  std::optional<CodedPoints> best;
  double least_miss = 0;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    CURLIDAR_TRY_ASSIGN(coded, encode_loose(points, type, {0, step}));
    CURLIDAR_TRY_ASSIGN(miss, miss_of(points, coded, settings, beside_bits, threads));
    least_miss = trial == 0 ? miss : std::min(least_miss, miss);
    if (miss <= 1) {
      good = step;
      best = std::move(coded);
      if (miss > kNearEnough) break;
    } else {
      bad = step;
    }
    if (good > 0 && bad > 0) {
      step = std::sqrt(good * bad);
    } else {
      const double ratio = bits ? std::exp2((miss - 1) * settings.target_value / 3) : 1 / miss;
      step *= std::clamp(ratio, 1.0 / 64, 64.0) * ((miss > 1) == bits ? 1.02 : 0.98);
    }
  }
  if (best) return *std::move(best);
  return Error{ErrorCode::invalid_argument,
               fmt::format("the target is out of reach: {:.4g} times it is the least for these "
                           "points; ask for {}",
                           least_miss, bits ? "more bits" : "a larger error")};
}

}  // namespace

Result<CodedPoints> encode_leftovers(const std::vector<Vec3>& points, ScalarType type,
                                     const CompactSettings& settings, double error_m) {
  if (settings.target == CompactTarget::lossless) return encode_loose(points, type, {});
  if (settings.target == CompactTarget::max_error) {
    return encode_loose(points, type, {settings.target_value, 0});
  }
  return encode_loose(points, type, {0, std::max(error_m, 1e-6)});
}

Result<CodedPoints> encode_all_loose(const std::vector<Vec3>& points, ScalarType type,
                                     const CompactSettings& settings, double beside_bits,
                                     std::size_t threads) {
  switch (settings.target) {
    case CompactTarget::lossless:
      return encode_loose(points, type, {});
    case CompactTarget::max_error:
      return encode_loose(points, type, {settings.target_value, 0});
    case CompactTarget::step:
      return encode_loose(points, type, {0, settings.target_value});
    default:
      break;
  }
  if (points.empty()) return encode_loose(points, type, {0, settings.target_value});
  return search_step(points, type, settings, beside_bits, threads);
}

}  // namespace curlidar
