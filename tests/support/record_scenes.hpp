// SPDX-License-Identifier: BSD-3-Clause
// Small scans with an order and attributes: rings or firings one after the other, empty cells,
// loose points, slots without a point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "records/attributes.hpp"
#include "records/order.hpp"

namespace curlidar::test {

struct RecordSceneSettings {
  std::uint32_t rows = 16, columns = 200;
  std::size_t loose = 0;   ///< points without a cell, last in the order
  std::size_t others = 0;  ///< NaN slots, after the tenth slot
  bool by_firing = false;  ///< else ring by ring
};

struct RecordScene {
  RecordSceneSettings settings;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges, shift;
  std::vector<std::uint32_t> cells;  ///< of the records that have one
  CloudOrder order;

  explicit RecordScene(const RecordSceneSettings& given = {}) : settings(given) {
    std::mt19937 random(11);
    for (std::uint32_t cell = 0; cell < settings.rows * settings.columns; ++cell) {
      occupied.push_back(random() % 5 != 0 ? 1 : 0);
      ranges.push_back(static_cast<std::int32_t>(65536 * (10 + cell % settings.columns % 37)));
      if (occupied.back() != 0) cells.push_back(cell);
    }
    for (std::uint32_t row = 0; row < settings.rows; ++row) {
      shift.push_back(static_cast<std::int32_t>(row * 7) - 50);
    }
    order.record.resize(cells.size() + settings.loose);
    std::iota(order.record.begin(), order.record.end(), 0u);
    if (settings.by_firing) {
      std::stable_sort(
          order.record.begin(), order.record.end() - static_cast<std::ptrdiff_t>(settings.loose),
          [&](std::uint32_t a, std::uint32_t b) { return firing(cells[a]) < firing(cells[b]); });
    }
    order.kind.assign(order.record.size(), SlotKind::point);
    const auto tenth = static_cast<std::ptrdiff_t>(std::min<std::size_t>(10, order.slots()));
    order.kind.insert(order.kind.begin() + tenth, settings.others, SlotKind::nan);
    order.width = order.slots();
  }

  CellGrid grid() const { return {settings.rows, settings.columns, occupied, settings.loose}; }
  RecordGeometry geometry() const { return {grid(), ranges, shift}; }
  std::uint32_t row(std::uint32_t cell) const { return cell / settings.columns; }
  std::uint32_t column(std::uint32_t cell) const { return cell % settings.columns; }
  std::uint32_t firing(std::uint32_t cell) const {
    const std::int64_t ahead = std::int64_t{column(cell)} - shift[row(cell)];
    return static_cast<std::uint32_t>((ahead + settings.columns) % settings.columns);
  }

  /// An attribute by cell; 3 in slots of no cell.
  template <class Value, class Function>
  Attribute attribute(const std::string& name, const Function& value) const {
    std::vector<Value> values;
    std::size_t point = 0;
    for (const SlotKind kind : order.kind) {
      const std::size_t record =
          kind == SlotKind::point ? order.record[point++] : order.record.size();
      values.push_back(record < cells.size() ? static_cast<Value>(value(cells[record]))
                                             : static_cast<Value>(3));
    }
    return {name, 1, std::move(values)};
  }
};

}  // namespace curlidar::test
