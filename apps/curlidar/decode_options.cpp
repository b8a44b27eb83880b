// SPDX-License-Identifier: BSD-3-Clause
#include "decode_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>

namespace curlidar::app {
namespace {

/// Below it the rows that a sparse scan lacks are too often wrong: 16 rings of a simulated street
/// at 64 rows keep four fifths of their points and lose half of their 95th percentile of error.
constexpr double kSparseConfidence = 0.2;
/// Rows that a sparse scan is brought to.
constexpr double kSparseRows = 64;

/// "A:B" as two numbers.
template <class T>
std::pair<T, T> parse_interval(const std::string& text, const char* option, const char* example) {
  const std::size_t colon = text.find(':');
  std::pair<T, T> ends;
  const bool good =
      colon != std::string::npos && CLI::detail::lexical_cast(text.substr(0, colon), ends.first) &&
      CLI::detail::lexical_cast(text.substr(colon + 1), ends.second) && ends.first < ends.second;
  if (!good) {
    usage_error(fmt::format("{} '{}': give BEGIN:END, the smaller number first, such as {}", option,
                            text, example));
  }
  return ends;
}

/// What --region, or --rings and --azimuth, say as texts; empty = all.
std::pair<std::string, std::string> region_texts(const DecodeCommand& command) {
  if (command.region.empty()) return {command.rings, command.azimuth};
  if (!command.rings.empty() || !command.azimuth.empty()) {
    usage_error("--region holds both rings and azimuths: leave --rings and --azimuth out");
  }
  const std::size_t comma = command.region.find(',');
  if (comma == std::string::npos) {
    usage_error(
        fmt::format("--region '{}': give RINGS,AZIMUTHS, such as 16:48,-45:45", command.region));
  }
  return {command.region.substr(0, comma), command.region.substr(comma + 1)};
}

std::optional<ScanRegion> parse_region(const DecodeCommand& command) {
  const auto [rings, azimuth] = region_texts(command);
  const bool together = !command.region.empty();
  if (!together && rings.empty() && azimuth.empty()) return std::nullopt;
  ScanRegion region;
  if (together || !rings.empty()) {
    std::tie(region.ring_begin, region.ring_end) =
        parse_interval<std::uint32_t>(rings, together ? "--region" : "--rings", "0:16");
  }
  if (together || !azimuth.empty()) {
    const auto [begin, end] =
        parse_interval<double>(azimuth, together ? "--region" : "--azimuth", "-45:45");
    if (!(begin >= -360 && end <= 720)) {
      usage_error(fmt::format("azimuths '{}': degrees, from -360 to 720", azimuth));
    }
    region.azimuth_begin = begin * std::numbers::pi / 180;
    region.azimuth_end = end * std::numbers::pi / 180;
  }
  return region;
}

std::optional<DenseStrategy> parse_strategy(const std::string& name) {
  if (name.empty()) return std::nullopt;
  if (name == "best") return DenseStrategy::best;
  if (name == "masks") return DenseStrategy::masks;
  usage_error(fmt::format("--strategy '{}': give best or masks", name));
}

/// Options that say which points are wanted are one way each.
void check_ways(const DecodeCommand& command) {
  std::vector<std::string> ways;
  if (command.rows || command.columns) ways.emplace_back("--rows/--cols");
  if (command.density) ways.emplace_back("--density");
  if (!command.directions.empty()) ways.emplace_back("--directions");
  if (!command.sensor.empty()) ways.emplace_back("--sensor");
  if (ways.size() > 1) {
    usage_error(
        fmt::format("{} and {} each choose the points: give one of them", ways[0], ways[1]));
  }
  const bool grid = ways.empty() || ways[0] == "--rows/--cols";
  if (command.mesh && !grid) {
    usage_error(
        fmt::format("--mesh joins the points of a grid: --rows and --cols, not {}", ways[0]));
  }
  if (command.organised && !grid && command.sensor.empty()) {
    usage_error(fmt::format("--organised keeps a grid, and {} makes none", ways[0]));
  }
  if (command.keep_originals && (!command.directions.empty() || !command.sensor.empty())) {
    usage_error(
        fmt::format("--keep-originals goes with grids and densities, not with {}", ways[0]));
  }
  if (command.keep_originals && command.organised) {
    usage_error("--keep-originals: the returns lie beside the cells that --organised keeps");
  }
}

void check_mesh(const DecodeCommand& command) {
  if (!command.mesh) return;
  if (command.organised || command.keep_originals || command.original || command.confidence) {
    usage_error(
        "--mesh writes vertices and triangles: leave --organised, --keep-originals, "
        "--original and --confidence out");
  }
  const bool known = command.output.empty() || command.output == "-" ||
                     command.output.ends_with('/') || command.output.ends_with(".ply") ||
                     command.output.ends_with(".obj") || command.inputs.size() > 1;
  if (!known || (!command.format.empty() && command.format != "ply")) {
    usage_error("--mesh writes .ply or .obj, by the extension of -o");
  }
}

/// "bin" is what people call KITTI's format.
std::optional<CloudFormat> parse_output_format(const std::string& name) {
  return parse_format(name == "bin" ? "kitti" : name);
}

Cloud read_directions(const std::string& path) {
  const Cloud cloud = need(read_cloud(path));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) continue;
    throw Failure({ErrorCode::invalid_argument,
                   fmt::format("{}: direction {} (counted from 0) is zero or not finite", path, i)},
                  kExitInput);
  }
  return cloud;
}

