// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/reconstruct.hpp"
#include "curlidar/render.hpp"
#include "curlidar/simulate.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter =
    R"(Everything is simulated, so that nothing needs to be downloaded and the
truth is known exactly: the simulator answers for every direction of the dense reconstruction.)";

struct Options {
  CommonOptions common;
  std::string output = "demo-out", scene = "street", sensor = "hdl64e-kitti";
  std::uint64_t seed = 1;
};

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// One reconstruction and how far it is from what is true.
struct Reconstruction {
  double row_factor = 1;
  Cloud cloud;
  double decode_ms = 0;
  Comparison to_scan;         ///< a: reconstruction, b: the scan's returns
  DistanceStats range_error;  ///< along the same directions, against the exact surface
};

/// |reconstructed - exact range| in every direction where both have a surface. Both clouds are
/// organised on the same grid.
DistanceStats range_errors(const Cloud& reconstructed, const Cloud& truth) {
  std::vector<double> errors;
  if (reconstructed.size() != truth.size()) {
    throw Failure({ErrorCode::invalid_argument, "the exact truth lies on another grid"},
                  kExitInternal);
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3 &seen = reconstructed.positions[i], &exact = truth.positions[i];
    if (is_return(seen) && is_return(exact)) errors.push_back(std::abs(norm(seen) - norm(exact)));
  }
  return summarise(std::move(errors));
}

Reconstruction reconstruct_and_measure(const DecodedScan& scan, const Cloud& raw,
                                       const Scene& scene, double row_factor, std::size_t threads) {
  Reconstruction result;
  result.row_factor = row_factor;
  ReconstructSettings settings;
  settings.rows = row_factor;
  settings.organised = true;
  settings.threads = threads;
  const auto start = Clock::now();
  result.cloud = need(reconstruct(scan, settings));
  result.decode_ms = ms_since(start);
  result.to_scan = need(compare(result.cloud, raw, threads));
  const Cloud truth = need(simulate_truth(scene, scan.field->lattice(), row_factor, 1, 0,
                                          scan.sensor.max_range_m, threads));
  result.range_error = range_errors(result.cloud, truth);
  return result;
}

/// Without the slots that hold no return.
Cloud only_returns(const Cloud& cloud) {
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) kept.push_back(static_cast<std::uint32_t>(i));
  }
  return select(cloud, kept);
}

Image picture(const Cloud& cloud, std::string title) {
  RenderSettings settings;
  settings.width = 800;
  settings.height = 600;
  settings.distance_m = 38;  // the same camera and colours for all, so that they can be compared
  settings.value_min = -2;
  settings.value_max = 3;
  settings.title = std::move(title);
  return need(render(cloud, settings));
}

std::string table_text(const std::vector<Reconstruction>& all) {
  Table table;
  table.add({"density", "points", "time", "exact error: mean", "p95", "to scan: mean", "p95",
             "from scan: mean", "p95"});
  for (const Reconstruction& r : all) {
    table.add({fmt::format("{:g} x 1", r.row_factor), count_text(r.to_scan.points_a),
               milliseconds_text(r.decode_ms), length_text(r.range_error.mean),
               length_text(r.range_error.p95), length_text(r.to_scan.a_to_b.mean),
               length_text(r.to_scan.a_to_b.p95), length_text(r.to_scan.b_to_a.mean),
               length_text(r.to_scan.b_to_a.p95)});
  }
  return table.text() +
         "  exact error: along each direction, against the surface that the simulator knows\n"
         "  to and from scan: to the nearest neighbour among the returns\n";
}

Json json_of(const std::vector<Reconstruction>& all) {
  Json json = Json::array();
  for (const Reconstruction& r : all) {
    json.push_back(
        {{"rows", r.row_factor},
         {"points", r.to_scan.points_a},
         {"decode_ms", r.decode_ms},
         {"exact_error", {{"mean", r.range_error.mean}, {"p95", r.range_error.p95}}},
         {"to_scan", {{"mean", r.to_scan.a_to_b.mean}, {"p95", r.to_scan.a_to_b.p95}}},
         {"from_scan", {{"mean", r.to_scan.b_to_a.mean}, {"p95", r.to_scan.b_to_a.p95}}}});
  }
  return json;
}

constexpr const char* kNext = R"(
Now with a scan of your own (PCD, PLY, KITTI or nuScenes .bin, .npy, CSV):
  curlidar info scan.pcd                                  what sensor it seems to be
  curlidar encode scan.pcd                                makes scan.curl
  curlidar decode scan.curl --rows 8 -o dense.ply         8 times denser
  curlidar compare scan.pcd scan.curl                     distances both ways
  curlidar render scan.curl --rows 8 -o dense.png         a picture
)";

