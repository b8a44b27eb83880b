// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/ring_labels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "curlidar/sensor.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// An angle turned into [0, 2 pi) counted from `start`.
double angle_from(double start, double angle) {
  const double d = angle - start;
  return d < 0 ? d + kTurn : (d >= kTurn ? d - kTurn : d);
}

/// A return beside the seam may open a turn of its own at either end of the file.
void join_strays(Labels& labels) {
  std::vector<std::size_t> sizes(labels.count, 0);
  for (const std::uint16_t label : labels.of_return) ++sizes[label];
  std::size_t first = 0, last = labels.count - 1;
  if (sizes[first] <= 3 && sizes[first + 1] > 100) ++first;
  if (sizes[last] <= 3 && sizes[last - 1] > 100) --last;
  for (std::uint16_t& label : labels.of_return) {
    label = static_cast<std::uint16_t>(std::clamp<std::size_t>(label, first, last) - first);
  }
  labels.count = last - first + 1;
}

}  // namespace

const Attribute* find_ring_attribute(const Cloud& cloud) {
  for (const char* name : {"ring", "channel", "laser_id", "laser", "line"}) {
    if (const Attribute* attribute = cloud.find(name)) return attribute;
  }
  return nullptr;
}

std::optional<Labels> labels_from_attribute(const Cloud& cloud, const Attribute& attribute,
                                            const Returns& returns) {
  if (size_of(attribute.values) < cloud.size() * attribute.components) return std::nullopt;
  Labels labels;
  labels.of_return.resize(returns.size());
  double lowest = kMaxRings;
  double highest = -1;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const double value = attribute.as_double(returns.slot[i]);
    if (!(value >= 0) || value >= static_cast<double>(kMaxRings) || value != std::floor(value)) {
      return std::nullopt;
    }
    labels.of_return[i] = static_cast<std::uint16_t>(value);
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  // Some count from 1.
  const auto base = static_cast<std::uint16_t>(lowest == 1 ? 1 : 0);
  for (std::uint16_t& label : labels.of_return) label = static_cast<std::uint16_t>(label - base);
  labels.count = static_cast<std::size_t>(highest) + 1 - base;
  return labels;
}

std::optional<Labels> labels_from_rows(const Cloud& cloud, const Returns& returns,
                                       bool transposed) {
  const std::size_t width = cloud.width, height = cloud.height;
  if (height < 2 || width < 1 || width * height != cloud.size()) return std::nullopt;
  Labels labels;
  labels.count = transposed ? width : height;
  if (labels.count < 2 || labels.count > kMaxRings) return std::nullopt;
  labels.of_return.resize(returns.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::size_t slot = returns.slot[i];
    labels.of_return[i] = static_cast<std::uint16_t>(transposed ? slot % width : slot / width);
  }
  return labels;
}

EmptyArc widest_empty_arc(const Returns& returns) {
  // A tenth of a degree is fine enough to find where a cropped scan begins.
  constexpr std::size_t kSectors = 3600;
  std::vector<double> first(kSectors, kTurn), last(kSectors, -kTurn);
  for (const double azimuth : returns.azimuth) {
    const double turned = azimuth + std::numbers::pi;
    const auto sector = std::min(
        kSectors - 1, static_cast<std::size_t>(turned / kTurn * static_cast<double>(kSectors)));
    first[sector] = std::min(first[sector], azimuth);
    last[sector] = std::max(last[sector], azimuth);
  }
  double lowest = kTurn, previous = -kTurn;
  EmptyArc widest;
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    if (first[sector] > last[sector]) continue;
    if (previous == -kTurn) {
      lowest = first[sector];
    } else if (first[sector] - previous > widest.width) {
      widest = {first[sector], first[sector] - previous};
    }
    previous = last[sector];
  }
  if (lowest + kTurn - previous > widest.width) widest = {lowest, lowest + kTurn - previous};
  return widest;
}

std::vector<double> guess_turn_starts(const Returns& returns, const EmptyArc& empty) {
  // KITTI's turns start at azimuth 0; others at the back or at the first return. Those of a scan
  // cropped to a part of the circle may start anywhere in the part that is missing.
  std::vector<double> starts{0, -std::numbers::pi, returns.azimuth[0]};
  if (empty.width > 0.1) starts.push_back(empty.end);
  return starts;
}

std::optional<Labels> labels_from_turns(const Returns& returns, double start,
                                        const EmptyArc& empty) {
  // Angles are counted from `start` over the part of the circle that has returns.
  const double extent = kTurn - empty.width;
  const double arc_end = angle_from(start, empty.end);
  const auto angle_of = [&](double azimuth) {
    const double angle = angle_from(start, azimuth);
    return angle >= arc_end ? angle - std::min(empty.width, arc_end) : angle;
  };
  std::vector<std::int32_t> turns(returns.size());
  std::int32_t turn = 0, lowest = 0, highest = 0;
  double previous = angle_of(returns.azimuth[0]);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    // A jump of more than half of the extent is a new turn, or the way back to the last one.
    const double angle = angle_of(returns.azimuth[i]);
    if (angle - previous < -extent / 2) ++turn;
    if (angle - previous > extent / 2) --turn;
    lowest = std::min(lowest, turn);
    highest = std::max(highest, turn);
    if (highest - lowest >= static_cast<std::int32_t>(kMaxRings)) return std::nullopt;
    turns[i] = turn;
    previous = angle;
  }
  // Fewer than four is what a file in firing order shows.
  if (highest - lowest < 3) return std::nullopt;
  Labels labels;
  labels.count = static_cast<std::size_t>(highest - lowest) + 1;
  for (const std::int32_t t : turns) {
    labels.of_return.push_back(static_cast<std::uint16_t>(t - lowest));
  }
  join_strays(labels);
  return labels;
}

}  // namespace curlidar
