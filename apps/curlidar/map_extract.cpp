// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>
#include <unordered_set>

#include "curlidar/reconstruct.hpp"
#include "map.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kExtractFooter = R"(Examples:
  curlidar map extract street.curl -o street.ply
  curlidar map extract street.curl --radius 10,20,0,15 --spacing 0.05 --normals -o corner.pcd
  curlidar map extract street.curl --lod 1 -o coarse.ply
  curlidar map extract keyframes.curl --rows 8 --dedupe 0.05 -o dense.ply
Only the tiles, or scans, that are needed are read.)";

struct ExtractOptions {
  CommonOptions common;
  std::string map, output, to_format, box, radius, tile;
  std::optional<double> density, spacing, dedupe;
  std::optional<std::uint32_t> level;
  std::optional<double> rows, columns;
  std::size_t max_points = 100'000'000;
  bool normals = false, allow_truncated = false;
};

MapExtractSettings settings_of(const ExtractOptions& options) {
  MapExtractSettings settings;
  if (options.density && options.spacing) {
    usage_error("--density and --spacing both say how dense the points are: give one");
  }
  if (options.spacing) settings.spacing_m = *options.spacing;
  if (options.density) settings.spacing_m = 1 / std::sqrt(*options.density);
  if (!options.box.empty()) {
    const auto n = parse_numbers(options.box, "--box", 6);
    settings.box = MapBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (n[0] > n[3] || n[1] > n[4] || n[2] > n[5]) {
      usage_error(
          fmt::format("--box {}: the smaller corner goes first: x0,y0,z0,x1,y1,z1", options.box));
    }
  }
  if (!options.radius.empty()) {
    const auto n = parse_numbers(options.radius, "--radius", 4);
    settings.centre = Vec3{n[0], n[1], n[2]};
    settings.radius_m = n[3];
    if (!(n[3] > 0)) usage_error(fmt::format("--radius {}: r must be above 0", options.radius));
  }
  if (!options.tile.empty()) {
    const auto n = parse_numbers(options.tile, "--tile", 2);
    const auto is_number = [](double k) { return std::abs(k) <= 1 << 20 && k == std::floor(k); };
    if (!is_number(n[0]) || !is_number(n[1])) {
      usage_error(fmt::format("--tile {}: two whole numbers are needed", options.tile));
    }
    settings.tile = TileKey{static_cast<std::int32_t>(n[0]), static_cast<std::int32_t>(n[1])};
  }
  if (options.level) settings.max_level = *options.level;
  settings.normals = options.normals;
  settings.max_points = options.max_points;
  return settings;
}

bool is_inside(const MapExtractSettings& settings, const Vec3& p) {
  if (settings.box) {
    const auto& [low, high] = *settings.box;
    if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y || p.z < low.z || p.z > high.z) {
      return false;
    }
  }
  return !settings.centre || norm(p - *settings.centre) <= settings.radius_m;
}

/// One point for each cube, the first that comes.
class FirstInCube {
 public:
  explicit FirstInCube(std::optional<double> edge_m) : edge_m_(edge_m) {}
  bool operator()(const Vec3& p) {
    if (!edge_m_) return true;
    return seen_.insert({number(p.x), number(p.y), number(p.z)}).second;
  }

 private:
  using Numbers = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Numbers& numbers) const {
      std::uint64_t hash = 0;
      for (const std::int64_t n : numbers) {
        hash = (hash ^ static_cast<std::uint64_t>(n)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
      }
      return static_cast<std::size_t>(hash);
    }
  };
  std::int64_t number(double value) const {
    return static_cast<std::int64_t>(std::clamp(std::floor(value / *edge_m_), -9e18, 9e18));
  }

  std::optional<double> edge_m_;
  std::unordered_set<Numbers, Hash> seen_;
};

/// The scans that reach into the part that is asked for.
std::vector<std::size_t> needed_scans(const MapFile& map, const MapExtractSettings& settings) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  MapBox box = settings.box.value_or(MapBox{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}});
  if (settings.centre) {
    const Vec3& c = *settings.centre;
    const double r = settings.radius_m;
    box.low = {std::max(box.low.x, c.x - r), std::max(box.low.y, c.y - r),
               std::max(box.low.z, c.z - r)};
    box.high = {std::min(box.high.x, c.x + r), std::min(box.high.y, c.y + r),
                std::min(box.high.z, c.z + r)};
  }
  return map.parts_in(box);
}

/// A keyframe with its points where they were taken.
Result<Cloud> placed_scan(const MapFile& map, std::size_t number, const ReconstructSettings& dense,
                          std::size_t threads) {
  const auto scan = map.read_scan(number);
  if (!scan) return scan.error();
  DecodeOptions decoding;
  decoding.threads = threads;
  const auto decoded = decode(scan->file, decoding);
  if (!decoded) return decoded.error();
  Result<Cloud> points = reconstruct(*decoded, dense);
  if (!points) return points;
  for (Vec3& p : points->positions) {
    if (is_return(p)) p = scan->T_map_sensor(p);
  }
  return points;
}

/// What is known of parts that cannot be used, and how the command ends for it.
class DamagedParts {
 public:
  void add(const std::string& what) {
    print_warning(what + "; the rest of the map is used");
    ++count_;
  }
  std::size_t count() const { return count_; }
  int exit_code() const { return count_ > 0 ? kExitInput : kExitOk; }

 private:
  std::size_t count_ = 0;
};

