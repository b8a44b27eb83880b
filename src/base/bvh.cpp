// SPDX-License-Identifier: BSD-3-Clause
#include "base/bvh.hpp"

#include <cmath>
#include <limits>
#include <numeric>

namespace curlidar {

namespace {

constexpr std::uint32_t kLeafSize = 4;
constexpr int kBins = 16;

struct Box {
  std::array<double, 3> low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  void add(const std::array<double, 3>& l, const std::array<double, 3>& h) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], l[axis]);
      high[axis] = std::max(high[axis], h[axis]);
    }
  }
  double half_area() const {
    if (low[0] > high[0]) return 0;
    const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x * y + y * z + z * x;
  }
};

std::array<double, 3> as_array(const Vec3& v) {
  return {v.x, v.y, v.z};
}

double centre(const Bounds& bounds, std::size_t axis) {
  return 0.5 * (as_array(bounds.low)[axis] + as_array(bounds.high)[axis]);
}

float round_down(double value) {
  return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}
float round_up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

}  // namespace

struct Bvh::Range {
  std::uint32_t first, count;
  int depth;
};

Bvh::Bvh(std::span<const Bounds> bounds) : order_(bounds.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (bounds.empty()) return;
  nodes_.reserve(2 * bounds.size());
  nodes_.emplace_back();
  build(0, {0, static_cast<std::uint32_t>(bounds.size()), 0}, bounds);
}

void Bvh::build(std::uint32_t node, const Range& range, std::span<const Bounds> bounds) {
  Box box;
  for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
    box.add(as_array(bounds[order_[i]].low), as_array(bounds[order_[i]].high));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    nodes_[node].bounds[axis] = round_down(box.low[axis]);
    nodes_[node].bounds[axis + 3] = round_up(box.high[axis]);
  }
  if (range.count <= kLeafSize || range.depth >= kMaxDepth) {
    nodes_[node].first = range.first;
    nodes_[node].count = range.count;
    return;
  }
  const std::uint32_t left = split(range, bounds);
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.resize(nodes_.size() + 2);
  build(children, {range.first, left, range.depth + 1}, bounds);
  build(children + 1, {range.first + left, range.count - left, range.depth + 1}, bounds);
}

/// Reorders the range and returns the size of its first part, in [1, count - 1].
std::uint32_t Bvh::split(const Range& range, std::span<const Bounds> bounds) {
  const auto begin = order_.begin() + range.first;
  const auto end = begin + range.count;
  double best_cost = std::numeric_limits<double>::infinity();
  std::size_t best_axis = 0;
  double best_cut = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = 1e300, high = -1e300;
    for (auto it = begin; it != end; ++it) {
      low = std::min(low, centre(bounds[*it], axis));
      high = std::max(high, centre(bounds[*it], axis));
    }
    if (!(high > low)) continue;
    std::array<Box, kBins> boxes;
    std::array<std::uint32_t, kBins> counts{};
    const double scale = kBins / (high - low);
    for (auto it = begin; it != end; ++it) {
      const auto bin = static_cast<std::size_t>(
          std::min(kBins - 1.0, (centre(bounds[*it], axis) - low) * scale));
      boxes[bin].add(as_array(bounds[*it].low), as_array(bounds[*it].high));
      ++counts[bin];
    }
    std::array<double, kBins> right_cost{};
    Box box;
    std::uint32_t count = 0;
    for (std::size_t bin = kBins - 1; bin > 0; --bin) {
      box.add(boxes[bin].low, boxes[bin].high);
      right_cost[bin] = box.half_area() * (count += counts[bin]);
    }
    box = {};
    count = 0;
    for (std::size_t bin = 1; bin < kBins; ++bin) {
      box.add(boxes[bin - 1].low, boxes[bin - 1].high);
      count += counts[bin - 1];
      const double cost = box.half_area() * count + right_cost[bin];
      if (count > 0 && count < range.count && cost < best_cost) {
        best_cost = cost;
        best_axis = axis;
        best_cut = low + static_cast<double>(bin) / scale;
      }
    }
  }
  const auto middle = std::partition(
      begin, end, [&](std::uint32_t i) { return centre(bounds[i], best_axis) < best_cut; });
  const auto left = static_cast<std::uint32_t>(middle - begin);
  // All centres in one place: any halves do.
  return left > 0 && left < range.count ? left : range.count / 2;
}

}  // namespace curlidar