int run(const Options& options) {
  namespace fs = std::filesystem;
  SensorProfile sensor = need_option(load_sensor(options.sensor));
  const auto scene = need_option(make_scene(options.scene, options.seed));
  std::error_code error;
  fs::create_directories(options.output, error);  // a failure shows in the first write
  const auto place = [&](const std::string& name) {
    return (fs::path(options.output) / name).string();
  };
  ProgressBar bar(!options.common.quiet);
  std::size_t step = 0;
  const auto next = [&](const char* stage) { bar.update(step++, 6, stage, 0); };

  next("simulate");
  // With every beam leaving from the origin, truth and reconstruction look along the same rays.
  for (Ring& ring : sensor.rings) ring.vertical_offset_m = ring.horizontal_offset_m = 0;
  SimulateSettings simulate_settings;
  simulate_settings.seed = options.seed;
  simulate_settings.threads = options.common.threads;
  const Cloud raw = need(simulate(*scene, sensor, simulate_settings));
  save_cloud(place("original.ply"), raw, {});
  save_cloud(place("original.pcd"), raw, {});

  next("encode");
  EncodeSettings encode_settings;
  encode_settings.sensor = sensor;
  encode_settings.compact.columns = sensor.columns;  // one for each firing
  encode_settings.attributes = std::vector<std::string>{};
  encode_settings.threads = options.common.threads;
  const auto start = Clock::now();
  const Encoded encoded = need(encode(raw, encode_settings));
  const double encode_ms = ms_since(start);
  need(write_file(place("scan.curl"), encoded.bytes));

  const DecodedScan scan = need(decode(encoded.bytes));
  std::vector<Reconstruction> all;
  for (const double factor : {1.0, 8.0}) {
    next("reconstruct");
    all.push_back(reconstruct_and_measure(scan, raw, *scene, factor, options.common.threads));
    save_cloud(place(fmt::format("reconstruction_{:g}x.ply", factor)),
               only_returns(all.back().cloud), {});
  }

  next("draw");
  const auto title = [](const char* name, std::size_t points) {
    return fmt::format("{}: {} points", name, count_text(points));
  };
  need(write_png(place("demo.png"),
                 side_by_side({picture(raw, title("original", count_returns(raw))),
                               picture(all[0].cloud, title("1 x", all[0].to_scan.points_a)),
                               picture(all[1].cloud, title("8 x", all[1].to_scan.points_a))})));
  bar.clear();

  const EncodeReport& report = encoded.report;
  const std::size_t raw_bytes = count_returns(raw) * 12;
  std::string text = fmt::format(
      "A {} seen by a simulated {}: {} points, {} as float32.\n"
      "Encoded in {}: {}, {:.2f} bits a point; mean error of the coded returns {}.\n\n{}\n",
      options.scene, sensor.name, count_text(count_returns(raw)), bytes_text(raw_bytes),
      milliseconds_text(encode_ms), bytes_text(report.bytes), report.bits_per_point,
      length_text(report.compact->mean_error_m), table_text(all));
  text += fmt::format(
      "In {}: original.ply, original.pcd, scan.curl, reconstruction_1x.ply,\n"
      "reconstruction_8x.ply and demo.png (original | 1 x | 8 x).\n{}",
      options.output, kNext);
  print_result(options.common, {{{"output", options.output},
                                 {"points_in", report.points_in},
                                 {"points_coded", report.points_coded},
                                 {"bytes", report.bytes},
                                 {"bits_per_point", report.bits_per_point},
                                 {"mean_error_m", report.compact->mean_error_m},
                                 {"encode_ms", encode_ms},
                                 {"reconstructions", json_of(all)}},
                                text});
  return kExitOk;
}

}  // namespace

Command add_demo(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "demo", "Simulate a street, encode it, make it denser, measure it, draw it");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("-o,--output", options->output, "Directory for the results")
      ->capture_default_str()
      ->take_last();  // ./dev demo gives one before the user's
  app->add_option("--scene", options->scene,
                  fmt::format("Scene: {}", fmt::join(scene_names(), ", ")))
      ->capture_default_str();
  app->add_option("--sensor", options->sensor, "Sensor: a built-in name or a profile's file")
      ->capture_default_str();
  app->add_option("--seed", options->seed, "Places objects, noise and dropouts")
      ->capture_default_str();
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
