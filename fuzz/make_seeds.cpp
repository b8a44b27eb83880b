// SPDX-License-Identifier: BSD-3-Clause
// Writes the inputs that fuzzing starts from: small simulated scans, encoded in many ways.
//   make_seeds FOLDER    makes FOLDER/TARGET/seed-NAME for every target but cloud
#include <cstdio>
#include <numbers>
#include <string>

#include "codec/compact_decode.hpp"
#include "compact/mask_coder.hpp"
#include "compact/residual_coder.hpp"
#include "compact/scan_encoder.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/simulate.hpp"
#include "hostile/targets/container.hpp"
#include "hostile/targets/decode.hpp"
#include "hostile/targets/density.hpp"
#include "hostile/targets/field.hpp"
#include "hostile/targets/mask.hpp"
#include "hostile/targets/points.hpp"
#include "hostile/targets/residual.hpp"
#include "hostile/targets/scan.hpp"
#include "seeds.hpp"
#include "support/promised_clouds.hpp"
#include "support/ray_tables.hpp"
#include "support/record_chunks.hpp"

namespace curlidar::fuzz {
namespace {

Bytes packed(const std::vector<std::uint8_t>& flags) {
  Bytes bits((flags.size() + 7) / 8);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i] != 0) bits[i / 8] |= std::byte{1} << (i % 8);
  }
  return bits;
}

Cloud scan_of(const char* scene, std::size_t rings, std::uint32_t columns) {
  constexpr double degree = std::numbers::pi / 180;
  SensorProfile sensor;
  sensor.name = "small";
  sensor.columns = columns;
  sensor.fov_up = 10 * degree;
  sensor.fov_down = -20 * degree;
  sensor.max_range_m = 100;
  for (std::size_t i = 0; i < rings; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(rings - 1);
    sensor.rings.push_back({.elevation = (10 - 30 * share) * degree});
  }
  return simulate(**make_scene(scene), sensor).value();
}

EncodeSettings settings_for(Profile profile, double error_m, std::uint32_t columns) {
  EncodeSettings settings;
  settings.profile = profile;
  settings.compact.columns = columns;
  settings.compact.target_value = error_m;
  settings.compact.effort = 2;
  settings.paper = for_profile(settings.paper, profile);
  settings.paper.columns = columns;
  settings.paper.min_range_m = 1;
  settings.paper.max_range = {};
  settings.paper.global_degree = 6;
  settings.attributes = std::vector<std::string>{"intensity"};
  return settings;
}

/// The chunks of a file behind a header: of all types, or of those of a compact scan.
Bytes reframed(ByteSpan file, std::initializer_list<std::size_t> header, bool scan_only) {
  Bytes out;
  append(out, header);
  const std::vector<Chunk> chunks = read_container(file).value();
  for (const Chunk& chunk : chunks) {
    const auto type = static_cast<std::uint8_t>(chunk.type);
    if (scan_only && (type < 0x10 || type > 0x16)) continue;
    test::write_fuzz_chunk(scan_only ? static_cast<std::uint8_t>(type - 0x10) : type, chunk.payload,
                           out);
  }
  return out;
}

void write_files(const Seeds& seeds) {
  const Profile paper[] = {Profile::paper, Profile::paper_1to1, Profile::paper_global};
  for (const Profile profile : paper) {
    const auto file = encode(scan_of("room", 6, 32), settings_for(profile, 0.05, 32))->bytes;
    seeds.write("decode", to_string(profile), reframed(file, {0, 0}, false));
  }
  for (const char* scene : {"street", "room", "forest"}) {
    for (const double error_m : {0.05, 0.005}) {
      const std::string name = std::string(scene) + (error_m < 0.01 ? "-fine" : "");
      EncodeSettings settings = settings_for(Profile::compact, error_m, 64);
      const Cloud scan = scan_of(scene, 12, 64);
      seeds.write("decode", name, reframed(encode(scan, settings)->bytes, {4, 0}, false));
      settings.attributes = std::vector<std::string>{};
      const auto file = encode(scan, settings)->bytes;
      seeds.write("decode", name + "-part", reframed(file, {7, 0}, false));
      seeds.write("decode", name + "-cut", reframed(file, {8, 200}, false));
      seeds.write("scan", name, reframed(file, {test::kNodes, 0, 0, 0, 0}, true));
    }
  }
}

