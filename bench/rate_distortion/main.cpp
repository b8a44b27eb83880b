// SPDX-License-Identifier: BSD-3-Clause
// Measures for ./dev rate-distortion, one JSON object a line.
//   rate_distortion peers GRID           size of the grid, then every peer over its settings
//   rate_distortion errors GRID DECODED  a decoded cloud with a point for each occupied cell
// GRID is an organised cloud of `curlidar project`. Rates count every byte of a stream.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/try.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/io.hpp"
#include "peers/peers.hpp"

namespace curlidar::bench {

namespace {

using Json = nlohmann::ordered_json;

Json stats_json(const DistanceStats& stats) {
  return {{"mean", stats.mean}, {"rms", stats.rms}, {"p95", stats.p95}, {"max", stats.max}};
}

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

Status print_peer(const Grid& grid, const Peer& peer) {
  if (!peer.run) {
    fmt::print("{}\n", Json{{"codec", peer.name}, {"skipped", "not built"}}.dump());
    return {};
  }
  for (const double setting : peer.sweep) {
    Json line{{"codec", peer.name}, {"setting", fmt::format("{} {}", peer.setting, setting)}};
    Result<Decoded> decoded = peer.run(grid, setting);
    if (!decoded) {
      line["skipped"] = decoded.error().message;
    } else {
      CURLIDAR_TRY_ASSIGN(errors, errors_json(grid, decoded->cloud, decoded->order));
      line["bytes"] = decoded->bytes;
      line.update(errors);
    }
    fmt::print("{}\n", line.dump());
    std::fflush(stdout);
  }
  return {};
}

Status run(std::string_view what, const std::string& grid_path, const char* decoded_path) {
  CURLIDAR_TRY_ASSIGN(cloud, read_cloud(grid_path));
  CURLIDAR_TRY_ASSIGN(grid, make_grid(cloud, grid_path));
  if (what == "peers") {
    fmt::print(
        "{}\n",
        Json{{"rows", grid.mask.rows}, {"cols", grid.mask.columns}, {"cells", grid.ranges_m.size()}}
            .dump());
    for (const Peer& peer : all_peers()) CURLIDAR_TRY(print_peer(grid, peer));
    return {};
  }
  CURLIDAR_TRY_ASSIGN(decoded, read_cloud(decoded_path));
  CURLIDAR_TRY_ASSIGN(errors, errors_json(grid, decoded, Order::ranges));
  fmt::print("{}\n", errors.dump());
  return {};
}

}  // namespace
}  // namespace curlidar::bench

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (!(what == "peers" && argc == 3) && !(what == "errors" && argc == 4)) {
    fmt::print(stderr, "usage: rate_distortion peers GRID | errors GRID DECODED\n");
    return 2;
  }
  const auto status = curlidar::bench::run(what, argv[2], argc > 3 ? argv[3] : "");
  if (status) return 0;
  fmt::print(stderr, "rate_distortion: {}\n", status.error().message);
  return 1;
}
