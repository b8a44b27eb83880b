// SPDX-License-Identifier: BSD-3-Clause
#include "cloud.hpp"

#include <algorithm>
#include <map>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/sensor.hpp"
#include "peers/peers.hpp"
#include "report_json.hpp"

namespace curlidar::bench {
namespace {

// Sweeps that span mean errors of 1 mm to 5 cm on raw scans, which reach farther than the grids.
const std::map<std::string, std::vector<double>> kSweeps = {
    {"pcl-octree", {.002, .004, .008, .016, .028, .056, .112, .16}},
    {"draco-kd-tree", {6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18}},
    {"xyz-zstd19", {.002, .004, .008, .016, .028, .056, .112, .16}}};
// Points that share a cell are lost: finer steps than these do not make the error less.
const std::vector<double> kRangeSteps_m = {.004, .01, .02, .04, .08, .16, .28, .4};
// The fewest are for sensors that have no more: on those they cost least and lose next to nothing.
constexpr std::size_t kColumns[] = {1024, 2048, 4096};

/// What a codec is given, and what its time and error count from.
struct Input {
  Grid grid;
  double project_ms = 0;  ///< of making the range image: a part of encoding
  std::string failure;    ///< why there is no such input
  bool left_out = false;  ///< whether it is not worth a codec's while
};

/// A codec with the input it takes.
struct Contest {
  Peer peer;
  const Input* input;
};

Input points_of(const Cloud& returns) {
  return {{{}, returns, {}}, 0, {}, false};
}

Input range_image_of(const Cloud& cloud, const Result<Detection>& found, std::size_t columns) {
  if (!found) return {{}, 0, found.error().message, false};
  if (columns == kColumns[0] && found->sensor.columns > columns) return {{}, 0, {}, true};
  CpuTimer timer;
  Input input{ring_image(cloud, *found, columns), 0, {}, false};
  input.project_ms = timer.lap_ms();
  return input;
}

std::vector<Contest> contests_of(const Input& points, const std::vector<Input>& images) {
  std::vector<Contest> contests;
  for (Peer& peer : all_peers()) {
    const auto sweep = kSweeps.find(peer.name);
    if (sweep != kSweeps.end()) {
      peer.sweep = sweep->second;
      contests.push_back({peer, &points});
      continue;
    }
    peer.sweep = kRangeSteps_m;
    for (std::size_t i = 0; i < images.size(); ++i) {
      Peer named = peer;
      named.name += fmt::format("-{}", kColumns[i]);
      contests.push_back({named, &images[i]});
    }
  }
  return contests;
}

Result<Json> measured_json(const Cloud& returns, const Input& input, const Decoded& decoded) {
  CURLIDAR_TRY_ASSIGN(nearest, compare(returns, decoded.cloud));
  return Json{{"bytes", decoded.bytes},
              {"points_back", decoded.cloud.size()},
              {"nearest_to_decoded", stats_json(nearest.a_to_b)},
              {"nearest_to_raw", stats_json(nearest.b_to_a)},
              {"encode_ms", input.project_ms + decoded.encode_ms},
              {"decode_ms", decoded.decode_ms}};
}

Status print_contest(const Cloud& returns, const Contest& contest, std::size_t settings) {
  const Peer& peer = contest.peer;
  const Input& input = *contest.input;
  if (!peer.run || !input.failure.empty()) {
    print_line({{"codec", peer.name}, {"skipped", peer.run ? input.failure : kNotBuilt}});
    return {};
  }
  for (const double setting : thinned(peer.sweep, settings)) {
    Json line{{"codec", peer.name}, {"setting", fmt::format("{} {}", peer.setting, setting)}};
    const Result<Decoded> decoded = peer.run(input.grid, setting);
    if (decoded) {
      CURLIDAR_TRY_ASSIGN(measured, measured_json(returns, input, *decoded));
      line.update(measured);
    } else {
      line["skipped"] = decoded.error().message;
    }
    print_line(line);
  }
  return {};
}

}  // namespace

Status print_cloud(const std::string& scan_path, const CloudOptions& options) {
  CURLIDAR_TRY_ASSIGN(cloud, read_cloud(scan_path));
  const Result<Detection> found = detect_sensor(cloud);
  const Cloud returns = returns_of(cloud);
  // Rings are told from the whole scan, and belong to its slots.
  const Input points = points_of(returns);
  std::vector<Input> images;
  for (const std::size_t columns : kColumns) {
    images.push_back(range_image_of(cloud, found, columns));
  }
  const std::vector<Contest> contests = contests_of(points, images);
  for (const std::string& name : options.codecs) {
    if (std::none_of(contests.begin(), contests.end(),
                     [&](const Contest& c) { return c.peer.name == name; })) {
      return Error{ErrorCode::invalid_argument, "no codec is called " + name};
    }
  }
  print_line({{"returns", returns.size()}, {"sensor", found ? found->sensor.name : ""}});
  for (const Contest& contest : contests) {
    const auto& names = options.codecs;
    if (contest.input->left_out) continue;
    if (!names.empty() && std::find(names.begin(), names.end(), contest.peer.name) == names.end())
      continue;
    CURLIDAR_TRY(print_contest(returns, contest, options.settings));
  }
  return {};
}

}  // namespace curlidar::bench
