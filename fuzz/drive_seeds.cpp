// SPDX-License-Identifier: BSD-3-Clause
// Seeds made of more than one scan: predicted scans, tiles and maps of surfaces, maps of scans,
// sequences.
#include "curlidar/io.hpp"
#include "curlidar/map.hpp"
#include "hostile/targets/surface.hpp"
#include "seeds.hpp"
#include "support/predicted_inputs.hpp"
#include "support/sequences.hpp"
#include "support/surface_scenes.hpp"

namespace curlidar::fuzz {
namespace {

constexpr std::size_t kRings = 6;
constexpr std::uint32_t kColumns = 40;

/// A short drive of few points.
std::vector<Cloud> short_drive(std::size_t scans) {
  std::vector<Cloud> clouds;
  for (std::size_t i = 0; i < scans; ++i) {
    clouds.push_back(
        test::scan_of(test::small_sensor(kRings, kColumns), 0.3 * static_cast<double>(i), i + 1));
  }
  return clouds;
}

RigidMotion pose_of(std::size_t scan) {
  RigidMotion pose;
  pose.move = {100 + 0.3 * static_cast<double>(scan), -50, 2};
  return pose;
}

/// The bytes that `make` writes to the file whose name it is given.
template <class Make>
Bytes bytes_of(const Make& make) {
  const std::string path = (std::filesystem::temp_directory_path() / "curlidar-seed.curl").string();
  make(path);
  Bytes bytes = read_file(path).value();
  std::filesystem::remove(path);
  return bytes;
}

void write_tiles(const Seeds& seeds) {
  SurfaceSettings bent;
  bent.curves = bent.intensity = true;
  const std::pair<const char*, std::vector<MapSample>> scenes[] = {
      {"plane", test::plane_samples(16, 0.05)},
      {"box", test::box_samples(16)},
      {"sphere", test::sphere_samples(16)}};
  for (const auto& [name, samples] : scenes) {
    for (const bool curves : {false, true}) {
      Bytes out;
      append(out, {2});
      append(out, encode_surface_tile(samples, curves ? bent : SurfaceSettings{}, 16).value());
      seeds.write("surface", std::string(name) + (curves ? "-curves" : ""), out);
    }
  }
}

EncodeSettings scan_settings() {
  EncodeSettings settings = test::drive_settings(1).encode;
  settings.sensor = test::small_sensor(kRings, kColumns);
  return settings;
}

void write_maps(const Seeds& seeds) {
  for (const MapKind kind : {MapKind::surface, MapKind::scans}) {
    MapBuildSettings settings;
    settings.header.kind = kind;
    settings.header.min_range_m = 1;
    settings.header.max_range_m = 30;
    settings.header.metadata = {{"place", "street"}};
    settings.scan = scan_settings();
    const Bytes bytes = bytes_of([&](const std::string& path) {
      MapBuilder builder = MapBuilder::create(settings).value();
      const std::vector<Cloud> clouds = short_drive(3);
      for (std::size_t i = 0; i < clouds.size(); ++i) {
        builder.add_scan(clouds[i], pose_of(i), 0.1 * static_cast<double>(i)).value();
      }
      builder.finish(path).value();
    });
    seeds.write("map", to_string(kind), bytes);
  }
}

void write_sequence(const Seeds& seeds, const std::string& name, const SequenceSettings& settings,
                    bool stamps) {
  seeds.write("sequence", name, bytes_of([&](const std::string& path) {
                SequenceWriter writer = SequenceWriter::create(path, settings).value();
                const std::vector<Cloud> clouds = short_drive(3);
                for (std::size_t i = 0; i < clouds.size(); ++i) {
                  ScanStamp stamp;
                  if (stamps) stamp = {0.1 * static_cast<double>(i), pose_of(i)};
                  writer.add(clouds[i], stamp).value();
                }
                if (stamps) writer.add(Cloud{}, {0.3, pose_of(3)}).value();
                writer.finish().value();
              }));
}

void write_sequences(const Seeds& seeds) {
  SequenceSettings settings;
  settings.encode = scan_settings();
  settings.group = 2;
  write_sequence(seeds, "stamps", settings, true);
  settings.group = 8;
  write_sequence(seeds, "one-group", settings, false);
  settings.still = true;
  settings.encode.attributes.reset();
  settings.encode.compact.target = CompactTarget::max_error;
  settings.encode.compact.target_value = 0.05;
  write_sequence(seeds, "bound", settings, false);
  settings.encode.compact.coverage = Coverage::image;
  settings.encode.compact.columns = kColumns;
  settings.encode.compact.target = CompactTarget::error;
  write_sequence(seeds, "images", settings, true);
}

}  // namespace

void write_drive_seeds(const Seeds& seeds) {
  for (const bool residuals : {false, true}) {
    seeds.write("predicted", residuals ? "residuals" : "street", test::predicted_input(residuals));
  }
  write_tiles(seeds);
  write_maps(seeds);
  write_sequences(seeds);
}

}  // namespace curlidar::fuzz