/// A small cloud, and the sensor that says what its rays are.
struct RecordSource {
  const char* name;
  Cloud cloud;
  std::optional<SensorProfile> sensor{};
};

std::vector<RecordSource> record_sources() {
  const SensorProfile sensor = test::exact_sensor(6, 48);
  Cloud rays = test::with_second_returns(
      test::exact_scan(sensor),
      [](std::size_t i, const Vec3& p) { return i % 20 == 0 ? p * 1.5 : Vec3{}; });
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Cloud typed = test::with_holes(test::unsteady_scan(4, 10), 9, {nan, nan, nan});
  test::add_all_types(typed);
  Cloud box = test::clouds_without_rings().front().cloud;
  box = select(box, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19});
  box.positions[5] = {0, 0, 0};
  return {{"rays", std::move(rays), sensor},
          {"rings", test::unsteady_scan(6, 64)},
          {"organised", test::organised_scan(6, 40)},
          {"typed", std::move(typed)},
          {"loose", std::move(box)}};
}

/// Files with every return: whole, without residuals, in part and cut off.
void write_record_files(const Seeds& seeds) {
  for (const RecordSource& source : record_sources()) {
    for (const CompactTarget target :
         {CompactTarget::error, CompactTarget::max_error, CompactTarget::lossless}) {
      EncodeSettings settings;
      settings.sensor = source.sensor;
      settings.compact.target = target;
      settings.compact.effort = 1;
      const auto file = encode(source.cloud, settings)->bytes;
      const std::string name =
          std::string("records-") + source.name + "-" + std::to_string(static_cast<int>(target));
      seeds.write("decode", name, reframed(file, {4, 0}, false));
      if (target != CompactTarget::max_error) continue;
      seeds.write("decode", name + "-part", reframed(file, {3, 0}, false));
      seeds.write("decode", name + "-cut", reframed(file, {8, 200}, false));
    }
  }
}

/// Images of simulated scans, as the parts below take them.
CompactImage image_of(const char* scene, std::size_t rings, std::uint32_t columns) {
  const auto file =
      encode(scan_of(scene, rings, columns), settings_for(Profile::compact, 0.005, columns))->bytes;
  return *decode_compact_image(file, {});
}

void write_scans(const Seeds& seeds, const std::string& scene, const CompactImage& scan) {
  for (const std::int32_t residual_step : {0, 700}) {
    for (const std::uint32_t cuts : {1u, 2u}) {
      compact::ScanSettings settings;
      settings.steps = {4000, residual_step, 0, 3, 4};
      settings.effort = 2;
      settings.bands = settings.sectors = cuts;
      settings.threads = 1;
      const auto encoded = encode_scan(scan.image, scan.table, settings);
      Bytes out;
      append(out,
             {residual_step == 0 ? test::kRegion : test::kIncomplete | test::kTorn, 3, 7, 5, 50});
      for (const compact::ScanChunk& chunk : encoded->chunks) {
        test::write_fuzz_chunk(static_cast<std::uint8_t>(static_cast<unsigned>(chunk.part) - 0x10),
                               chunk.payload, out);
      }
      seeds.write("scan", scene + "-" + std::to_string(residual_step) + "-" + std::to_string(cuts),
                  out);
    }
  }
}

std::vector<std::uint8_t> mask_of(const compact::Image& image) {
  std::vector<std::uint8_t> mask;
  for (const std::int32_t range : image.range) mask.push_back(range > 0 ? 1 : 0);
  return mask;
}

