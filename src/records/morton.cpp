// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include "records/loose.hpp"

namespace curlidar {
namespace {

constexpr double kCells = 1 << 21;

/// Bit i of the 21 to bit 3 i.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  if (points.empty()) return order;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  // Halves, so that no difference of finite numbers leaves what a double holds.
  const double side =
      std::max({high.x / 2 - low.x / 2, high.y / 2 - low.y / 2, high.z / 2 - low.z / 2});
  const auto cell = [&](double x, double least) {
    if (!(side > 0)) return std::uint64_t{0};
    const double part = (x / 2 - least / 2) / side * kCells;
    return static_cast<std::uint64_t>(std::clamp(part, 0.0, kCells - 1));
  };
  std::vector<std::uint64_t> codes(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    codes[i] =
        spread(cell(p.x, low.x)) | spread(cell(p.y, low.y)) << 1 | spread(cell(p.z, low.z)) << 2;
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

}  // namespace curlidar
