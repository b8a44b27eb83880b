// SPDX-License-Identifier: BSD-3-Clause
// Density profiles from scans that one has. README.md says how the shipped ones were made.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
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
  std::string kind, list, out, without, cache, name = "density", description;
  TreeSettings trees;
  std::size_t confidence_trees = 80, places = 2000, seeds = 2, threads = 1, every = 4;
};

constexpr const char* kUsage =
    "usage: density image LIST OUT.toml [--return-trees N] [--residual-trees N] [--depth N]\n"
    "               [--residual-depth N] [--sample K]\n"
    "       density rings LIST OUT.toml [--every K] and the options of image\n"
    "       density confidence LIST OUT.toml [--confidence-trees N] [--depth N] [--places N]\n"
    "               [--seeds N] [--cache FOLDER]\n"
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

Status run_rows(const Options& options) {
  CURLIDAR_TRY_ASSIGN(list, read_list(options.list));
  const bool image = options.kind == "image";
  std::vector<RowScan> scans;
  std::vector<std::pair<std::string, RowScan>> others;
  for (const auto& [group, path] : list) {
    CURLIDAR_TRY_ASSIGN(own, read_own_frame(path));
    CURLIDAR_TRY_ASSIGN(scan, image ? image_rows(own) : ring_rows(own));
    if (group == options.without) {
      others.emplace_back(path, std::move(scan));
      continue;
    }
    scans.push_back(std::move(scan));
    if (scans.back().elevations.size() != scans.front().elevations.size()) {
      return Error{ErrorCode::invalid_argument, path + ": not as many rings as in the others"};
    }
  }
  if (scans.empty()) return Error{ErrorCode::invalid_argument, "no scan is left to learn from"};
  // Of an image rows 0, 4, .. 60 from below of 64; of a sensor rings from the top.
  const GivenRows given = image ? GivenRows{3, 4} : GivenRows{0, options.every};
  DensityProfile profile = fit_tables(scans, given);
  if (options.trees.return_trees > 0 || options.trees.residual_trees > 0) {
    fit_trees(scans, options.trees, profile, options.threads);
  }
  for (const auto& [path, scan] : others) {
    if (!image && scan.elevations.size() == profile.rows) show(path, scan, profile);
  }
  return write_profile(options, std::move(profile));
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

void add_real(const Options& options, const std::string& path, Samples& samples) {
  const Coder coder(options.cache);
  for (const std::size_t every : {std::size_t{2}, std::size_t{4}}) {
    for (const double step_m : kSteps_m) {
      const auto scan = ask_held_out(coder, path, every, step_m, options.places);
      if (!scan) fmt::print(stderr, "{}\n", scan.error().message);
      if (scan) add_answers(*scan, samples);
    }
  }
}

Status run_confidence(const Options& options) {
  constexpr std::uint64_t kOtherSeed = 101;
  CURLIDAR_TRY_ASSIGN(list, read_list(options.list));
  Samples samples, simulated, real;
  for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
    add_simulated(options, seed, samples);
  }
  add_simulated(options, kOtherSeed, simulated);
  for (const auto& [group, path] : list) {
    add_real(options, path, group == options.without ? real : samples);
  }
  if (samples.size() == 0) return Error{ErrorCode::invalid_argument, "no scan could be coded"};
  DensityProfile profile;
  profile.confidence =
      boost(samples, {.trees = options.confidence_trees, .depth = options.trees.depth, .rate = 0.4},
            options.threads);
  show("learnt from", check(profile.confidence, samples));
  show("another seed", check(profile.confidence, simulated));
  if (real.size() > 0) show("another drive", check(profile.confidence, real));
  return write_profile(options, std::move(profile));
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