/// The image of a scan on rays: rows of a frozen table or written out, columns a firing each.
void write_ray_scans(const Seeds& seeds, const std::string& scene, const compact::Image& image) {
  for (const std::uint32_t frozen : {0u, 1u, 3u}) {
    compact::RowTable table = frozen == 0   ? test::inline_rays(12, test::turning(512, 8, 3), 512)
                              : frozen == 1 ? test::frozen_rays(1, test::turning(4000, 62.5, 0))
                                            : test::frozen_rays(3, test::turning(2000, 31.25, 0));
    if (frozen != 3) test::set_motion(*table.rays, frozen == 0);
    compact::Image rays{test::rows_of(table), table.turn_columns, {}};
    for (std::uint32_t row = 0; row < rays.rows; ++row) {
      for (std::uint32_t column = 0; column < rays.columns; ++column) {
        const bool inside = row < image.rows && column < image.columns;
        rays.range.push_back(inside ? image.range[row * image.columns + column] : 0);
      }
    }
    compact::ScanSettings settings;
    settings.steps = {4000, frozen == 0 ? 700 : 0, 0, 3, 4};
    settings.effort = 2;
    settings.bands = settings.sectors = frozen == 1 ? 2 : 1;
    settings.threads = 1;
    const auto encoded = encode_scan(rays, table, settings);
    Bytes out;
    append(out, {frozen == 3 ? test::kRegion : 0u, 3, 7, 5, 50});
    for (const compact::ScanChunk& chunk : encoded->chunks) {
      test::write_fuzz_chunk(static_cast<std::uint8_t>(static_cast<unsigned>(chunk.part) - 0x10),
                             chunk.payload, out);
    }
    seeds.write("scan", scene + "-rays-" + std::to_string(frozen), out);
    Bytes alone;
    const std::size_t columns = rays.columns - 1;
    append(alone, {rays.rows - 1, columns, columns >> 8});
    append(alone, write_rays(table));
    seeds.write("rays", std::to_string(frozen), alone);
  }
}

void write_masks(const Seeds& seeds, const std::string& scene, const compact::Image& image) {
  const std::size_t rows = image.rows, columns = image.columns;
  for (const std::size_t options : {0u, 1u, 5u}) {
    const std::size_t turns[] = {columns, 2 * columns, 2048, std::size_t{1} << 22};
    Bytes out;
    append(out, {rows - 1, columns - 1, options});
    append(out, compact::encode_mask(mask_of(image), {rows, columns, turns[options >> 1]}, true));
    seeds.write("mask", scene + "-" + std::to_string(options), out);
  }
}

void write_fields(const Seeds& seeds, const std::string& scene, const compact::Image& image) {
  for (const std::size_t step : {65536u, 6554u, 655u}) {
    for (const std::size_t root_log2 : {3u, 4u, 5u}) {
      const std::size_t smallest = root_log2 == 3 ? 1 : 8;
      Bytes out;
      append(out, {step - 1, (step - 1) >> 8, (step - 1) >> 16, root_log2 - 1, smallest - 1, 0,
                   image.rows - 1, image.columns - 1, 1u << 4});
      append(out, packed(mask_of(image)));
      const test::FieldInput input = test::field_input(out);
      compact::FieldState state(input.geometry, input.occupied, input.settings);
      compact::SearchSettings search;
      search.lambda = static_cast<std::int64_t>(step * 17 / 100);
      append(out, encode_field(state, image.range, search).bytes);
      seeds.write("field", scene + "-" + std::to_string(step) + "-" + std::to_string(root_log2),
                  out);
    }
  }
}

void write_residuals(const Seeds& seeds, const std::string& scene, const compact::Image& image) {
  for (const std::size_t kinds : {0x04u, 0x05u, 0x16u, 0x45u, 0x85u}) {
    const std::size_t step = 500;
    Bytes out;
    append(out, {image.rows - 1, image.columns - 1, kinds, step - 1, (step - 1) >> 8, 0, 7});
    append(out, packed(mask_of(image)));
    if ((kinds >> 4 & 3) == 1) append(out, packed(mask_of(image)));
    const test::ResidualInput input = test::residual_input(out);
    std::vector<std::int32_t> ranges = image.range, decoded(ranges.size());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if ((kinds & 3) == 1) ranges[i] = input.field[i] + (ranges[i] - input.field[i]) / 64;
    }
    append(out, encode_residual(input.segment(), ranges, input.levels, {}, decoded));
    seeds.write("residual", scene + "-" + std::to_string(kinds), out);
  }
}

