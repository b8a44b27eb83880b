// SPDX-License-Identifier: BSD-3-Clause
// Density profiles from scans that one has. README.md says how the shipped ones were made.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/simulate.hpp"
#include "density/asked_scan.hpp"
#include "density/confidence.hpp"
#include "density/fit.hpp"
#include "density/judge.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::density;

struct Options {
  std::string kind, list, out, without, left_out, cache, name = "density", description;
  TreeSettings trees;
  std::size_t confidence_trees = 80, row_confidence_trees = 40, places = 2000, seeds = 2,
              threads = 1, every = 4;
};

constexpr const char* kUsage =
    "usage: density image LIST OUT.toml [--return-trees N] [--residual-trees N] [--depth N]\n"
    "               [--residual-depth N] [--sample K]\n"
    "       density rings LIST OUT.toml [--every K] [--row-confidence-trees N] [--places N]\n"
    "               [--cache FOLDER] and the options of image\n"
    "       density confidence LIST OUT.toml [--confidence-trees N] [--depth N] [--places N]\n"
    "               [--seeds N] [--cache FOLDER] [--left-out FOLDER]\n"
    "both: [--without GROUP] [--name N] [--description D] [--threads N]\n"
    "LIST holds lines of GROUP PATH, a group being a drive.\n";

Result<std::size_t> whole(const std::string& text) {
  std::istringstream stream(text);
  std::size_t number = 0;
  if (stream >> number && stream.eof() && number < 100000) return number;
  return Error{ErrorCode::invalid_argument, fmt::format("\"{}\" is no whole number", text)};
}

Result<Options> parse(const std::vector<std::string>& words) {
  Options options;
  if (words.size() < 3 || words.size() % 2 == 0) {
    return Error{ErrorCode::invalid_argument, kUsage};
  }
  options.kind = words[0], options.list = words[1], options.out = words[2];
  const std::map<std::string, std::string*> texts{{"--without", &options.without},
                                                  {"--left-out", &options.left_out},
                                                  {"--cache", &options.cache},
                                                  {"--name", &options.name},
                                                  {"--description", &options.description}};
  const std::map<std::string, std::size_t*> numbers{
      {"--return-trees", &options.trees.return_trees},
      {"--residual-trees", &options.trees.residual_trees},
      {"--depth", &options.trees.depth},
      {"--residual-depth", &options.trees.residual_depth},
      {"--sample", &options.trees.every},
      {"--confidence-trees", &options.confidence_trees},
      {"--row-confidence-trees", &options.row_confidence_trees},
      {"--every", &options.every},
      {"--places", &options.places},
      {"--seeds", &options.seeds},
      {"--threads", &options.threads}};
  for (std::size_t i = 3; i < words.size(); i += 2) {
    if (const auto text = texts.find(words[i]); text != texts.end()) {
      *text->second = words[i + 1];
    } else if (const auto number = numbers.find(words[i]); number != numbers.end()) {
      CURLIDAR_TRY_ASSIGN(read, whole(words[i + 1]));
      *number->second = read;
    } else {
      return Error{ErrorCode::invalid_argument, kUsage};
    }
  }
  options.trees.every = std::max<std::size_t>(options.trees.every, 1);
  return options;
}

/// GROUP PATH of every line.
Result<std::vector<std::pair<std::string, std::string>>> read_list(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{ErrorCode::io, fmt::format("{}: cannot be read", path)};
  std::vector<std::pair<std::string, std::string>> list;
  std::string group, scan;
  while (file >> group >> scan) list.emplace_back(group, scan);
  if (list.empty()) return Error{ErrorCode::invalid_argument, path + ": no line of GROUP PATH"};
  return list;
}

Status write_profile(const Options& options, DensityProfile profile) {
  profile.name = options.name;
  profile.description = options.description;
  CURLIDAR_TRY(validate(profile));
  const std::string text = density_profile_text(profile);
  std::ofstream file(options.out, std::ios::binary);
  file << text;
  if (!file.flush()) return Error{ErrorCode::io, fmt::format("{}: not written", options.out)};
  fmt::print("{}: {} bytes\n", options.out, text.size());
  return {};
}

void show(const std::string& path, const RowScan& scan, const DensityProfile& profile) {
  for (const bool with : {false, true}) {
    const RowScores s = judge_rows(scan, profile, with);
    fmt::print(
        "{}, {} profile: median {:.4f} m, p95 {:.3f} m, completeness {:.3f}; most trusted "
        "half: median {:.4f} m, p95 {:.3f} m\n",
        path, with ? "with" : "without", s.median_m, s.p95_m, s.completeness, s.half_median_m,
        s.half_p95_m);
  }
}

