// SPDX-License-Identifier: BSD-3-Clause
#include "map.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>

#include "commands.hpp"
#include "common_maps.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kMapFooter = R"(Examples:
  curlidar map build scans/ --poses poses.txt -o street.curl
  curlidar map append street.curl more/ --poses more.txt
  curlidar map info street.curl
  curlidar map extract street.curl --box -20,-20,-3,20,20,5 --density 100 -o part.ply
  curlidar map sample street.curl --sensor vlp16 --pose 12,3,1.7,0,0,90 -o scan.pcd
  curlidar map compare street.curl truth.ply -o errors.png
  curlidar map render street.curl -o street.png
'curlidar map COMMAND --help' says more.)";

}  // namespace

MapFile load_map(const std::string& path, bool allow_truncated) {
  MapReadOptions options;
  options.allow_truncated = allow_truncated;
  MapFile map = need(MapFile::open(path, options));
  for (const std::string& missing : map.missing()) print_warning(missing);
  return map;
}

std::vector<double> parse_numbers(const std::string& text, const char* option, std::size_t count) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at <= end) {
    double number = 0;
    const auto [after, error] = std::from_chars(at, end, number);
    if (error != std::errc() || (after != end && *after != ',')) break;
    numbers.push_back(number);
    at = after + 1;
  }
  if (at != end + 1 || numbers.size() != count) {
    usage_error(
        fmt::format("{} {}: {} numbers with commas between them are needed", option, text, count));
  }
  return numbers;
}

Command add_map(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "map", "Maps of scans with poses: build them, make them longer, look at them, compare them");
  app->footer(kMapFooter);
  app->require_subcommand(1);
  std::vector<Command> commands;
  for (auto* add : {add_map_build, add_map_append, add_map_info, add_map_extract, add_map_sample,
                    add_map_compare, add_map_render}) {
    commands.push_back(add(*app));
  }
  return {app, [commands] {
            const auto chosen = std::find_if(commands.begin(), commands.end(),
                                             [](const Command& c) { return c.app->parsed(); });
            return chosen != commands.end() ? chosen->run() : kExitUsage;
          }};
}

}  // namespace curlidar::app
