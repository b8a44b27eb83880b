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
#include "density/fit.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::density;

struct Options {
  std::string kind, list, out, without, name = "density", description;
  TreeSettings trees;
  std::size_t threads = 1;
};

constexpr const char* kUsage =
    "usage: density image LIST OUT.toml [--without GROUP] [--name N] [--description D]\n"
    "               [--return-trees N] [--residual-trees N] [--sample K] [--threads N]\n"
    "LIST holds lines of GROUP PATH, a group being a drive.\n";

Result<std::size_t> whole(const std::string& text) {
  std::istringstream stream(text);
  std::size_t number = 0;
  if (stream >> number && stream.eof() && number < 100000) return number;
  return Error{ErrorCode::invalid_argument, fmt::format("\"{}\" is no whole number", text)};
}

Result<Options> parse(const std::vector<std::string>& words) {
  Options options;
  if (words.size() < 3 || words[0] != "image") {
    return Error{ErrorCode::invalid_argument, kUsage};
  }
  options.kind = words[0], options.list = words[1], options.out = words[2];
  for (std::size_t i = 3; i < words.size(); i += 2) {
    if (i + 1 >= words.size()) return Error{ErrorCode::invalid_argument, kUsage};
    const std::string& value = words[i + 1];
    const std::map<std::string, std::string*> texts{{"--without", &options.without},
                                                    {"--name", &options.name},
                                                    {"--description", &options.description}};
    const std::map<std::string, std::size_t*> numbers{
        {"--return-trees", &options.trees.return_trees},
        {"--residual-trees", &options.trees.residual_trees},
        {"--depth", &options.trees.depth},
        {"--residual-depth", &options.trees.residual_depth},
        {"--sample", &options.trees.every},
        {"--threads", &options.threads}};
    if (const auto text = texts.find(words[i]); text != texts.end()) {
      *text->second = value;
    } else if (const auto number = numbers.find(words[i]); number != numbers.end()) {
      CURLIDAR_TRY_ASSIGN(read, whole(value));
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

Status run(const Options& options) {
  CURLIDAR_TRY_ASSIGN(list, read_list(options.list));
  std::vector<RowScan> scans;
  for (const auto& [group, path] : list) {
    if (group == options.without) continue;
    CURLIDAR_TRY_ASSIGN(own, read_own_frame(path));
    scans.push_back(image_rows(own));
    scans.back().group = group;
  }
  if (scans.empty()) return Error{ErrorCode::invalid_argument, "no scan is left to learn from"};
  // Rows 0, 4, .. 60 from below of 64.
  DensityProfile profile = fit_tables(scans, {.first = 3, .every = 4});
  profile.name = options.name;
  profile.description = options.description;
  if (options.trees.return_trees > 0 || options.trees.residual_trees > 0) {
    fit_trees(scans, options.trees, profile, options.threads);
  }
  CURLIDAR_TRY(validate(profile));
  const std::string text = density_profile_text(profile);
  std::ofstream file(options.out, std::ios::binary);
  file << text;
  if (!file.flush()) return Error{ErrorCode::io, fmt::format("{}: not written", options.out)};
  fmt::print("{}: {} bytes from {} scans\n", options.out, text.size(), scans.size());
  return {};
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
