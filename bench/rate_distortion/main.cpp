// SPDX-License-Identifier: BSD-3-Clause
// Measures for ./dev rate-distortion, one JSON object a line.
//   rate_distortion peers GRID [--settings N]
//                                        size of the grid, then every peer over its settings, at
//                                        most N of them
//   rate_distortion errors GRID DECODED  a decoded cloud with a point for each occupied cell
//   rate_distortion cloud SCAN [--codecs NAME,NAME..] [--settings N]
//                                        the peers on a raw scan, every return; see cloud.hpp
// GRID is an organised cloud of `curlidar project`. Rates count every byte of a stream.
#include <algorithm>
#include <charconv>
#include <string_view>

#include "base/try.hpp"
#include "cloud.hpp"
#include "curlidar/io.hpp"
#include "peers/peers.hpp"
#include "report_json.hpp"

namespace curlidar::bench {

namespace {

/// Errors of a decoded cloud: nearest-neighbour distances both ways, and where points still lie in
/// the order of the cells, each point's own.
Result<Json> errors_json(const Grid& grid, const Cloud& decoded, Order order) {
  const std::vector<Vec3>& original = grid.returns.positions;
  CURLIDAR_TRY_ASSIGN(nearest, compare(grid.returns, decoded));
  Json json{{"points", decoded.size()},
            {"nearest_to_decoded", stats_json(nearest.a_to_b)},
            {"nearest_to_grid", stats_json(nearest.b_to_a)}};
  if (order == Order::unknown) return json;
  if (decoded.size() != original.size()) {
    return Error{ErrorCode::corrupt,
                 fmt::format("{} points where {} cells are occupied: they cannot be matched",
                             decoded.size(), original.size())};
  }
  std::vector<double> range_errors, point_errors;
  for (std::size_t i = 0; i < original.size(); ++i) {
    range_errors.push_back(std::abs(norm(decoded.positions[i]) - grid.ranges_m[i]));
    point_errors.push_back(norm(decoded.positions[i] - original[i]));
  }
  if (order == Order::ranges) json["own_range"] = stats_json(summarise(range_errors));
  json["own_point"] = stats_json(summarise(point_errors));
  return json;
}

Status print_peer(const Grid& grid, const Peer& peer, std::size_t settings) {
  if (!peer.run) {
    print_line({{"codec", peer.name}, {"skipped", kNotBuilt}});
    return {};
  }
  for (const double setting : thinned(peer.sweep, settings)) {
    Json line{{"codec", peer.name}, {"setting", fmt::format("{} {}", peer.setting, setting)}};
    Result<Decoded> decoded = peer.run(grid, setting);
    if (!decoded) {
      line["skipped"] = decoded.error().message;
    } else {
      CURLIDAR_TRY_ASSIGN(errors, errors_json(grid, decoded->cloud, decoded->order));
      line["bytes"] = decoded->bytes;
      line["encode_ms"] = decoded->encode_ms;
      line["decode_ms"] = decoded->decode_ms;
      line.update(errors);
    }
    print_line(line);
  }
  return {};
}

using Arguments = std::vector<std::string>;
const Error kUsage{ErrorCode::invalid_argument,
                   "usage: rate_distortion peers GRID [--settings N] | errors GRID DECODED | "
                   "cloud SCAN [--codecs NAME,NAME..] [--settings N]"};

Result<Grid> read_grid(const std::string& path) {
  CURLIDAR_TRY_ASSIGN(cloud, read_cloud(path));
  return make_grid(cloud, path);
}

Status print_peers(const std::string& grid_path, std::size_t settings) {
  CURLIDAR_TRY_ASSIGN(grid, read_grid(grid_path));
  print_line(
      {{"rows", grid.mask.rows}, {"cols", grid.mask.columns}, {"cells", grid.ranges_m.size()}});
  for (const Peer& peer : all_peers()) CURLIDAR_TRY(print_peer(grid, peer, settings));
  return {};
}

Status print_errors(const std::string& grid_path, const std::string& decoded_path) {
  CURLIDAR_TRY_ASSIGN(grid, read_grid(grid_path));
  CURLIDAR_TRY_ASSIGN(decoded, read_cloud(decoded_path));
  // A decoder that gives back every slot gives back empty cells too.
  CURLIDAR_TRY_ASSIGN(errors, errors_json(grid, returns_of(decoded), Order::ranges));
  print_line(errors);
  return {};
}

std::vector<std::string> names_of(std::string_view list) {
  std::vector<std::string> names;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    names.emplace_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return names;
}

Result<CloudOptions> options_of(const Arguments& arguments) {
  CloudOptions options;
  for (std::size_t i = 2; i + 1 < arguments.size(); i += 2) {
    const std::string &option = arguments[i], &value = arguments[i + 1];
    if (option == "--codecs" && arguments[0] == "cloud") {
      options.codecs = names_of(value);
      continue;
    }
    const char* const end = value.data() + value.size();
    const auto parsed = std::from_chars(value.data(), end, options.settings);
    if (option != "--settings" || parsed.ec != std::errc() || parsed.ptr != end) return kUsage;
  }
  return options;
}

Status run(const Arguments& arguments) {
  const std::string what = arguments.empty() ? "" : arguments[0];
  if (what == "errors" && arguments.size() == 3) return print_errors(arguments[1], arguments[2]);
  if ((what != "peers" && what != "cloud") || arguments.size() % 2 != 0) return kUsage;
  CURLIDAR_TRY_ASSIGN(options, options_of(arguments));
  if (what == "peers") return print_peers(arguments[1], options.settings);
  return print_cloud(arguments[1], options);
}

}  // namespace
}  // namespace curlidar::bench

int main(int argc, char** argv) {
  const auto status = curlidar::bench::run({argv + 1, argv + argc});
  if (status) return 0;
  fmt::print(stderr, "rate_distortion: {}\n", status.error().message);
  return 1;
}
