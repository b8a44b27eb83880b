// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/originals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
/// Sectors of a turn; finer ones would find nothing sooner.
constexpr double kMostSectors = 65536;

using Box = std::array<std::int64_t, 3>;

Box box_of(const Vec3& p, double side) {
  constexpr double kFarthest = 1e15;  // boxes; what lies beyond shares the last
  const auto index = [&](double v) {
    return static_cast<std::int64_t>(std::floor(std::clamp(v / side, -kFarthest, kFarthest)));
  };
  return {index(p.x), index(p.y), index(p.z)};
}

/// Boxes that share a number are told apart by the distances of their points.
std::uint64_t number_of(const Box& box) {
  std::uint64_t number = 0;
  for (const std::int64_t index : box) {
    number = (number << 21) | (static_cast<std::uint64_t>(index) & 0x1fffff);
  }
  return number;
}

}  // namespace

TakenDirections::TakenDirections(std::span<const Vec3> points, double half_width)
    : half_width_(half_width),
      sectors_(static_cast<std::uint32_t>(
          std::clamp(std::floor(kTurn / half_width), 1.0, kMostSectors))) {
  places_.reserve(points.size());
  for (const Vec3& p : points) {
    places_.push_back({sector_of(azimuth_of(p)), elevation_of(p), azimuth_of(p)});
  }
  std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) {
    return std::tie(a.sector, a.elevation) < std::tie(b.sector, b.elevation);
  });
}

std::uint32_t TakenDirections::sector_of(double azimuth) const {
  const double share = (azimuth + std::numbers::pi) / kTurn;
  return std::min(static_cast<std::uint32_t>(std::clamp(share, 0.0, 1.0) * sectors_), sectors_ - 1);
}

bool TakenDirections::near(const Vec3& point, double half_height) const {
  const double elevation = elevation_of(point), azimuth = azimuth_of(point);
  const std::uint32_t middle = sector_of(azimuth);
  const auto before = [](const Place& place, const std::pair<std::uint32_t, double>& wanted) {
    return std::tie(place.sector, place.elevation) < std::tie(wanted.first, wanted.second);
  };
  for (const std::uint32_t step : {sectors_ - 1, 0u, 1u}) {
    const std::uint32_t sector = (middle + step) % sectors_;
    auto place = std::lower_bound(places_.begin(), places_.end(),
                                  std::pair{sector, elevation - half_height}, before);
    for (; place != places_.end() && place->sector == sector &&
           place->elevation <= elevation + half_height;
         ++place) {
      if (std::abs(std::remainder(place->azimuth - azimuth, kTurn)) <= half_width_) return true;
    }
  }
  return false;
}

TakenPlaces::TakenPlaces(std::span<const Vec3> points, double radius_m) : radius_m_(radius_m) {
  places_.reserve(points.size());
  for (const Vec3& p : points) places_.push_back({number_of(box_of(p, radius_m)), p});
  std::sort(places_.begin(), places_.end(),
            [](const Place& a, const Place& b) { return a.box < b.box; });
}

bool TakenPlaces::near(const Vec3& point) const {
  const Box middle = box_of(point, radius_m_);
  const auto before = [](const Place& place, std::uint64_t box) { return place.box < box; };
  for (int i = 0; i < 27; ++i) {
    const Box box{middle[0] + i / 9 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i % 3 - 1};
    const std::uint64_t number = number_of(box);
    auto place = std::lower_bound(places_.begin(), places_.end(), number, before);
    for (; place != places_.end() && place->box == number; ++place) {
      if (norm(place->point - point) <= radius_m_) return true;
    }
  }
  return false;
}

}  // namespace curlidar
