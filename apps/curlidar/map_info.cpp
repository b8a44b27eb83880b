// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "map.hpp"

namespace curlidar::app {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::string map;
  bool tiles = false, allow_truncated = false;
};

/// Bytes of all parts, and leaves or points in them.
struct Totals {
  std::uint64_t bytes = 0, content = 0;
  std::size_t parts = 0;
};

Totals totals_of(const MapFile& map) {
  Totals totals;
  for (const MapTileEntry& tile : map.tiles()) {
    totals.bytes += tile.bytes;
    totals.content += tile.leaves;
    ++totals.parts;
  }
  for (const MapScanEntry& scan : map.scans()) {
    totals.bytes += scan.bytes;
    totals.content += scan.points;
    ++totals.parts;
  }
  return totals;
}

Json vector_json(const Vec3& v) {
  return Json::array({v.x, v.y, v.z});
}

Json box_json(const MapBox& box) {
  return {{"low", vector_json(box.low)}, {"high", vector_json(box.high)}};
}

Json surface_json(const SurfaceSettings& surface) {
  return {{"step_m", surface.step_m},           {"metres_per_bit", surface.metres_per_bit},
          {"root_m", surface.root_m},           {"smallest_leaf_m", surface.smallest_leaf_m},
          {"footprint_m", surface.footprint_m}, {"drop_m", surface.drop_m},
          {"curves", surface.curves},           {"intensity", surface.intensity}};
}

int run_info(const InfoOptions& options) {
  const MapFile map = load_map(options.map, options.allow_truncated);
  Outcome outcome = map_outcome(options.map, map);
  if (options.tiles) {
    Json tiles = Json::array();
    for (const MapTileEntry& tile : map.tiles()) {
      tiles.push_back({{"x", tile.key.x},
                       {"y", tile.key.y},
                       {"bytes", tile.bytes},
                       {"leaves", tile.leaves},
                       {"box", box_json(tile.box)}});
      outcome.text += fmt::format("  tile {},{}: {}, {} leaves\n", tile.key.x, tile.key.y,
                                  bytes_text(tile.bytes), count_text(tile.leaves));
    }
    outcome.json["tile_list"] = std::move(tiles);
  }
  print_result(options.common, outcome);
  return kExitOk;
}

}  // namespace

Outcome map_outcome(const std::string& path, const MapFile& map) {
  const MapHeader& header = map.header();
  const bool surface = header.kind == MapKind::surface;
  const Totals totals = totals_of(map);
  const auto bytes = static_cast<double>(map.file_bytes());
  const double area =
      static_cast<double>(map.tiles().size()) * header.tile_side_m * header.tile_side_m;
  Json json = {{"kind", "map"},
               {"map", to_string(header.kind)},
               {"bytes", map.file_bytes()},
               {"bytes_parts", totals.bytes},
               {"bytes_index", map.index_bytes()},
               {"bytes_other", map.file_bytes() - totals.bytes - map.index_bytes()},
               {"origin", vector_json(header.origin)},
               {"scans", header.scans},
               {"travelled_m", header.travelled_m},
               {"min_range_m", header.min_range_m},
               {"max_range_m", header.max_range_m},
               {surface ? "tiles" : "keyframes", totals.parts},
               {surface ? "leaves" : "points", totals.content}};
  std::vector<std::pair<std::string, std::string>> lines = {
      {"map of", surface ? "surface" : "scans"},
      {"size",
       fmt::format("{}: {} {}, index {}", bytes_text(map.file_bytes()), surface ? "tiles" : "scans",
                   bytes_text(totals.bytes), bytes_text(map.index_bytes()))},
      {"scans", fmt::format("{} along {:.1f} m, {:g} to {:g} m of range", header.scans,
                            header.travelled_m, header.min_range_m, header.max_range_m)},
      {surface ? "tiles" : "keyframes",
       fmt::format("{}{}, {} {}", totals.parts,
                   surface ? fmt::format(" of {:g} m", header.tile_side_m) : "",
                   count_text(totals.content), surface ? "leaves" : "points")},
      {"origin", fmt::format("{:.15g}, {:.15g}, {:.15g}", header.origin.x, header.origin.y,
                             header.origin.z)}};
  if (const auto extent = map.extent()) {
    json["extent"] = box_json(*extent);
    lines.push_back({"extent", fmt::format("{:.1f} .. {:.1f}, {:.1f} .. {:.1f}, {:.1f} .. {:.1f} m",
                                           extent->low.x, extent->high.x, extent->low.y,
                                           extent->high.y, extent->low.z, extent->high.z)});
  }
  if (header.travelled_m > 0) {
    json["bytes_per_metre"] = bytes / header.travelled_m;
    lines.push_back({"a metre", fmt::format("{:.1f} bytes", bytes / header.travelled_m)});
  }
  if (surface && area > 0) {
    json["bytes_per_square_metre"] = bytes / area;
    lines.push_back({"a square metre", fmt::format("{:.2f} bytes of tiles", bytes / area)});
  }
  if (!surface && totals.content > 0) {
    json["bits_per_point"] = bytes * 8 / static_cast<double>(totals.content);
    lines.push_back(
        {"a point", fmt::format("{:.3f} bits", bytes * 8 / static_cast<double>(totals.content))});
  }
  if (surface) json["surface"] = surface_json(header.surface);
  json["metadata"] = header.metadata;
  json["missing"] = map.missing();
  return {std::move(json), path + "\n" + lines_text(lines)};
}

Command add_map_info(CLI::App& map) {
  CLI::App* app = map.add_subcommand("info", "What a map holds, and where its bytes go");
  const auto options = std::make_shared<InfoOptions>();
  app->add_option("map", options->map, "A map")->required();
  app->add_flag("--tiles", options->tiles, "Every tile");
  app->add_flag("--allow-truncated", options->allow_truncated,
                "Take a map that is cut off as far as it goes");
  add_common_options(*app, options->common);
  return {app, [options] { return run_info(*options); }};
}

}  // namespace curlidar::app
