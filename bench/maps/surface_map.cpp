// SPDX-License-Identifier: BSD-3-Clause
// surface_map POSES SCAN... [NAME=VALUE...]: a surface map of scans in memory, tile by tile, and
// how near it is to them. POSES: rows of T_map_sensor, 3x4, one for each scan. Names: step bit drop
// footprint leaf root (settings), bare full curves intensity, every min max (scans, metres), tile
// (side, m), voxel (of the union, m), spacing (of the map's points, m), queries.
//
// Prints bytes, mean distance from raw points to the map's surface (at most 1 m each), and shares
// within 5, 10, 20 cm both ways (from the map: its points) with their F scores: as `map compare`.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nanoflann.hpp>

#include "curlidar/io.hpp"
#include "curlidar/motion.hpp"
#include "map/sample_grid.hpp"
#include "map/surface_distance.hpp"
#include "map/surface_tile.hpp"
#include "map/tile_points.hpp"

namespace {

using namespace curlidar;

struct Points {
  std::vector<Vec3> at;

  std::size_t kdtree_get_point_count() const { return at.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return axis == 0 ? at[i].x : axis == 1 ? at[i].y : at[i].z;
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3>;

struct Distances {
  double mean = 0;
  std::array<double, 3> within{};  ///< 5, 10, 20 cm

  void add(double d) {
    constexpr double kLimits[] = {0.05, 0.1, 0.2};
    mean += d;
    for (std::size_t l = 0; l < 3; ++l) within[l] += d < kLimits[l] ? 1 : 0;
  }
  void divide(std::size_t n) {
    mean /= static_cast<double>(n);
    for (double& share : within) share /= static_cast<double>(n);
  }
};

/// Spread over all points, without a pattern.
std::size_t pick(std::size_t k, std::size_t points) {
  return (k * 2654435761u) % points;
}

/// Of points to a surface of many tiles.
Distances distances(const Points& from, const MapTile& surface, std::size_t queries) {
  Distances out;
  const tile::SurfaceDistance to(surface, 1.0);
  const std::size_t n = std::min(queries, from.at.size());
  for (std::size_t k = 0; k < n; ++k) out.add(to.of(from.at[pick(k, from.at.size())]));
  out.divide(std::max<std::size_t>(n, 1));
  return out;
}

/// Puts a tile beside others.
void join(const MapTile& tile, const Vec3& corner, MapTile& all) {
  for (MapLeaf leaf : tile.leaves) {
    leaf.centre = leaf.centre + corner;
    leaf.height_m += leaf.axis == 0 ? corner.x : leaf.axis == 1 ? corner.y : corner.z;
    leaf.first_cell += all.footprint.size();
    all.leaves.push_back(leaf);
  }
  all.footprint.insert(all.footprint.end(), tile.footprint.begin(), tile.footprint.end());
}

Distances distances(const Points& from, const Points& to, std::size_t queries) {
  Distances out;
  if (from.at.empty() || to.at.empty()) return out;
  const Tree tree(3, to, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  const std::size_t n = std::min(queries, from.at.size());
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = pick(k, from.at.size());
    const double query[3] = {from.at[i].x, from.at[i].y, from.at[i].z};
    std::uint32_t index = 0;
    double squared = 0;
    tree.knnSearch(query, 1, &index, &squared);
    out.add(std::min(std::sqrt(squared), 1.0));
  }
  out.divide(n);
  return out;
}

std::vector<RigidMotion> read_motions(const std::string& path) {
  std::ifstream file(path);
  std::vector<RigidMotion> out;
  for (std::string line; std::getline(file, line);) {
    std::istringstream in(line);
    std::array<double, 12> v{};
    for (double& number : v) in >> number;
    if (!in) continue;
    RigidMotion motion;
    for (std::size_t row = 0; row < 3; ++row) {
      motion.rotation[row] = {v[4 * row], v[4 * row + 1], v[4 * row + 2]};
    }
    motion.move = {v[3], v[7], v[11]};
    out.push_back(motion);
  }
  return out;
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: surface_map POSES SCAN... [NAME=VALUE...]\n";
    return 2;
  }
  std::map<std::string, double> options = {
      {"step", 0.1},       {"bit", 0.15},      {"bare", 60}, {"full", 25},  {"drop", 0.3},
      {"footprint", 0.25}, {"leaf", 0.25},     {"root", 4},  {"curves", 0}, {"intensity", 0},
      {"every", 1},        {"min", 2.5},       {"max", 80},  {"tile", 32},  {"voxel", 0.05},
      {"spacing", 0.05},   {"queries", 60000}, {"first", 0}};
  std::vector<std::string> scans;
  for (int i = 2; i < argc; ++i) {
    const std::string text = argv[i];
    const std::size_t sign = text.find('=');
    if (sign != std::string::npos && options.count(text.substr(0, sign)) != 0) {
      options[text.substr(0, sign)] = std::stod(text.substr(sign + 1));
    } else {
      scans.push_back(text);
    }
  }
  const std::vector<RigidMotion> motions = read_motions(argv[1]);
  if (motions.size() < scans.size()) {
    std::cerr << argv[1] << ": fewer poses than scans\n";
    return 3;
  }
  const double side = options["tile"];
  Points raw;
  std::map<TileKey, SampleGrid> grids;
  double grid_time = 0;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const auto cloud = read_cloud(scans[s]);
    if (!cloud) {
      std::cerr << cloud.error().message << '\n';
      return 3;
    }
    const double start = seconds();
    for (const Vec3& p : cloud->positions) {
      const double range = norm(p);
      if (!(range > options["min"] && range < options["max"])) continue;
      const Vec3 q = motions[s](p);
      raw.at.push_back(q);
      if (static_cast<int>(s) % static_cast<int>(options["every"]) != 0) continue;
      const TileKey key{static_cast<std::int32_t>(std::floor(q.x / side)),
                        static_cast<std::int32_t>(std::floor(q.y / side))};
      grids.try_emplace(key, options["voxel"])
          .first->second.add({q.x - key.x * side, q.y - key.y * side, q.z}, std::nanf(""));
    }
    grid_time += seconds() - start;
  }
  SurfaceSettings settings;
  settings.step_m = options["step"];
  settings.metres_per_bit = options["bit"];
  settings.drop_m = options["drop"];
  settings.footprint_m = options["footprint"];
  settings.smallest_leaf_m = options["leaf"];
  settings.root_m = options["root"];
  settings.bare_samples = options["bare"];
  settings.full_weight = options["full"];
  settings.curves = options["curves"] != 0;
  settings.intensity = options["intensity"] != 0;
  std::size_t bytes = 0, leaves = 0, samples = 0;
  double encode_time = 0, decode_time = 0;
  Points map_points;
  MapTile surface;
  for (const auto& [key, grid] : grids) {
    double start = seconds();
    const auto tile_samples = grid.samples();
    samples += tile_samples.size();
    const auto coded = encode_surface_tile(tile_samples, settings, side);
    encode_time += seconds() - start;
    start = seconds();
    const auto tile = coded ? decode_surface_tile(*coded) : Result<MapTile>(coded.error());
    decode_time += seconds() - start;
    if (!tile) {
      std::cerr << tile.error().message << '\n';
      return 3;
    }
    bytes += coded->size();
    leaves += tile->leaves.size();
    join(*tile, {key.x * side, key.y * side, 0}, surface);
    for (const MapSample& sample : tile_points(*tile, options["spacing"])) {
      map_points.at.push_back(
          {sample.position.x + key.x * side, sample.position.y + key.y * side, sample.position.z});
    }
  }
  const auto queries = static_cast<std::size_t>(options["queries"]);
  const Distances there = distances(raw, surface, queries),
                  back = distances(map_points, raw, queries);
  const auto f = [&](std::size_t l) {
    const double sum = there.within[l] + back.within[l];
    return sum > 0 ? 2 * there.within[l] * back.within[l] / sum : 0;
  };
  fmt::print(
      "{} B, {} tiles, {} leaves, {} samples of {} points | mean {:.4f} compl {:.3f} {:.3f} "
      "{:.3f} | acc {:.3f} {:.3f} {:.3f} | F {:.3f} {:.3f} {:.3f} | grid {:.2f} encode {:.2f} "
      "decode {:.3f} s\n",
      bytes, grids.size(), leaves, samples, raw.at.size(), there.mean, there.within[0],
      there.within[1], there.within[2], back.within[0], back.within[1], back.within[2], f(0), f(1),
      f(2), grid_time, encode_time, decode_time);
  return 0;
}
