// SPDX-License-Identifier: BSD-3-Clause
// Chunks of order and attributes as inputs of the targets of fuzzing.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hostile/targets/records.hpp"

namespace curlidar::test {

using FuzzInputs = std::map<std::string, std::vector<std::byte>>;

/// Rows, columns - 1, loose points, fill, as FuzzGrid reads them.
using GridHead = std::array<unsigned, 4>;

inline std::vector<std::byte> headed(const GridHead& head, const std::vector<std::byte>& payload) {
  std::vector<std::byte> bytes;
  for (const unsigned number : head) bytes.push_back(static_cast<std::byte>(number));
  for (const std::byte byte : payload) bytes.push_back(byte);
  return bytes;
}

inline FuzzGrid grid_of(const GridHead& head) {
  const std::vector<std::byte> bytes = headed(head, {});
  FuzzInput input(bytes);
  return FuzzGrid(input);
}

/// Orders row by row, shuffled, with other slots between, of no cells, of nothing.
inline FuzzInputs order_inputs() {
  FuzzInputs inputs;
  const auto add = [&](const std::string& name, const GridHead& head, std::size_t others,
                       bool shuffled) {
    const FuzzGrid grid = grid_of(head);
    const std::size_t records = grid.grid().records();
    CloudOrder order;
    for (std::size_t i = 0; i < records; ++i) {
      order.record.push_back(static_cast<std::uint32_t>(i));
      if (shuffled && i > 0) std::swap(order.record[i], order.record[mixed(i) % i]);
    }
    order.kind.assign(records, SlotKind::point);
    for (std::size_t i = 0; i < others; ++i) {
      const auto kind = static_cast<SlotKind>(1 + i % 3);
      order.kind.insert(
          order.kind.begin() + static_cast<std::ptrdiff_t>(mixed(i) % (order.slots() + 1)), kind);
      if (kind == SlotKind::odd) order.odd.push_back({i, std::uint64_t{0x7ff0} << 48, 0});
    }
    order.width = order.slots();
    inputs[name] = headed(head, encode_order(order, grid.grid()));
  };
  add("rows", {4, 30, 0, 2}, 0, false);
  add("shuffled", {3, 20, 7, 0}, 0, true);
  add("others", {4, 20, 5, 2}, 20, false);
  add("loose", {0, 5, 60, 0}, 3, true);
  add("nothing", {0, 0, 0, 0}, 0, false);
  return inputs;
}

/// Attributes in every form, with slots that are no points.
inline FuzzInputs records_inputs() {
  FuzzInputs inputs;
  const auto add = [&](const std::string& name, const auto& function, std::uint32_t components) {
    const GridHead head{8, 40, 6, 2};
    const FuzzGrid grid = grid_of(head);
    constexpr unsigned others = 9;
    CloudOrder order;
    for (std::size_t i = 0; i < grid.grid().records(); ++i) {
      order.kind.push_back(SlotKind::point);
      order.record.push_back(static_cast<std::uint32_t>(i));
    }
    for (unsigned i = 0; i < others; ++i) order.kind.push_back(SlotKind::zero);
    using Value = decltype(function(std::size_t{}));
    std::vector<Value> values;
    for (std::size_t i = 0; i < order.slots() * components; ++i) values.push_back(function(i));
    const RecordGeometry geometry{grid.grid(), {}, {}};
    const auto payload =
        write_records({{name, components, std::move(values)}}, order, geometry).value();
    std::vector<std::byte> bytes{static_cast<std::byte>(others)};
    for (const std::byte byte : payload) bytes.push_back(byte);
    inputs[name] = headed(head, bytes);
  };
  const auto wave = [](std::size_t i) { return 20 + 10 * std::sin(static_cast<double>(i) * .1); };
  add(
      "levels", [&](std::size_t i) { return static_cast<std::uint8_t>(wave(i)); }, 1);
  add(
      "hundredths", [&](std::size_t i) { return static_cast<float>(std::round(wave(i)) / 100); },
      2);
  add(
      "wide", [&](std::size_t i) { return static_cast<std::uint16_t>(wave(i) * wave(i)); }, 1);
  add(
      "palette", [&](std::size_t i) { return 1e9 * static_cast<double>(mixed(i) % 5) + .1; }, 1);
  add(
      "line", [&](std::size_t i) { return static_cast<std::int64_t>(i * 100); }, 1);
  add(
      "bits", [&](std::size_t i) { return static_cast<std::uint32_t>(mixed(i)); }, 1);
  return inputs;
}

}  // namespace curlidar::test
