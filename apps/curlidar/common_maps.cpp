// SPDX-License-Identifier: BSD-3-Clause
#include "common_maps.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "curlidar/pose.hpp"

namespace curlidar::app {
namespace {

RigidMotion turn(std::size_t axis, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  if (axis == 0) return {{{{1, 0, 0}, {0, c, -s}, {0, s, c}}}, {}};
  if (axis == 1) return {{{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}}, {}};
  return {{{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}}, {}};
}

PoseTrack poses_of(const ReferenceOptions& options) {
  PoseTrack track = need(read_poses(options.poses, {{}, options.calib, {}}));
  for (const std::string& warning : track.warnings) print_warning(warning);
  if (track.T_map_sensor.size() < options.files.size()) {
    throw Failure({ErrorCode::invalid_argument,
                   fmt::format("{}: {} poses for {} scans; give one for each, in their order",
                               options.poses, track.T_map_sensor.size(), options.files.size())},
                  kExitInput);
  }
  return track;
}

}  // namespace

Json MapTiles::json() const {
  return {{"tiles", of}, {"tiles_read", read}, {"tiles_damaged", damaged}, {"missing", missing}};
}

bool is_map_file(const std::string& path) {
  std::array<char, 64> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  return is_map(std::as_bytes(std::span(first.data(), static_cast<std::size_t>(file.gcount()))));
}

MapFile open_surface_map(const std::string& path, bool allow_truncated) {
  MapReadOptions options;
  options.allow_truncated = allow_truncated;
  MapFile map = need(MapFile::open(path, options));
  if (map.header().kind == MapKind::surface) return map;
  throw Failure({ErrorCode::invalid_argument,
                 fmt::format("{}: a map of scans has no surface to look at; 'curlidar map extract' "
                             "makes a cloud of it, 'curlidar map build --kind surface' a surface",
                             path)},
                kExitInput);
}

MapTiles read_tiles(const MapFile& map, const std::optional<MapBox>& box) {
  MapTiles result;
  result.of = map.tiles().size();
  result.missing = map.missing();
  for (const std::string& missing : result.missing) print_warning(missing);
  std::vector<std::size_t> wanted;
  if (box) wanted = map.parts_in(*box);
  for (std::size_t i = 0; !box && i < result.of; ++i) wanted.push_back(i);
  for (const std::size_t i : wanted) {
    Result<MapTile> tile = map.read_tile(i);
    if (tile) {
      result.tiles.push_back(*std::move(tile));
      ++result.read;
      continue;
    }
    print_warning(fmt::format("{}; the rest of the map is used", tile.error().message));
    ++result.damaged;
  }
  return result;
}

RigidMotion parse_pose(const std::string& text) {
  std::array<double, 6> numbers{};
  std::size_t count = 0, begin = 0;
  bool good = true;
  while (good && count < numbers.size()) {
    const std::size_t comma = text.find(',', begin);
    good = CLI::detail::lexical_cast(text.substr(begin, comma - begin), numbers[count]) &&
           std::isfinite(numbers[count]);
    ++count;
    if (comma == std::string::npos) break;
    begin = comma + 1;
    good = good && count < numbers.size();
  }
  if (!good || (count != 3 && count != 6)) {
    usage_error(
        fmt::format("--pose '{}': give x,y,z in metres and, if it is turned, "
                    "roll,pitch,yaw in degrees: 10,-2,1.7,0,0,90",
                    text));
  }
  RigidMotion pose = turn(2, numbers[5]) * turn(1, numbers[4]) * turn(0, numbers[3]);
  pose.move = {numbers[0], numbers[1], numbers[2]};
  return pose;
}

void add_reference_options(CLI::App& app, ReferenceOptions& options) {
  constexpr double kLargest = 1e6;
  CLI::Option* poses = app.add_option("--poses", options.poses,
                                      "The references are scans with these poses in the map's "
                                      "frame, one each (see docs/poses.md)");
  app.add_option("--calib", options.calib, "KITTI's calib.txt: the poses are those of the camera")
      ->needs(poses);
  app.add_option("--min-range", options.min_range_m,
                 "With --poses: nearer returns do not count, metres")
      ->capture_default_str()
      ->check(number_in(0, kLargest));
  app.add_option("--max-range", options.max_range_m,
                 "With --poses: farther returns do not count, metres")
      ->capture_default_str()
      ->check(number_in(0, kLargest));
  app.add_option("--max-reference", options.max_points,
                 "Of more points of the reference a random subset is taken")
      ->capture_default_str()
      ->check(number_in(1, 4e9));
}

PointSubset read_reference(const ReferenceOptions& options, double spacing_m,
                           const ProgressCallback& progress, std::size_t& damaged) {
  std::optional<PoseTrack> track;
  if (!options.poses.empty()) track = poses_of(options);
  PointSubset points(options.max_points);
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    const std::string& file = options.files[i];
    progress("reference", static_cast<double>(i) / static_cast<double>(options.files.size()));
    if (file != "-" && is_map_file(file)) {
      if (track) usage_error(fmt::format("{} is a map: it needs no --poses", file));
      const MapTiles tiles = read_tiles(open_surface_map(file, false));
      damaged += tiles.damaged;
      const PointSubset surface = need(map_points(tiles.tiles, spacing_m, options.max_points));
      for (const SurfacePoint& point : surface.points()) points.add(point);
      continue;
    }
    const Cloud cloud = load_cloud(file, std::nullopt);
    for (const Vec3& p : cloud.positions) {
      if (!track) {
        points.add({p, {}});
        continue;
      }
      const double range = norm(p);
      if (!is_return(p) || range < options.min_range_m || range > options.max_range_m) continue;
      points.add({track->T_map_sensor[i](p), {}});
    }
  }
  return points;
}

}  // namespace curlidar::app
