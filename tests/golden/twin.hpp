// SPDX-License-Identifier: BSD-3-Clause
// What a compact file means, as JSON: the twin of a golden file.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "compact/scan_points.hpp"
#include "format/container.hpp"
#include "support/compact_files.hpp"

namespace curlidar::test {

using Json = nlohmann::ordered_json;

/// A row of numbers for each row of the image.
template <typename Number>
Json rows_of(const std::vector<Number>& cells, std::size_t columns) {
  Json rows = Json::array();
  for (std::size_t begin = 0; begin < cells.size(); begin += columns) {
    const auto first = cells.begin() + static_cast<std::ptrdiff_t>(begin);
    rows.push_back(std::vector<Number>(first, first + static_cast<std::ptrdiff_t>(columns)));
  }
  return rows;
}

/// x, y, z of every n-th point from the first on.
inline Json every_nth(const std::vector<Vec3>& points, std::size_t n) {
  Json out = Json::array();
  for (std::size_t i = 0; i < points.size(); i += n) {
    out.push_back({points[i].x, points[i].y, points[i].z});
  }
  return out;
}

inline Json rays_of(const compact::RayTable& table) {
  Json twin;
  twin["table"] = table.table;
  twin["slots"] = table.slots;
  twin["unit"] = table.range_unit_q48;
  twin["firings"] = table.firings;
  for (const compact::Ray& ray : table.rays) {
    twin["rays"].push_back({ray.azimuth_offset, ray.height, ray.lateral, ray.range_phase});
  }
  const compact::Motion& m = table.motion;
  twin["motion"] = {m.turn, m.move, m.turn2, m.move2, m.rigid_turn, m.rigid_move};
  return twin;
}

inline Json header_of(const compact::DecodedScan& scan, bool complete) {
  const compact::ScanParameters& p = scan.parameters;
  const compact::RowTable& table = scan.table;
  Json twin;
  twin["complete"] = complete;
  twin["rows"] = p.rows;
  twin["columns"] = p.columns;
  twin["turn_columns"] = table.turn_columns;
  twin["first_column"] = table.first_column;
  twin["step"] = p.step;
  twin["residual_step"] = p.residual_step;
  twin["lattice"] = p.lattice_q32;
  twin["root_log2"] = p.root_log2;
  twin["smallest_leaf"] = p.smallest_leaf;
  twin["bands"] = p.bands;
  twin["sectors"] = p.sectors;
  twin["elevation"] = table.elevation;
  twin["height"] = table.height;
  twin["range_offset"] = table.range_offset;
  if (table.rays) twin["rays"] = rays_of(*table.rays);
  return twin;
}

/// Of a file that may be cut off. `points`: x, y, z in metres of the cells that have a range, in
/// raster order, every `points_every`-th of them. `field`: null if it is `range`. `surface`:
/// numbered through all segments, -1 where there is none.
inline Result<Json> twin_of(ByteSpan bytes) {
  const Result<PartialContainer> file = read_container_prefix(bytes);
  if (!file) return file.error();
  const auto scan = compact::decode_scan(chunks_of(file.value()));
  if (!scan) return scan.error();
  const compact::DecodedScan& decoded = scan.value();

  Json twin = header_of(decoded, file.value().complete && decoded.missing.empty());
  const std::size_t columns = decoded.parameters.columns;
  const compact::PointTable table(decoded.table, decoded.parameters.rows,
                                  decoded.parameters.columns);
  std::vector<Vec3> points;
  for (std::size_t cell = 0; cell < decoded.range.size(); ++cell) {
    if (decoded.range[cell] == 0) continue;
    points.push_back(table.metres(static_cast<std::uint32_t>(cell / columns),
                                  static_cast<std::uint32_t>(cell % columns), decoded.range[cell]));
  }
  twin["range"] = rows_of(decoded.range, columns);
  const bool refined = decoded.field_range != decoded.range;
  twin["field"] = refined ? rows_of(decoded.field_range, columns) : Json();
  twin["surface"] = rows_of(decoded.surface, columns);
  const std::size_t every = points.size() > 256 ? 5 : 1;
  twin["returns"] = points.size();
  twin["points_every"] = every;
  twin["points"] = every_nth(points, every);
  return twin;
}

/// One line for each row of an image and for every sixteen points.
inline std::string to_text(const Json& twin) {
  std::string text = "{\n";
  for (const auto& [key, value] : twin.items()) {
    text += "\"" + key + "\": ";
    const bool lines = value.is_array() && !value.empty() && value.front().is_array();
    if (!lines) text += value.dump();
    for (std::size_t i = 0; lines && i < value.size(); ++i) {
      text += i == 0 ? "[\n" : key != "points" || i % 16 == 0 ? ",\n" : ",";
      text += value[i].dump();
    }
    text += lines ? "],\n" : ",\n";
  }
  text.replace(text.size() - 2, 2, "}");
  return text + "\n";
}

}  // namespace curlidar::test
