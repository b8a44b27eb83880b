// SPDX-License-Identifier: BSD-3-Clause
#include "decode_plan.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>

#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

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
  if (command.attributes != "all" && command.attributes != "none") {
    usage_error("--mesh writes no attributes of the file: leave --attributes out");
  }
}

/// Of --format, else of the extension; nullopt: as the default is.
std::optional<MeshFormat> parse_mesh_format(const DecodeCommand& command) {
  if (command.format == "ply") return MeshFormat::ply;
  if (command.format == "obj") return MeshFormat::obj;
  const bool by_name = command.inputs.size() == 1 && !command.output.empty() &&
                       command.output != "-" && !is_directory(command.output);
  const auto format = by_name ? mesh_format_by_extension(command.output) : std::nullopt;
  if (!command.format.empty() || (by_name && !format)) {
    usage_error("--mesh writes .ply or .obj, by the extension of -o or --format ply, obj");
  }
  return format;
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

}  // namespace

DecodePlan::DecodePlan(const DecodeCommand& command) : command_(command) {
  check_ways(command);
  check_mesh(command);
  if (command.mesh) {
    mesh_format_ = parse_mesh_format(command);
  } else {
    writing_.format = parse_output_format(command.format);
  }
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
  if (command_.mesh) return mesh_format_ == MeshFormat::obj ? ".decoded.obj" : ".decoded.ply";
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

bool DecodePlan::invents(const ReconstructSettings& settings) const {
  return command_.mesh || command_.density || directions_ || sensor_ || !settings.masks ||
         settings.rows != 1 || settings.columns != 1;
}

ReconstructSettings DecodePlan::settings(const DecodedScan& scan) const {
  const bool sparse = command_.preset == "sparse";
  const bool has_room = !command_.organised && !command_.mesh && !sensor_ && !directions_;
  const double missing = kSparseRows / static_cast<double>(scan.field->lattice().rows());
  ReconstructSettings settings;
  settings.rows = command_.rows.value_or(sparse ? std::max(1.0, missing) : 1.0);
  settings.columns = command_.columns.value_or(1.0);
  settings.masks = !command_.no_masks;
  settings.organised = command_.organised;
  settings.strategy = strategy_.value_or(sparse ? DenseStrategy::best : usual_strategy(scan));
  settings.density_profile = profile_;
  const bool told = settings.strategy == DenseStrategy::best;
  settings.min_confidence =
      command_.min_confidence.value_or(sparse && told ? kSparseConfidence : 0.0);
  settings.confidence = command_.confidence;
  settings.normals = command_.normals;
  settings.keep_originals = command_.keep_originals || (sparse && has_room);
  settings.original = command_.original;
  settings.region = decoding_.region;
  settings.threads = command_.common.threads;
  settings.max_points = command_.max_points;
  const bool has_field = !scan.records || scan.records->lattice != RecordLattice::none;
  if (!has_field) return settings;
  if (invents(settings)) need_option(check_settings(scan, settings));
  if (profile_) need(check_density_profile(*profile_, *scan.field));
  return settings;
}

Cloud DecodePlan::cloud(const DecodedScan& scan, const ReconstructSettings& settings,
                        const ProgressCallback& progress) const {
  Cloud cloud;
  if (directions_) {
    cloud = need(reconstruct_directions(scan, directions_->positions, settings, progress));
    cloud.width = directions_->width;
    cloud.height = directions_->height;
  } else if (sensor_) {
    cloud = need(reconstruct_sensor(scan, *sensor_, settings, progress));
  } else if (command_.density) {
    cloud = need(reconstruct_density(scan, *command_.density, settings, progress));
  } else {
    cloud = need(reconstruct(scan, settings, progress));
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