void write_records_chunks(const Seeds& seeds) {
  for (const auto& [name, bytes] : test::order_inputs()) seeds.write("order", name, bytes);
  for (const auto& [name, bytes] : test::records_inputs()) seeds.write("records", name, bytes);
}

/// Loose points and corrections of a simulated scan, each exact, within a bound, and of doubles.
void write_points(const Seeds& seeds) {
  std::vector<Vec3> points;
  for (const Vec3& p : scan_of("room", 12, 64).positions) {
    if (is_return(p) && points.size() < 120) {
      points.push_back({round_to_float32(p.x), round_to_float32(p.y), round_to_float32(p.z)});
    }
  }
  points[7] = {0x1p100, 0, 0};
  const std::vector<Vec3> predicted = test::made_up_points(points.size());
  for (const ScalarType type : {ScalarType::float32, ScalarType::float64}) {
    for (const double bound : {0.0, 0.01}) {
      const std::string name = std::string(to_string(type)) + (bound > 0 ? "-bound" : "");
      seeds.write("loose", name, encode_loose(points, type, {bound, 0})->bytes);
      Bytes out;
      append(out, {points.size(), static_cast<std::size_t>(type)});
      append(out, encode_corrections(predicted, points, type, {bound})->bytes);
      seeds.write("corrections", name, out);
    }
  }
  for (const std::size_t options : {0u, 2u, 0x17u}) {
    Bytes out;
    append(out, {12, 24, options, 200, 1});
    for (std::size_t i = 0; i < 300; ++i) append(out, {test::mixed(i) >> 24});
    seeds.write("directions", std::to_string(options), out);
  }
}

/// Texts of profiles with tables, with trees, and of nothing.
void write_density(const Seeds& seeds) {
  const auto write = [&](const std::string& name, const DensityProfile& profile) {
    const std::string text = density_profile_text(profile);
    const ByteSpan bytes = std::as_bytes(std::span(text));
    seeds.write("density", name, {bytes.begin(), bytes.end()});
  };
  write("empty", {});
  DensityProfile tower = test::tower_profile();
  tower.bias_mm.row(2).fill(200);
  tower.return_permille.row(3).fill(300);
  write("tower", tower);
  tower.returns = test::one_question(kRowFeatures, kPlainFeatures, 4, -100, 100);
  tower.residual = test::one_question(kRowFeatures, 5, 8, -10, 10, 1e-3);
  tower.confidence = test::one_question(kPlainFeatures, 5, 8, 100, -100);
  tower.row_confidence = test::one_question(kRowFeatures, 5, 8, 100, -100);
  write("trees", tower);
}

void write_all(const Seeds& seeds) {
  write_density(seeds);
  write_records_chunks(seeds);
  write_files(seeds);
  write_record_files(seeds);
  write_points(seeds);
  for (const char* scene : {"street", "room"}) {
    const CompactImage scan = image_of(scene, 12, 64);
    write_scans(seeds, scene, scan);
    write_ray_scans(seeds, scene, scan.image);
    write_masks(seeds, scene, scan.image);
    write_fields(seeds, scene, scan.image);
    write_residuals(seeds, scene, scan.image);
  }
  write_drive_seeds(seeds);
  seeds.write("container", "every-chunk", test::whole_file());
}

}  // namespace
}  // namespace curlidar::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_seeds FOLDER\n", stderr);
    return 2;
  }
  curlidar::fuzz::write_all(curlidar::fuzz::Seeds(argv[1]));
  return 0;
}