void add_point_options(CLI::App& app, DecodeCommand& command) {
  const auto factor = number_in(1e-3, 65536.0);
  const char* group = "Which points";
  app.add_option("--rows", command.rows,
                 "R_row: factor on the coded grid's rows, may be fractional; default 1")
      ->check(factor)
      ->group(group);
  app.add_option("--cols", command.columns, "R_col: the same for columns; default 1")
      ->check(factor)
      ->group(group);
  app.add_option("--density", command.density,
                 "So many points on every square metre of surface, near or far: gaps are filled, "
                 "what is denser is thinned")
      ->check(number_in(1e-3, 1e8))
      ->type_name("POINTS_PER_M2")
      ->group(group);
  app.add_option("--directions", command.directions,
                 "A point for each of these N x 3 directions of any length, in their order, NaN "
                 "where there is none")
      ->type_name("FILE.npy")
      ->group(group);
  app.add_option("--sensor", command.sensor,
                 "The scan as another sensor sees it: a built-in name (see 'curlidar sensors'), or "
                 "a .toml or Ouster .json file")
      ->group(group);
  app.add_flag("--mesh", command.mesh,
               "Triangles between neighbouring points of the grid, cliffs cut: PLY, or OBJ by the "
               "extension of -o")
      ->group(group);
  app.add_flag("--keep-originals", command.keep_originals,
               "All returns of the file first, exactly; invented points only around them")
      ->group(group);
  app.add_flag("--organised,--organized", command.organised,
               "Keep the grid: rows x columns points, NaN where there is none")
      ->group(group);
  app.add_option("--max-points", command.max_points, "Refuse to make more points than this")
      ->capture_default_str()
      ->group(group);
}

void add_belief_options(CLI::App& app, DecodeCommand& command) {
  const char* group = "What is believed";
  app.add_option("--min-confidence", command.min_confidence,
                 "Leave invented points out whose range is within 5 cm with a smaller probability "
                 "than this")
      ->check(number_in(0.0, 1.0))
      ->group(group);
  app.add_option("--strategy", command.strategy,
                 "Between the returns: best, or masks (the file's own: cliffs and gaps of the "
                 "paper); default best, of the paper's profiles masks")
      ->group(group);
  app.add_option("--density-profile", command.density_profile,
                 "What scans of the sensor have taught about the places between its rings: a "
                 "built-in name or a .toml file")
      ->type_name("NAME|FILE")
      ->group(group);
  app.add_flag("--no-masks", command.no_masks,
               "A point for every direction, also where no surface is to be believed")
      ->group(group);
  app.add_option(
         "--preset", command.preset,
         fmt::format("sparse: scans of 16 or 32 rings at {:g} rows (--rows 4, 2), "
                     "--min-confidence {:g}, returns kept; options given have the last word",
                     kSparseRows, kSparseConfidence))
      ->check(CLI::IsMember({"sparse"}))
      ->group(group);
}

void add_attribute_options(CLI::App& app, DecodeCommand& command) {
  const char* group = "What comes with them";
  app.add_option("--attributes", command.attributes,
                 "Attributes to write: all, none, or names such as intensity,ring")
      ->capture_default_str()
      ->group(group);
  app.add_flag("--confidence", command.confidence,
               "Attribute confidence: probability that the range is within 5 cm; of returns 1")
      ->group(group);
  app.add_flag("--normals", command.normals,
               "Attributes normal_x, normal_y, normal_z of the surface, towards the sensor, NaN "
               "where unknown")
      ->group(group);
  app.add_flag("--original", command.original,
               "Attribute original: 1 of returns, 0 of invented points")
      ->group(group);
}

void add_part_options(CLI::App& app, DecodeCommand& command) {
  const char* group = "Which part of the file";
  app.add_option("--rings", command.rings,
                 "Only rings BEGIN .. END-1, 0 the highest (compact files)")
      ->type_name("BEGIN:END")
      ->group(group);
  app.add_option("--azimuth", command.azimuth,
                 "Only azimuths from BEGIN counter-clockwise to END, degrees, 0 ahead (compact "
                 "files)")
      ->type_name("BEGIN:END")
      ->group(group);
  app.add_option("--region", command.region, "Both at once, such as 16:48,-45:45")
      ->type_name("RINGS,AZIMUTHS")
      ->group(group);
  app.add_flag("--field-only", command.field_only,
               "Leave residuals and corrections out (compact files)")
      ->group(group);
  app.add_flag("--allow-truncated", command.allow_truncated,
               "Take files that are cut off as far as they go, with a warning of what is missing")
      ->group(group);
}

}  // namespace