void show(const char* what, const Calibration& calibration) {
  fmt::print("{}: bins of said / right / share of answers", what);
  double all = 0;
  for (const double count : calibration.count) all += count;
  for (std::size_t bin = 0; bin < Calibration::kBins; ++bin) {
    const double count = std::max(calibration.count[bin], 1.0);
    fmt::print("  {:.3f}/{:.3f}/{:.3f}", calibration.said[bin] / count,
               calibration.right[bin] / count, calibration.count[bin] / std::max(all, 1.0));
  }
  fmt::print("  worst {:.3f}\n", calibration.worst(0.01 * all));
}

/// Metres: what three bits a return leave of an HDL-64E, one bit, and half a bit.
constexpr double kRowSteps_m[] = {0.03, 0.15, 0.3};

/// A scan of the list in both ways that rows are taught with.
struct ListedScan {
  std::string group;
  OwnScan own;
  RowScan rows;
};

Result<std::vector<ListedScan>> read_rows(const Options& options, bool image) {
  CURLIDAR_TRY_ASSIGN(list, read_list(options.list));
  std::vector<ListedScan> scans;
  for (const auto& [group, path] : list) {
    CURLIDAR_TRY_ASSIGN(own, read_own_frame(path));
    CURLIDAR_TRY_ASSIGN(rows, image ? image_rows(own.cloud) : ring_rows(own));
    if (!scans.empty() && rows.elevations.size() != scans.front().rows.elevations.size()) {
      return Error{ErrorCode::invalid_argument, path + ": not as many rings as in the others"};
    }
    scans.push_back({group, std::move(own), std::move(rows)});
  }
  return scans;
}

/// The groups of scans but one, each once.
std::set<std::string> groups_of(const std::vector<ListedScan>& scans, const std::string& without) {
  std::set<std::string> groups;
  for (const ListedScan& scan : scans) groups.insert(scan.group);
  groups.erase(without);
  return groups;
}

/// The rows of all scans but those of some groups.
std::vector<RowScan> rows_without(const std::vector<ListedScan>& scans,
                                  const std::set<std::string>& groups) {
  std::vector<RowScan> rows;
  for (const ListedScan& scan : scans) {
    if (!groups.contains(scan.group)) rows.push_back(scan.rows);
  }
  return rows;
}

DensityProfile learn_rows(const Options& options, const std::vector<RowScan>& rows, bool image) {
  // Of an image rows 0, 4, .. 60 from below of 64; of a sensor rings from the top.
  const GivenRows given = image ? GivenRows{3, 4} : GivenRows{0, options.every};
  DensityProfile profile = fit_tables(rows, given);
  if (options.trees.return_trees > 0 || options.trees.residual_trees > 0) {
    fit_trees(rows, options.trees, profile, options.threads);
  }
  return profile;
}

/// Confidence in what rows would measure: of each group by tables of the others, for tables do
/// better on what taught them than on anything else.
ObliviousTrees learn_row_confidence(const Options& options, const std::vector<ListedScan>& scans) {
  const Coder coder(options.cache);
  Samples samples;
  for (const std::string& group : groups_of(scans, options.without)) {
    const std::vector<RowScan> others = rows_without(scans, {group, options.without});
    if (others.empty()) continue;
    const auto profile = std::make_shared<const DensityProfile>(learn_rows(options, others, false));
    for (const ListedScan& scan : scans) {
      if (scan.group != group) continue;
      for (const double step_m : kRowSteps_m) {
        const auto asked = ask_held_out(coder, scan.own, options.every, step_m, options.places);
        if (!asked) fmt::print(stderr, "{}\n", asked.error().message);
        if (asked) add_row_answers(*asked, profile, samples);
      }
    }
  }
  if (samples.size() == 0) return {};
  return boost(samples,
               {.trees = options.row_confidence_trees, .depth = 5, .levels = 32, .rate = 0.3},
               options.threads);
}

/// What the profile is worth on the scans that did not teach it.
void show_others(const Options& options, const std::vector<ListedScan>& scans,
                 const DensityProfile& profile) {
  const Coder coder(options.cache);
  const auto shared = std::make_shared<const DensityProfile>(profile);
  Samples samples;
  for (const ListedScan& scan : scans) {
    if (scan.group != options.without) continue;
    show(scan.own.path, scan.rows, profile);
    for (const double step_m : kRowSteps_m) {
      const auto asked = ask_held_out(coder, scan.own, options.every, step_m, options.places);
      if (asked) add_row_answers(*asked, shared, samples);
    }
  }
  if (samples.size() == 0 || profile.row_confidence.empty()) return;
  show("another drive", check(profile.row_confidence, samples));
}

