// SPDX-License-Identifier: BSD-3-Clause
#include "compact/ray_points.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace curlidar::compact {
namespace {

constexpr std::int64_t kTerms = 10;

std::int64_t limited(std::int64_t coordinate) {
  return std::clamp(coordinate, -kFarthestQ36, kFarthestQ36);
}

FixedPoint limited(const FixedPoint& p) {
  return {limited(p.x), limited(p.y), limited(p.z)};
}

FixedPoint sum(const FixedPoint& a, const FixedPoint& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

/// w x p; each product rounded down.
FixedPoint cross(const Turn& w, const FixedPoint& p) {
  const auto part = [](std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    return mul_shift(a, b, 30) - mul_shift(c, d, 30);
  };
  return {part(w[1], p.z, w[2], p.y), part(w[2], p.x, w[0], p.z), part(w[0], p.y, w[1], p.x)};
}

/// t, in 2^-32 m.
std::int64_t along_ray(const Ray& ray, std::int64_t range) {
  return range + std::int64_t{ray.range_phase} * 65536;
}

}  // namespace

FixedPoint turned(const Turn& w, const FixedPoint& p) {
  FixedPoint result = p;
  for (std::int64_t k = kTerms; k > 0; --k) {
    const std::int64_t inverse = (std::int64_t{1} << 30) / k;
    const auto part = [&](std::int64_t value) { return shift_right_round(value * inverse, 30); };
    result = sum(p, cross({part(w[0]), part(w[1]), part(w[2])}, result));
  }
  return result;
}

std::int64_t exact_range(std::int32_t range, std::uint64_t unit_q48) {
  if (unit_q48 == 0) return std::int64_t{range} * 65536;
  const auto unit = static_cast<std::int64_t>(unit_q48);
  return shift_right_round(div_round(std::int64_t{range} << 32, unit) * unit, 16);
}

FixedPoint point_on_ray(const Ray& ray, const SinCos& up, std::uint32_t azimuth,
                        std::int64_t range) {
  const SinCos around = sin_cos_q30(azimuth);
  const std::int64_t t = along_ray(ray, range);
  const auto level = [&](std::int64_t part) {
    return mul_shift(t, shift_right_round(part * up.cos, 30), 16);
  };
  const std::int64_t lateral = ray.lateral;
  return limited(FixedPoint{shift_right_round(level(around.cos) - lateral * around.sin, 10),
                            shift_right_round(level(around.sin) + lateral * around.cos, 10),
                            shift_right_round(mul_shift(t, up.sin, 16), 10) +
                                std::int64_t{ray.height} * (std::int64_t{1} << 20)});
}

std::uint32_t azimuth_on_ray(const Ray& ray, const SinCos& up, std::uint32_t azimuth,
                             std::int64_t range) {
  constexpr std::int64_t kAnglePerRadian = 683565276;  // round(2^32 / 2 pi)
  constexpr std::int64_t kHalf = std::int64_t{1} << 29;
  const std::int64_t u = mul_shift(along_ray(ray, range), up.cos, 46);
  const std::int64_t lateral = ray.lateral;
  std::int64_t x = 0;
  if (u > 0) {
    x = std::clamp(div_floor(lateral * (std::int64_t{1} << 30), u), -kHalf, kHalf);
  } else if (lateral != 0) {
    x = lateral > 0 ? kHalf : -kHalf;
  }
  const std::int64_t square = (x * x) >> 30;
  std::int64_t arc = 0;  // x^2 / 3 - x^4 / 5 + x^6 / 7
  for (const std::int64_t k : {7, 5, 3}) {
    arc = (square * ((std::int64_t{1} << 30) / k - arc)) >> 30;
  }
  arc = x - ((x * arc) >> 30);
  return azimuth + static_cast<std::uint32_t>(shift_right_round(arc * kAnglePerRadian, 30));
}

FixedPoint moved(const FixedPoint& point, std::uint32_t azimuth, const Motion& motion) {
  const std::int64_t s = static_cast<std::int32_t>(azimuth);
  const std::int64_t s2 = (s * s) >> 32;
  const auto at = [&](const Motion::Triple& once, const Motion::Triple& twice, std::size_t i,
                      unsigned shift) {
    return shift_right_round(once[i] * s + twice[i] * s2, shift);
  };
  const auto turn = [&](std::size_t i) { return at(motion.turn, motion.turn2, i, 32); };
  const auto move = [&](std::size_t i) { return at(motion.move, motion.move2, i, 12); };
  const auto fixed = [&](std::size_t i) {
    return std::int64_t{motion.rigid_move[i]} * (std::int64_t{1} << 20);
  };
  const FixedPoint unrolled =
      limited(sum(turned({turn(0), turn(1), turn(2)}, point), {move(0), move(1), move(2)}));
  const Motion::Triple& rigid = motion.rigid_turn;
  const FixedPoint placed =
      rigid == Motion::Triple{} ? unrolled : turned({rigid[0], rigid[1], rigid[2]}, unrolled);
  return limited(sum(placed, {fixed(0), fixed(1), fixed(2)}));
}

RayPoints::RayPoints(const RowTable& table, std::uint32_t rows)
    : rays_(*table.rays), moves_(!rays_.motion.none()) {
  elevations_.reserve(rows);
  for (std::uint32_t row = 0; row < rows; ++row) {
    elevations_.push_back(sin_cos_q30(static_cast<std::uint32_t>(table.elevation[row])));
  }
}

FixedPoint RayPoints::fixed(std::uint32_t row, std::uint32_t column, std::int32_t range) const {
  const Ray& ray = rays_.rays[row];
  const SinCos& up = elevations_[row];
  const std::uint32_t azimuth = rays_.azimuth_of(row, column);
  const std::int64_t exact = exact_range(range, rays_.range_unit_q48);
  const FixedPoint point = point_on_ray(ray, up, azimuth, exact);
  if (!moves_) return point;
  return moved(point, azimuth_on_ray(ray, up, azimuth, exact), rays_.motion);
}

}  // namespace curlidar::compact