void add_decode_options(CLI::App& app, DecodeCommand& command) {
  app.add_option("inputs", command.inputs, ".curl files; - is standard input")->required();
  app.add_option("-o,--output", command.output,
                 "File, or directory for many inputs; default NAME.decoded.pcd beside the input, "
                 "- is standard output");
  app.add_option("--format", command.format,
                 fmt::format("Format of the output: {}; default by extension", kFormatNames));
  app.add_option("--encoding", command.encoding,
                 "ascii, binary, binary_compressed (PCD) or binary_big_endian (PLY)")
      ->capture_default_str();
  add_point_options(app, command);
  add_belief_options(app, command);
  add_attribute_options(app, command);
  add_part_options(app, command);
  add_common_options(app, command.common);
}

DecodePlan::DecodePlan(const DecodeCommand& command) : command_(command) {
  check_ways(command);
  check_mesh(command);
  writing_.format = command.mesh ? std::nullopt : parse_output_format(command.format);
  writing_.encoding = parse_encoding(command.encoding);
  attributes_ = parse_attribute_list(command.attributes);
  strategy_ = parse_strategy(command.strategy);
  decoding_.field_only = command.field_only;
  decoding_.allow_truncated = command.allow_truncated;
  decoding_.threads = command.common.threads;
  decoding_.region = parse_region(command);
  if (!command.density_profile.empty()) {
    profile_ = need_option(load_density_profile(command.density_profile));
  }
  if (!command.sensor.empty()) sensor_ = need_option(load_sensor(command.sensor));
  if (!command.directions.empty()) directions_ = read_directions(command.directions);
}

const char* DecodePlan::suffix() const {
  if (command_.mesh) return ".decoded.ply";
  switch (writing_.format.value_or(CloudFormat::pcd)) {
    case CloudFormat::pcd:
      return ".decoded.pcd";
    case CloudFormat::ply:
      return ".decoded.ply";
    case CloudFormat::kitti:
      return ".decoded.bin";
    case CloudFormat::nuscenes:
      return ".decoded.pcd.bin";
    case CloudFormat::npy:
      return ".decoded.npy";
    case CloudFormat::csv:
      return ".decoded.csv";
  }
  return ".decoded.pcd";
}

ReconstructSettings DecodePlan::settings(const DecodedScan& scan) const {
  const bool sparse = command_.preset == "sparse";
  const bool has_room = !command_.organised && !command_.mesh && !sensor_ && !directions_;
  if (profile_) need(check_density_profile(*profile_, *scan.field));
  const double missing = kSparseRows / static_cast<double>(scan.field->lattice().rows());
  ReconstructSettings settings;
  settings.rows = command_.rows.value_or(sparse ? std::max(1.0, missing) : 1.0);
  settings.columns = command_.columns.value_or(1.0);
  settings.masks = !command_.no_masks;
  settings.organised = command_.organised;
  settings.strategy = strategy_;
  settings.density_profile = profile_;
  settings.min_confidence = command_.min_confidence.value_or(sparse ? kSparseConfidence : 0.0);
  settings.confidence = command_.confidence;
  settings.normals = command_.normals;
  settings.keep_originals = command_.keep_originals || (sparse && has_room);
  settings.original = command_.original;
  settings.region = decoding_.region;
  settings.threads = command_.common.threads;
  settings.max_points = command_.max_points;
  return settings;
}

Cloud DecodePlan::cloud(const DecodedScan& scan, const ProgressCallback& progress) const {
  const ReconstructSettings how = settings(scan);
  Cloud cloud;
  if (directions_) {
    cloud = need(reconstruct_directions(scan, directions_->positions, how, progress));
    cloud.width = directions_->width;
    cloud.height = directions_->height;
  } else if (sensor_) {
    cloud = need(reconstruct_sensor(scan, *sensor_, how, progress));
  } else if (command_.density) {
    cloud = need(reconstruct_density(scan, *command_.density, how, progress));
  } else {
    cloud = need(reconstruct(scan, how, progress));
  }
  keep_wanted(cloud);
  return cloud;
}

void DecodePlan::keep_wanted(Cloud& cloud) const {
  if (!attributes_) return;
  std::vector<std::string> names = *attributes_;
  const auto add = [&](bool wanted, const char* name) {
    if (wanted && std::find(names.begin(), names.end(), name) == names.end()) {
      names.emplace_back(name);
    }
  };
  add(command_.confidence, "confidence");
  add(command_.original, "original");
  add(command_.normals, "normal_x");
  add(command_.normals, "normal_y");
  add(command_.normals, "normal_z");
  keep_attributes(cloud, names);
}

}  // namespace curlidar::app