Status run_rows(const Options& options) {
  const bool image = options.kind == "image";
  CURLIDAR_TRY_ASSIGN(scans, read_rows(options, image));
  const std::vector<RowScan> rows = rows_without(scans, {options.without});
  if (rows.empty()) return Error{ErrorCode::invalid_argument, "no scan is left to learn from"};
  DensityProfile profile = learn_rows(options, rows, image);
  if (!image && options.row_confidence_trees > 0) {
    profile.row_confidence = learn_row_confidence(options, scans);
  }
  if (!image) show_others(options, scans, profile);
  return write_profile(options, std::move(profile));
}

/// Metres: from what three bits a return leave of an HDL-64E to what one leaves of sparse sensors.
constexpr double kSteps_m[] = {0.03, 0.1, 0.15, 0.3, 0.6};

/// Answers of all scenes and sensors of one seed. What cannot be coded is left out, with a word.
void add_simulated(const Options& options, std::uint64_t seed, Samples& samples) {
  const Coder coder(options.cache);
  for (const std::string& scene : scene_names()) {
    for (const char* sensor : {"hdl64e-kitti", "os1-64", "vlp16"}) {
      for (const double step_m : kSteps_m) {
        const auto scan = ask_simulated(coder, {scene, sensor, seed}, step_m, options.places);
        if (!scan) fmt::print(stderr, "{} {}: {}\n", scene, sensor, scan.error().message);
        if (scan) add_answers(*scan, samples);
      }
    }
  }
}

/// Samples by who taught them; scenes are one group without a name.
using Groups = std::map<std::string, Samples>;

void add_real(const Options& options, const OwnScan& own, Samples& samples) {
  const Coder coder(options.cache);
  for (const std::size_t every : {std::size_t{2}, std::size_t{4}}) {
    for (const double step_m : kSteps_m) {
      const auto scan = ask_held_out(coder, own, every, step_m, options.places);
      if (!scan) fmt::print(stderr, "{}\n", scan.error().message);
      if (scan) add_answers(*scan, samples);
    }
  }
}

/// Those of all groups but one.
Samples all_but(const Groups& groups, const std::string& left_out) {
  Samples all;
  for (const auto& [group, samples] : groups) {
    if (group.empty() || group != left_out) all.add(samples);
  }
  return all;
}

DensityProfile learn(const Options& options, const Samples& samples) {
  DensityProfile profile;
  profile.confidence =
      boost(samples, {.trees = options.confidence_trees, .depth = options.trees.depth, .rate = 0.4},
            options.threads);
  return profile;
}

/// A profile for each group, taught by all the others, and how well it does on its own.
Status leave_out(const Options& options, const Groups& groups) {
  for (const auto& [group, samples] : groups) {
    if (group.empty()) continue;
    DensityProfile profile = learn(options, all_but(groups, group));
    show(group.c_str(), check(profile.confidence, samples));
    Options its = options;
    its.out = fmt::format("{}/{}.toml", options.left_out, group);
    its.name = options.name + "-without-" + group;
    CURLIDAR_TRY(write_profile(its, std::move(profile)));
  }
  return {};
}

Status run_confidence(const Options& options) {
  constexpr std::uint64_t kOtherSeed = 101;
  CURLIDAR_TRY_ASSIGN(list, read_list(options.list));
  Groups groups;
  for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
    add_simulated(options, seed, groups[""]);
  }
  for (const auto& [group, path] : list) {
    CURLIDAR_TRY_ASSIGN(own, read_own_frame(path));
    add_real(options, own, groups[group]);
  }
  const Samples samples = all_but(groups, options.without);
  if (samples.size() == 0) return Error{ErrorCode::invalid_argument, "no scan could be coded"};
  DensityProfile profile = learn(options, samples);
  show("learnt from", check(profile.confidence, samples));
  Samples simulated;
  add_simulated(options, kOtherSeed, simulated);
  show("another seed", check(profile.confidence, simulated));
  if (const auto left = groups.find(options.without);
      left != groups.end() && !left->first.empty()) {
    show("another drive", check(profile.confidence, left->second));
  }
  CURLIDAR_TRY(write_profile(options, std::move(profile)));
  return options.left_out.empty() ? Status{} : leave_out(options, groups);
}

Status run(const Options& options) {
  if (options.kind == "image" || options.kind == "rings") return run_rows(options);
  if (options.kind == "confidence") return run_confidence(options);
  return Error{ErrorCode::invalid_argument, kUsage};
}

}  // namespace

int main(int argc, char** argv) {
  const Result<Options> options = parse({argv + 1, argv + argc});
  if (!options) {
    fmt::print(stderr, "{}\n", options.error().message);
    return 2;
  }
  const Status status = run(*options);
  if (!status) fmt::print(stderr, "density: {}\n", status.error().message);
  return status ? 0 : 1;
}
