// SPDX-License-Identifier: BSD-3-Clause
#include "common_compact.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

namespace curlidar::app {
namespace {

constexpr const char* kGroup = "Compact profile";
/// Functions of their own that a layer may have.
constexpr std::array<int, 4> kFunctionCounts{0, 1, 3, 6};

template <class T>
std::string share_text(T part, T all) {
  return fmt::format("{:.1f} %",
                     100.0 * static_cast<double>(part) / std::max(static_cast<double>(all), 1e-9));
}

}  // namespace

void CompactOptions::add_target(CLI::App& app, const char* name, CompactTarget kind, double most,
                                const char* help) {
  const std::size_t place = targets_.size();
  targets_.push_back({kind, 0, nullptr});
  targets_[place].option =
      app.add_option_function<double>(
             name, [this, place](const double& value) { targets_[place].value = value; }, help)
          ->check(number_in(1e-6, most))
          ->group(kGroup);
}

void CompactOptions::add(CLI::App& app) {
  add_target(app, "--error", CompactTarget::error, 100,
             "Wanted mean distance of decoded returns to their originals, metres; reached to 5 %, "
             "never exceeded. Default 0.05");
  add_target(app, "--error-nn", CompactTarget::error_nn, 100,
             "The same for the larger of the two mean nearest-neighbour distances");
  add_target(app, "--step", CompactTarget::step, 100,
             "Quantiser step of the field instead, metres: no search");
  add_target(app, "--bits", CompactTarget::bits_per_point, 1000,
             "Wanted bits per coded return instead, attributes and metadata not counted; reached "
             "to 3 %, never exceeded");
  add_target(app, "--max-error", CompactTarget::max_error, 100,
             "Bound on the distance of every single point to its original, metres: checked before "
             "the file is written, and kept in it for 'curlidar verify'");
  const std::size_t place = targets_.size();
  targets_.push_back({CompactTarget::lossless, 1, nullptr});
  targets_[place].option = app.add_flag_callback(
                                  "--lossless", [] {}, "Coordinates come back bit for bit")
                               ->group(kGroup);
  others_.push_back(
      app.add_flag("--any-order", any_order_, "Give up the order of the points, and empty slots")
          ->group(kGroup));
  others_.push_back(app.add_option("--effort", effort_, "1 (fast) .. 9 (smallest files)")
                        ->check(number_in(1, kMaxEffort))
                        ->capture_default_str()
                        ->group(kGroup));
  others_.push_back(app.add_flag("--no-index", no_index_,
                                 "One segment: up to 2 % smaller, but parts of it cannot be "
                                 "decoded alone")
                        ->group(kGroup));
  others_.push_back(app.add_option("--segments", segments_,
                                   "Parts that can be decoded alone, bands of rings x sectors of "
                                   "azimuth (1x4), or auto: as many as cost 2 % at most")
                        ->type_name("RxC")
                        ->capture_default_str()
                        ->group(kGroup));
}

std::string CompactOptions::first_given() const {
  for (const Target& target : targets_) {
    if (target.option->count() > 0) return target.option->get_name();
  }
  for (const CLI::Option* option : others_) {
    if (option->count() > 0) return option->get_name();
  }
  return "";
}

void CompactOptions::apply(CompactSettings& settings) const {
  const Target* chosen = nullptr;
  for (const Target& target : targets_) {
    if (target.option->count() == 0) continue;
    if (chosen != nullptr) {
      usage_error(fmt::format("{} and {} both say how exact the file is to be: give one of them",
                              chosen->option->get_name(), target.option->get_name()));
    }
    chosen = &target;
  }
  if (chosen != nullptr) {
    settings.target = chosen->kind;
    settings.target_value = chosen->value;
  }
  settings.effort = effort_;
  settings.keep_order = !any_order_;
  settings.index = !no_index_;
  if (segments_ == "auto") return;
  if (no_index_) usage_error("--no-index makes one segment: leave --segments out");
  const RowsByColumns<std::uint32_t> parts = parse_whole_factors(segments_, "--segments");
  settings.bands = parts.rows;
  settings.sectors = parts.columns;
}

Json breakdown_json(const CompactBreakdown& b) {
  return {{"header", b.header},
          {"mask", b.mask},
          {"partition", b.partition},
          {"modes", b.modes},
          {"coefficients", b.coefficients},
          {"labels", b.labels},
          {"residual", b.residual},
          {"records", b.records}};
}

Json statistics_json(const CompactStatistics& s) {
  Json sizes = Json::object();
  for (std::size_t i = 0; i < s.leaves_by_size.size(); ++i) {
    if (s.leaves_by_size[i] != 0) sizes[std::to_string(1u << i)] = s.leaves_by_size[i];
  }
  Json functions = Json::object();
  std::size_t layers = 0;
  for (std::size_t i = 0; i < s.layers_by_functions.size() && i < kFunctionCounts.size(); ++i) {
    functions[std::to_string(kFunctionCounts[i])] = s.layers_by_functions[i];
    layers += s.layers_by_functions[i];
  }
  return {{"leaves", s.leaves},
          {"leaves_with_residual", s.leaves_with_residual},
          {"leaves_by_cells", sizes},
          {"leaves_by_layers", s.leaves_by_layers},
          {"layers", layers},
          {"layers_by_functions", functions},
          {"inherited_layers", s.inherited_layers}};
}

std::string breakdown_text(const CompactBreakdown& b, std::size_t returns) {
  Table table;
  const double total = b.total();
  const auto n = static_cast<double>(std::max<std::size_t>(returns, 1));
  const auto add = [&](const char* name, double bits) {
    table.add({name, fmt::format("{:.4f} bits a return", bits / n), share_text(bits, total)});
  };
  add("header", b.header);
  add("mask", b.mask);
  add("partition", b.partition);
  add("modes", b.modes);
  add("coefficients", b.coefficients);
  add("labels", b.labels);
  add("residual", b.residual);
  if (b.records > 0) add("order, loose points, corrections", b.records);
  add("all", total);
  return table.text();
}

std::string promise_text(const RecordPromise& promise) {
  std::string text = "none for single points";
  if (promise.bit_exact) text = "bit for bit";
  if (promise.bound_m > 0) text = "every point within " + length_text(promise.bound_m);
  return text + (promise.any_order ? ", in any order" : ", in the order of the scan");
}

std::string statistics_text(const CompactStatistics& s) {
  Table table;
  for (std::size_t i = 0; i < s.leaves_by_size.size(); ++i) {
    if (s.leaves_by_size[i] == 0) continue;
    table.add({fmt::format("leaves of {}{} cells", 1u << i,
                           i == 0 ? "" : fmt::format("..{}", (2u << i) - 1)),
               count_text(s.leaves_by_size[i]), share_text(s.leaves_by_size[i], s.leaves)});
  }
  for (std::size_t i = 0; i < s.leaves_by_layers.size(); ++i) {
    table.add({fmt::format("leaves of {} layer{}", i + 1, i == 0 ? "" : "s"),
               count_text(s.leaves_by_layers[i]), share_text(s.leaves_by_layers[i], s.leaves)});
  }
  std::size_t layers = 0;
  for (const std::size_t count : s.layers_by_functions) layers += count;
  for (std::size_t i = 0; i < s.layers_by_functions.size() && i < kFunctionCounts.size(); ++i) {
    table.add({fmt::format("layers of {} own functions", kFunctionCounts[i]),
               count_text(s.layers_by_functions[i]), share_text(s.layers_by_functions[i], layers)});
  }
  table.add({"layers on a neighbour's plane", count_text(s.inherited_layers),
             share_text(s.inherited_layers, layers)});
  table.add({"leaves with residuals", count_text(s.leaves_with_residual),
             share_text(s.leaves_with_residual, s.leaves)});
  return table.text();
}

}  // namespace curlidar::app
