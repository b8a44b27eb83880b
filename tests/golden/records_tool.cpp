// SPDX-License-Identifier: BSD-3-Clause
// Makes the golden chunks of order and attributes anew, for changes of the format only.
//   records_tool FOLDER      writes FOLDER/NAME.json
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <utility>

#include "golden/records_twin.hpp"
#include "support/record_scenes.hpp"

namespace curlidar::test {
namespace {

TwinGrid grid_of(const RecordScene& scene) {
  TwinGrid grid;
  grid.rows = scene.settings.rows;
  grid.columns = scene.settings.columns;
  grid.loose = scene.settings.loose;
  grid.occupied = scene.occupied;
  grid.ranges = scene.ranges;
  grid.shift = scene.shift;
  return grid;
}

void write(const std::filesystem::path& file, const TwinGrid& grid, const CloudOrder& order,
           const std::vector<Attribute>& attributes) {
  Json twin;
  twin["order_payload"] = hex_of(encode_order(order, grid.geometry().grid));
  twin["records_payload"] = hex_of(write_records(attributes, order, grid.geometry()).value());
  twin["grid"] = grid.to_json();
  twin["order"] = json_of(order);
  twin["attributes"] = json_of(attributes);
  std::ofstream(file) << twin.dump() << '\n';
}

double noise(std::uint32_t cell, std::uint32_t most) {
  return static_cast<double>(mixed(cell) % most);
}

void write_rings(const std::filesystem::path& folder) {
  const RecordScene scene({.rows = 8, .columns = 120});
  const auto wave = [&](std::uint32_t cell) {
    return std::floor(40 + 3 * scene.row(cell) + 30 * std::sin(scene.column(cell) * .1) +
                      noise(cell, 4));
  };
  const auto time = [&](std::uint32_t cell) { return 1000 * scene.firing(cell) + scene.row(cell); };
  write(folder / "rings.json", grid_of(scene), scene.order,
        {scene.attribute<std::uint8_t>("intensity", wave),
         scene.attribute<std::uint16_t>("ring", [&](auto cell) { return scene.row(cell) * 3; }),
         scene.attribute<std::uint32_t>("t", time)});
}

void write_firings(const std::filesystem::path& folder) {
  const RecordScene scene({.rows = 16, .columns = 50, .loose = 12, .others = 9, .by_firing = true});
  const auto hundredths = [&](std::uint32_t cell) {
    return static_cast<float>(std::floor(noise(cell, 10) + scene.column(cell)) / 100);
  };
  const auto wide = [&](std::uint32_t cell) {
    return std::floor(std::exp(4 + 3 * std::sin(scene.column(cell) * .2)) + noise(cell, 30));
  };
  const auto some = [&](std::uint32_t cell) { return 1e9 * noise(cell, 6) + .123; };
  const auto line = [&](std::uint32_t cell) { return -std::int64_t{cell} * 1000000007; };
  write(folder / "firings.json", grid_of(scene), scene.order,
        {scene.attribute<float>("reflectance", hundredths),
         scene.attribute<std::uint16_t>("signal", wide), scene.attribute<double>("class", some),
         scene.attribute<std::int64_t>("count", line)});
}

void write_organised(const std::filesystem::path& folder) {
  const RecordScene scene({.rows = 6, .columns = 64});
  CloudOrder order;
  order.width = 64;
  order.height = 6;
  for (std::uint32_t row = 6; row-- > 0;) {
    for (std::uint32_t step = 0; step < 64; ++step) {
      const std::uint32_t cell = row * 64 + (row * 11 + 64 - step) % 64;
      const auto at = std::lower_bound(scene.cells.begin(), scene.cells.end(), cell);
      const bool point = at != scene.cells.end() && *at == cell;
      order.kind.push_back(point ? SlotKind::point : SlotKind::nan);
      if (point) order.record.push_back(static_cast<std::uint32_t>(at - scene.cells.begin()));
    }
  }
  std::vector<std::int8_t> level;
  for (std::uint32_t slot = 0; slot < order.slots(); ++slot) {
    const double wave = 30 * std::sin(slot % 64 * .1 + slot / 64 * .3) + noise(slot, 9);
    const bool point = order.kind[slot] == SlotKind::point;
    level.push_back(static_cast<std::int8_t>(point ? wave : -1));
  }
  write(folder / "organised.json", grid_of(scene), order, {{"level", 1, std::move(level)}});
}

void write_shuffled(const std::filesystem::path& folder) {
  RecordScene scene({.rows = 4, .columns = 40, .loose = 30});
  scene.ranges.clear();
  scene.shift.clear();
  CloudOrder order = scene.order;
  for (std::size_t i = 1; i < order.record.size(); ++i) {
    std::swap(order.record[i], order.record[mixed(i) % i]);
  }
  order.type = ScalarType::float64;
  for (std::uint32_t i = 0; i < 6; ++i) {
    order.kind.insert(order.kind.begin() + mixed(i) % 100, static_cast<SlotKind>(1 + i % 3));
    if (i % 3 == 2) order.odd.push_back({mixed(i), std::uint64_t{0x7ff8} << 48 | i, mixed(i + 9)});
  }
  std::vector<std::uint32_t> any;
  std::vector<float> pairs;
  std::size_t point = 0;
  for (std::uint32_t slot = 0; slot < order.slots(); ++slot) {
    any.push_back(mixed(slot));
    const std::uint32_t record = order.kind[slot] == SlotKind::point ? order.record[point++] : slot;
    const double smooth = std::floor(60 + 40 * std::sin(record * .1) + noise(record, 3));
    pairs.push_back(static_cast<float>(smooth / 255));
    pairs.push_back(static_cast<float>((smooth + 7) / 255));
  }
  write(folder / "shuffled.json", grid_of(scene), order,
        {{"any", 1, std::move(any)}, {"pairs", 2, std::move(pairs)}});
}

void write_loose(const std::filesystem::path& folder) {
  const RecordScene scene({.rows = 0, .columns = 0, .loose = 100});
  std::vector<std::uint8_t> level;
  for (std::uint32_t i = 0; i < 100; ++i) level.push_back(static_cast<std::uint8_t>(mixed(i) % 40));
  write(folder / "loose.json", grid_of(scene), scene.order, {{"level", 1, std::move(level)}});
}

}  // namespace
}  // namespace curlidar::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: records_tool FOLDER\n", stderr);
    return 2;
  }
  using namespace curlidar::test;
  write_rings(argv[1]);
  write_firings(argv[1]);
  write_organised(argv[1]);
  write_shuffled(argv[1]);
  write_loose(argv[1]);
  return 0;
}
