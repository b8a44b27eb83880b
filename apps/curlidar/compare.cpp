// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/compare.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar compare scan.pcd scan.curl
  curlidar compare raw.bin decoded.ply --json
  curlidar compare raw.pcd scan.curl --error-cloud error.ply
Each return is measured to its nearest neighbour in the other cloud, exactly (k-d tree). Read both
directions: points that are missing show only from the complete cloud, points that are invented
only from the other. A .curl file counts as its plain decode.)";

struct Options {
  CommonOptions common;
  std::string a, b, format, error_cloud;
};

Json stats_json(const DistanceStats& stats) {
  return {{"count", stats.count}, {"mean", stats.mean}, {"rms", stats.rms}, {"std", stats.std},
          {"p50", stats.p50},     {"p95", stats.p95},   {"max", stats.max}};
}

std::vector<std::string> stats_row(const char* name, std::size_t points,
                                   const DistanceStats& stats) {
  return {name,
          count_text(points),
          length_text(stats.mean),
          length_text(stats.rms),
          length_text(stats.std),
          length_text(stats.p50),
          length_text(stats.p95),
          length_text(stats.max)};
}

void write_error_cloud(const Options& options, Cloud cloud, const Cloud& reference) {
  const std::vector<double> distances =
      need(nearest_distances(cloud, reference, options.common.threads));
  std::vector<float> values;
  values.reserve(distances.size());
  for (const double distance : distances) values.push_back(static_cast<float>(distance));
  std::erase_if(cloud.attributes, [](const Attribute& a) { return a.name == "error"; });
  cloud.attributes.push_back({"error", 1, std::move(values)});
  save_cloud(options.error_cloud, cloud, {});
}

int run(const Options& options) {
  refuse_mixed_stdout(options.common, options.error_cloud);
  if (options.a == "-" && options.b == "-") usage_error("only one of the clouds can be '-'");
  refuse_same_file(options.a, options.error_cloud);
  refuse_same_file(options.b, options.error_cloud);
  const auto format = parse_format(options.format);
  Cloud a = load_cloud(options.a, format);
  const Cloud b = load_cloud(options.b, format);
  const Comparison result = need(compare(a, b, options.common.threads));
  if (!options.error_cloud.empty()) write_error_cloud(options, std::move(a), b);

  Table table(0);
  table.add({"", "points", "mean", "rms", "std", "p50", "p95", "max"});
  table.add(stats_row("a to b", result.points_a, result.a_to_b));
  table.add(stats_row("b to a", result.points_b, result.b_to_a));
  print_result(options.common,
               {{{"a", options.a},
                 {"b", options.b},
                 {"points_a", result.points_a},
                 {"points_b", result.points_b},
                 {"a_to_b", stats_json(result.a_to_b)},
                 {"b_to_a", stats_json(result.b_to_a)}},
                fmt::format("a = {}\nb = {}\n{}", options.a, options.b, table.text())},
               options.error_cloud == "-");
  return kExitOk;
}

}  // namespace

Command add_compare(CLI::App& root) {
  CLI::App* app = root.add_subcommand("compare", "Distances between two clouds, both ways");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("A", options->a, "Cloud or .curl file; - is standard input")->required();
  app->add_option("B", options->b, "Cloud or .curl file")->required();
  app->add_option("--format", options->format,
                  fmt::format("Format of both: {}; default by content", kFormatNames));
  app->add_option("--error-cloud", options->error_cloud,
                  "Write A with the distance of each point as attribute 'error', metres");
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
