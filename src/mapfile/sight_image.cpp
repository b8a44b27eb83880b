// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/sight_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/bytes.hpp"
#include "curlidar/cloud.hpp"

namespace curlidar {
namespace {

constexpr double kUnit_m = 0.02;
constexpr double kNearest_m = 0.05;     // nearer, and nothing can be said of its direction
constexpr std::size_t kOutliers = 200;  // one return of so many may lie above or below all rows
/// Beams farther from a place than this say nothing of it.
constexpr double kGap = 0.04, kGap_m = 0.6;

double behind(double range_m) {
  return range_m * 1.03 + 0.5;
}
double before(double range_m) {
  return range_m * 0.97 - 0.5;
}

/// [0, 4): the azimuth, counter-clockwise from +x, a unit for each quarter of a turn.
double turn_of(const Vec3& p) {
  const double sum = std::abs(p.x) + std::abs(p.y);
  if (sum == 0) return 0;
  const double along = p.y / sum;
  const double turn = p.x < 0 ? 2 - along : (p.y < 0 ? 4 + along : along);
  return turn < 4 ? turn : 0;
}

struct Bearing {
  double range_m = 0, sine = 0;
};

std::optional<Bearing> bearing_of(const Vec3& p) {
  if (!is_return(p)) return std::nullopt;
  const double range = norm(p);
  if (!(range > kNearest_m && range < kUnit_m * 65535)) return std::nullopt;
  return Bearing{range, p.z / range};
}

}  // namespace

SightImage::SightImage(std::span<const Vec3> points)
    : range_(std::size_t{kRows} * kColumns, 0), fraction_(std::size_t{kRows} * kColumns, 0) {
  std::vector<double> sines;
  sines.reserve(points.size());
  for (const Vec3& p : points) {
    if (const auto bearing = bearing_of(p)) sines.push_back(bearing->sine);
  }
  if (sines.empty()) return;
  const std::size_t cut = sines.size() / kOutliers;
  std::nth_element(sines.begin(), sines.begin() + static_cast<std::ptrdiff_t>(cut), sines.end());
  low_ = sines[cut];
  const std::size_t last = sines.size() - 1 - cut;
  std::nth_element(sines.begin(), sines.begin() + static_cast<std::ptrdiff_t>(last), sines.end());
  step_ = std::max((sines[last] - low_) / kRows * (1 + 1e-9), 1e-4);
  for (const Vec3& p : points) {
    const auto bearing = bearing_of(p);
    if (!bearing) continue;
    const double row = (bearing->sine - low_) / step_;
    if (!(row >= 0 && row < kRows)) continue;
    const auto whole = static_cast<std::size_t>(row);
    const std::size_t cell = whole * kColumns + column_of(p);
    const auto range = static_cast<std::uint16_t>(std::max(1.0, bearing->range_m / kUnit_m));
    const auto fraction = static_cast<std::uint8_t>((row - static_cast<double>(whole)) * 256);
    // The lower of two as near as each other: what is kept must not depend on the points' order.
    const bool nearer = range_[cell] == 0 || range < range_[cell] ||
                        (range == range_[cell] && fraction < fraction_[cell]);
    if (!nearer) continue;
    range_[cell] = range;
    fraction_[cell] = fraction;
  }
}

SightImage::SightImage(std::span<const std::byte, kBytes> bytes) {
  ByteReader reader(bytes);
  low_ = reader.read<double>();
  step_ = reader.read<double>();
  range_.resize(std::size_t{kRows} * kColumns);
  fraction_.resize(range_.size());
  for (std::uint16_t& range : range_) range = reader.read<std::uint16_t>();
  for (std::uint8_t& fraction : fraction_) fraction = reader.read<std::uint8_t>();
}

std::vector<std::byte> SightImage::bytes() const {
  ByteWriter writer;
  writer.write(low_);
  writer.write(step_);
  for (const std::uint16_t range : range_) writer.write(range);
  for (const std::uint8_t fraction : fraction_) writer.write(fraction);
  return std::move(writer).bytes();
}

std::size_t SightImage::column_of(const Vec3& point) const {
  return std::min<std::size_t>(kColumns - 1,
                               static_cast<std::size_t>(turn_of(point) * (kColumns / 4)));
}

Sight SightImage::of(const Vec3& place) const {
  const auto bearing = bearing_of(place);
  if (!bearing || step_ == 0) return Sight::unknown;
  const double row = (bearing->sine - low_) / step_;
  if (!(row >= 0 && row < kRows)) return Sight::unknown;
  const int own = static_cast<int>(row);
  const auto fraction = static_cast<std::uint8_t>((row - own) * 256);
  const int reach = 1 + static_cast<int>(std::min(kGap, kGap_m / bearing->range_m) / step_);
  const std::size_t middle = column_of(place) + kColumns;
  int samples = 0, farther = 0, nearer = 0;
  const auto count = [&](std::uint16_t range) {
    const double range_m = range * kUnit_m;
    ++samples;
    farther += range_m > behind(bearing->range_m) ? 1 : 0;
    nearer += range_m < before(bearing->range_m) ? 1 : 0;
  };
  for (std::size_t c = middle - 1; c <= middle + 1; ++c) {
    const std::size_t column = c % kColumns;
    for (const int way : {-1, 1}) {
      for (int i = own; i >= 0 && i < static_cast<int>(kRows) && std::abs(i - own) <= reach;
           i += way) {
        const std::size_t cell = static_cast<std::size_t>(i) * kColumns + column;
        if (range_[cell] == 0) continue;
        if (i == own && (way < 0) != (fraction_[cell] <= fraction)) continue;
        count(range_[cell]);
        break;
      }
    }
  }
  if (samples >= 4 && farther >= samples - 1) return Sight::passed;
  const int about = samples - farther - nearer;
  return samples > 0 && 2 * about >= samples ? Sight::there : Sight::unknown;
}

}  // namespace curlidar
