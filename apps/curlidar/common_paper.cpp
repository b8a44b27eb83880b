// SPDX-License-Identifier: BSD-3-Clause
#include "common_paper.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

namespace curlidar::app {
namespace {

constexpr const char* kGrid = "Grid";
constexpr const char* kUpsampling = "Paper: mesh and upsampling";
constexpr const char* kFit = "Paper: patches and fit";

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

CLI::Option* PaperOptions::paper_only(CLI::Option* option) {
  paper_only_.push_back(option);
  return option;
}

template <class T>
CLI::Option* PaperOptions::add_number(CLI::App& app, const std::string& name,
                                      T& (*field)(PaperSettings&), const char* help) {
  PaperSettings defaults;
  const auto store = [this, field](const T& value) {
    overrides_.push_back([field, value](PaperSettings& settings) { field(settings) = value; });
  };
  return paper_only(app.add_option_function<T>(name, store, help))
      ->default_str(fmt::format("{}", field(defaults)));
}

void PaperOptions::add_grid(CLI::App& app, const std::string& prefix) {
  paper_only(app.add_option("--preset", preset_,
                            "Parameters of the paper's profiles for a kind of scan: " +
                                joined(paper_preset_names()) +
                                " or auto (indoor if most returns are nearer than 5 m, else "
                                "outdoor). Defaults below are those of outdoor"))
      ->capture_default_str()
      ->group(kGrid);
  app.add_option("--sensor", sensor_, kSensorHelp)->capture_default_str()->group(kGrid);
  const std::string rows = "--" + prefix + "rows";
  app.add_option_function<std::string>(
         rows,
         [this, rows](const std::string& text) {
           const RowChoice choice = parse_rows(text, rows.c_str());
           uniform_rows_ = choice.rule != RowRule::rings;
           overrides_.push_back([choice](PaperSettings& s) {
             s.row_rule = choice.rule;
             s.rows = choice.rows;
           });
         },
         "Rows of the grid: uniform (one for each ring, evenly spaced), rings (at the true "
         "elevations) or a number of uniform rows; compact: always rings")
      ->default_str("uniform")
      ->group(kGrid);
  app.add_option_function<std::uint32_t>(
         "--" + prefix + "cols",
         [this](const std::uint32_t& columns) {
           compact_.columns = columns;
           overrides_.push_back([columns](PaperSettings& s) { s.columns = columns; });
         },
         "Columns of the grid, N_h; compact: an organised cloud's own, else 2048")
      ->default_str(fmt::format("{}", PaperSettings{}.columns))
      ->check(number_in(4, 65536))
      ->group(kGrid);
  app.add_option_function<double>(
         "--min-range",
         [this](const double& metres) {
           compact_.min_range_m = metres;
           overrides_.push_back([metres](PaperSettings& s) { s.min_range_m = metres; });
         },
         "Drop returns nearer than this, metres; compact: 0")
      ->default_str(fmt::format("{}", PaperSettings{}.min_range_m))
      ->check(number_in(0.0, 1e6))
      ->group(kGrid);
  app.add_option_function<std::string>(
         "--max-range",
         [this](const std::string& text) {
           const RangeLimit limit = parse_range_limit(text, "--max-range");
           compact_.max_range = limit;
           overrides_.push_back([limit](PaperSettings& s) { s.max_range = limit; });
         },
         "Drop returns farther than this: metres, p90 for the 90th percentile of range, or max "
         "for the sensor's own limit; compact: max")
      ->default_str("p90")
      ->group(kGrid);
  add_number<double>(
      app, "--outlier-radius", [](PaperSettings & s) -> auto& { return s.outlier_radius_m; },
      "Outlier filter (paper): neighbourhood, metres; 0 switches it off")
      ->check(number_in(0.0, 1e6))
      ->group(kGrid);
  add_number<std::uint32_t>(
      app, "--outlier-min", [](PaperSettings & s) -> auto& { return s.outlier_min_points; },
      "Outlier filter (paper): returns wanted in the neighbourhood, itself included")
      ->group(kGrid);
}

void PaperOptions::add_upsample(CLI::App& app) {
  paper_only(app.add_option_function<std::string>(
                 "--upsample",
                 [this](const std::string& text) {
                   const auto factors = parse_whole_factors(text, "--upsample");
                   overrides_.push_back([factors](PaperSettings& s) {
                     s.upsample_rows = factors.rows;
                     s.upsample_columns = factors.columns;
                   });
                 },
                 "Virtual LiDAR, S_row x S_col times denser (paper-1to1: 1x1)"))
      ->type_name("RxC")
      ->default_str("2x2")
      ->group(kUpsampling);
}

void PaperOptions::add_cliffs(CLI::App& app) {
  const auto metres = number_in(0.0, 1e6);
  add_number<double>(
      app, "--cliff-row", [](PaperSettings & s) -> auto& { return s.cliffs.row_m; },
      "The surface is broken between rows farther apart than this, metres")
      ->check(metres)
      ->group(kUpsampling);
  add_number<double>(
      app, "--cliff-col", [](PaperSettings & s) -> auto& { return s.cliffs.column_m; },
      "The same between columns, metres")
      ->check(metres)
      ->group(kUpsampling);
  add_number<double>(
      app, "--cliff-diag", [](PaperSettings & s) -> auto& { return s.cliffs.diagonal_m; },
      "The same to the diagonal neighbour, metres")
      ->check(metres)
      ->group(kUpsampling);
  add_number<double>(
      app, "--refuse-triangles",
      [](PaperSettings & s) -> auto& { return s.refused_triangle_share; },
      "Share of the triangles, the largest ones, whose hits are refused")
      ->check(number_in(0.0, 1.0))
      ->group(kUpsampling);
}

void PaperOptions::add_fit(CLI::App& app, const char* profile) {
  profile_ = profile;
  app.add_option("--profile", profile_,
                 "compact (smallest), paper (CURL, RSS 2022), paper-1to1 (tuned for 1:1 "
                 "reconstruction) or paper-global (the paper's baseline: one expansion of the "
                 "whole scan)")
      ->capture_default_str();
  app.add_option("--attributes", attributes_,
                 "Attributes to keep: all, none, or names such as intensity,ring")
      ->capture_default_str();
  const auto positive = number_in(1, 65536);
  add_number<std::uint32_t>(
      app, "--patch", [](PaperSettings & s) -> auto& { return s.patch; },
      "Size of a patch in grid cells, P_r")
      ->check(positive)
      ->group(kFit);
  add_number<std::uint32_t>(
      app, "--overlap", [](PaperSettings & s) -> auto& { return s.overlap; },
      "Extended cells on every side of a patch, in upsampled cells (paper-1to1: 0)")
      ->check(number_in(0, 65536))
      ->group(kFit);
  add_number<double>(
      app, "--accept", [](PaperSettings & s) -> auto& { return s.accept_m; },
      "Mean training error at which a degree is accepted, metres (paper-1to1: 0.01)")
      ->check(number_in(0.0, 1e6))
      ->group(kFit);
  add_number<double>(
      app, "--reject", [](PaperSettings & s) -> auto& { return s.reject_m; },
      "Samples this far off are removed after the first pass, metres")
      ->check(number_in(0.0, 1e6))
      ->group(kFit);
  add_number<std::uint32_t>(
      app, "--max-degree", [](PaperSettings & s) -> auto& { return s.max_degree; },
      "Largest degree of a patch")
      ->check(number_in(1, 100))
      ->group(kFit);
  add_number<double>(
      app, "--k", [](PaperSettings & s) -> auto& { return s.k; },
      "Degree at which training and testing errors weigh the same")
      ->check(number_in(0.0, 1e6))
      ->group(kFit);
  add_number<bool>(
      app, "--error-stop", [](PaperSettings & s) -> auto& { return s.stop_on_total_error; },
      "Stop when the weighted error E_t rises (paper-1to1: false)")
      ->group(kFit);
  add_number<std::uint32_t>(
      app, "--global-degree", [](PaperSettings & s) -> auto& { return s.global_degree; },
      "Degree of paper-global")
      ->check(number_in(0, 1000))
      ->group(kFit);
  add_number<double>(
      app, "--global-reject", [](PaperSettings & s) -> auto& { return s.global_reject_m; },
      "paper-global masks reconstructed cells this far off, metres")
      ->check(number_in(0.0, 1e6))
      ->group(kFit);
}

std::string PaperOptions::preset(const Cloud& cloud) const {
  return preset_ == "auto" ? suggest_preset(cloud) : preset_;
}

Profile PaperOptions::profile() const {
  return need_option(profile_by_name(profile_));
}

void PaperOptions::refuse_paper_options() const {
  for (const CLI::Option* option : paper_only_) {
    if (option->count() == 0) continue;
    usage_error(fmt::format("{} means nothing to the compact profile: add --profile paper",
                            option->get_name()));
  }
  if (uniform_rows_) {
    usage_error(
        "the compact profile codes the true rings: leave --rows out, or add --profile paper");
  }
}

EncodeSettings PaperOptions::settings(const Cloud& cloud, std::size_t threads) const {
  EncodeSettings settings;
  settings.profile = profile();
  if (settings.profile == Profile::compact) refuse_paper_options();
  settings.compact = compact_;
  settings.paper = for_profile(need_option(paper_preset(preset(cloud))), settings.profile);
  for (const Override& apply : overrides_) apply(settings.paper);
  settings.sensor = parse_sensor(sensor_);
  settings.attributes = parse_attribute_list(attributes_);
  settings.threads = threads;
  return settings;
}

}  // namespace curlidar::app