/// All keyframes, reconstructed and put where they were taken. Attributes are left behind.
Cloud extract_scans(const ExtractOptions& options, const MapFile& map,
                    const MapExtractSettings& settings, ProgressBar& bar, DamagedParts& damaged) {
  ReconstructSettings dense;
  dense.rows = options.rows.value_or(1);
  dense.columns = options.columns.value_or(1);
  dense.threads = options.common.threads;
  dense.max_points = options.max_points;
  FirstInCube first(options.dedupe);
  Cloud cloud;
  cloud.position_type = ScalarType::float64;
  std::size_t done = 0;
  const std::vector<std::size_t> needed = needed_scans(map, settings);
  for (const std::size_t i : needed) {
    bar.update(done++, needed.size(), "extract", 0);
    const auto points = placed_scan(map, i, dense, options.common.threads);
    if (!points && points.error().code != ErrorCode::corrupt) need(points);
    if (!points) {
      damaged.add(fmt::format("scan {}: {}", i, points.error().message));
      continue;
    }
    for (const Vec3& p : points->positions) {
      if (!is_return(p) || !is_inside(settings, p)) continue;
      if (first(p - map.header().origin)) cloud.positions.push_back(p);
    }
    if (cloud.size() > options.max_points) {
      throw Failure({ErrorCode::limit_exceeded,
                     fmt::format("more than {} points: fewer rows, --dedupe, or a larger "
                                 "--max-points",
                                 options.max_points)},
                    kExitInput);
    }
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size());
  return cloud;
}

void refuse_other_kind(const ExtractOptions& options, MapKind kind) {
  if (kind == MapKind::surface && (options.rows || options.columns || options.dedupe)) {
    usage_error(
        "--rows, --cols and --dedupe are for maps of scans; this is a surface map, whose "
        "--spacing or --density says how dense its points are");
  }
  if (kind == MapKind::scans && (options.density || options.spacing || options.level ||
                                 !options.tile.empty() || options.normals)) {
    usage_error(
        "--density, --spacing, --lod, --tile and --normals are for surface maps; this is a "
        "map of scans, whose --rows and --cols say how dense its points are");
  }
}

int run_extract(const ExtractOptions& options) {
  const MapExtractSettings settings = settings_of(options);
  WriteOptions writing;
  writing.format = parse_format(options.to_format);
  refuse_mixed_stdout(options.common, options.output);
  refuse_same_file(options.map, options.output);
  const MapFile map = load_map(options.map, options.allow_truncated);
  refuse_other_kind(options, map.header().kind);
  ProgressBar bar(!options.common.quiet);
  DamagedParts damaged;
  Cloud cloud;
  if (map.header().kind == MapKind::surface) {
    const auto progress = [&](std::string_view stage, double fraction) {
      bar.update(0, 1, stage, fraction);
    };
    std::vector<std::string> tiles;
    cloud = need(extract_points(map, settings, progress, &tiles));
    for (const std::string& tile : tiles) damaged.add(tile);
  } else {
    cloud = extract_scans(options, map, settings, bar, damaged);
  }
  bar.clear();
  if (cloud.size() == 0) print_warning("no surface lies there: the cloud is empty");
  save_cloud(options.output, cloud, writing);
  const double bits = cloud.size() == 0 ? 0
                                        : static_cast<double>(map.file_bytes()) * 8 /
                                              static_cast<double>(cloud.size());
  print_result(options.common,
               {{{"output", options.output},
                 {"points", cloud.size()},
                 {"bytes_map", map.file_bytes()},
                 {"parts_damaged", damaged.count()},
                 {"missing", map.missing()},
                 {"bits_per_point_out", bits}},
                fmt::format("{}: {} points\n", options.output, count_text(cloud.size()))},
               options.output == "-");
  return damaged.exit_code();
}

}  // namespace

Command add_map_extract(CLI::App& map) {
  CLI::App* app = map.add_subcommand("extract", "Take points from a map, or from a part of it");
  app->footer(kExtractFooter);
  const auto options = std::make_shared<ExtractOptions>();
  app->add_option("map", options->map, "A map")->required();
  app->add_option("-o,--output", options->output, "The cloud; - is standard output")->required();
  app->add_option("--box", options->box, "Only this part: x0,y0,z0,x1,y1,z1 in metres");
  app->add_option("--radius", options->radius, "Only around a place: x,y,z,r in metres");
  app->add_option("--tile", options->tile, "Only one tile: x,y as 'map info --tiles' names them");
  app->add_option("--density", options->density, "Points a square metre")
      ->check(number_in(1e-6, 1e6));
  app->add_option("--spacing", options->spacing, "Metres between points; default 0.1")
      ->check(number_in(0.001, 1000));
  app->add_option("--lod", options->level,
                  "Level of detail: 0 the largest cubes, each more halves them; default all");
  app->add_flag("--normals", options->normals, "Attributes normal_x, normal_y, normal_z");
  app->add_option("--rows", options->rows, "Maps of scans: factor on the rows of each scan")
      ->check(number_in(kLeastFactor, kMostFactor));
  app->add_option("--cols", options->columns, "Maps of scans: factor on the columns")
      ->check(number_in(kLeastFactor, kMostFactor));
  app->add_option("--dedupe", options->dedupe, "Maps of scans: one point in a cube of this edge, m")
      ->check(number_in(0.001, 1000));
  app->add_option("--max-points", options->max_points, "Refuse larger clouds")
      ->capture_default_str();
  app->add_option("--to-format", options->to_format, "Format of the cloud; default by extension");
  app->add_flag("--allow-truncated", options->allow_truncated,
                "Take a map that is cut off as far as it goes");
  add_common_options(*app, options->common);
  return {app, [options] { return run_extract(*options); }};
}

}  // namespace curlidar::app
