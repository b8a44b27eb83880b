// SPDX-License-Identifier: BSD-3-Clause
// train_surface_priors LIST [FOLDER]: reads lines "GROUP POSES SCAN..." (POSES: rows of
// T_map_sensor, 3x4, or - for a single scan where it stands), adds short simulated drives, searches
// the tiles of each map at several settings, says what they cost with priors that their own group
// did not teach, and writes surface.txt and surface_mix.txt, taught by all groups but "test", into
// FOLDER.
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/parallel.hpp"
#include "curlidar/io.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/simulate.hpp"
#include "map/sample_grid.hpp"
#include "map/tile_encoder.hpp"
#include "priors/train.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::tile;

constexpr double kSide_m = 32, kNearest_m = 2.5, kFarthest_m = 80;

struct TileScan {
  std::string name;
  TileLayout layout;
  std::vector<RootTree> roots;
};

struct TileRoom {
  using Model = TileModels;
  using Scan = TileScan;

  Model fresh() const { return TileModels::blank(); }
  std::span<BitModel> models(Model& model) const { return model.models; }
  std::vector<std::int32_t> weights(const Model& model) const {
    std::vector<std::int32_t> out;
    for (const auto& mix : model.weights) {
      out.insert(out.end(), mix.weight.begin(), mix.weight.end());
    }
    return out;
  }
  void set_weights(Model& model, std::span<const std::int32_t> weights) const {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      model.weights[i / kTileInputs].weight[i % kTileInputs] = weights[i];
    }
  }
  template <class Coder>
  void code(Coder& coder, Model& model, const Scan& scan, std::int32_t rate) const {
    TileSink<Coder> sink(coder, model, rate);
    code_trees(sink, scan.layout, scan.roots);
  }
};

/// Samples of a map, tile by tile.
class Union {
 public:
  void add(const Cloud& cloud, const RigidMotion& T_map_sensor, float intensity_scale) {
    const Attribute* intensity = nullptr;
    for (const Attribute& attribute : cloud.attributes) {
      if (attribute.name == "intensity") intensity = &attribute;
    }
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const double range = norm(cloud.positions[i]);
      if (!(range > kNearest_m && range < kFarthest_m)) continue;
      const Vec3 p = T_map_sensor(cloud.positions[i]);
      const auto x = std::floor(p.x / kSide_m), y = std::floor(p.y / kSide_m);
      tiles_[{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}].add(
          {p.x - x * kSide_m, p.y - y * kSide_m, p.z},
          intensity == nullptr ? std::nanf("")
                               : static_cast<float>(intensity->as_double(i)) * intensity_scale);
    }
  }
  const std::map<std::pair<std::int32_t, std::int32_t>, SampleGrid>& tiles() const {
    return tiles_;
  }

 private:
  std::map<std::pair<std::int32_t, std::int32_t>, SampleGrid> tiles_;
};

/// A scene seen from elsewhere.
class Moved : public Scene {
 public:
  Moved(std::shared_ptr<const Scene> scene, const Vec3& by) : scene_(std::move(scene)), by_(by) {}
  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    return scene_->cast(origin + by_, direction, hit);
  }

 private:
  std::shared_ptr<const Scene> scene_;
  Vec3 by_;
};

Union simulated(const std::string& name, std::uint64_t seed, const std::string& sensor) {
  Union out;
  const auto scene = make_scene(name, seed);
  const auto profile = builtin_sensor(sensor);
  if (!scene || !profile) return out;
  for (int k = 0; k < 6; ++k) {
    RigidMotion T_map_sensor;
    T_map_sensor.move = {1.0 * k, 0, 0};
    SimulateSettings settings;
    settings.seed = seed * 100 + static_cast<std::uint64_t>(k);
    settings.range_noise_m = 0.02;
    const auto cloud = simulate(Moved(*scene, T_map_sensor.move), *profile, settings);
    if (cloud) out.add(*cloud, T_map_sensor, 1);
  }
  return out;
}

std::vector<RigidMotion> read_motions(const std::string& path) {
  std::ifstream file(path);
  std::vector<RigidMotion> out;
  std::array<double, 12> v{};
  while (file) {
    for (double& number : v) file >> number;
    if (!file) break;
    RigidMotion motion;
    for (std::size_t row = 0; row < 3; ++row) {
      motion.rotation[row] = {v[4 * row], v[4 * row + 1], v[4 * row + 2]};
    }
    motion.move = {v[3], v[7], v[11]};
    out.push_back(motion);
  }
  return out;
}

struct Job {
  std::string group, name;
  Union map;
};

std::vector<SurfaceSettings> settings_of_training() {
  std::vector<SurfaceSettings> out;
  for (const auto& [step, bit, footprint] : {std::array{0.1, 0.25, 0.25},
                                             {0.1, 0.12, 0.25},
                                             {0.2, 0.25, 0.25},
                                             {0.1, 0.05, 0.125},
                                             {0.05, 0.03, 0.125},
                                             {0.05, 0.015, 0.125}}) {
    SurfaceSettings settings;
    settings.step_m = step;
    settings.metres_per_bit = bit;
    settings.footprint_m = footprint;
    settings.curves = step == 0.2 || bit == 0.03;
    settings.intensity = bit == 0.12 || bit == 0.03;
    out.push_back(settings);
  }
  return out;
}

using Trainer = training::Trainer<TileRoom>;

void report(const Trainer& trainer, const std::vector<training::Example<TileScan>>& examples) {
  double blank_sum = 0, trained_sum = 0;
  for (const std::string& group : trainer.groups()) {
    const auto priors = trainer.train({group, "test"});
    double blank_group = 0, trained_group = 0;
    for (const auto& example : examples) {
      if (example.group != group) continue;
      blank_group += trainer.bits(example.scan, TileModels::blank(), kTileMixRate);
      trained_group += trainer.bits(example.scan, trainer.start(priors), kTileMixRate);
    }
    fmt::print("{:20} blank {:9.0f} trained {:9.0f} bits {:6.3f}\n", group, blank_group,
               trained_group, trained_group / blank_group);
    blank_sum += blank_group;
    trained_sum += trained_group;
  }
  fmt::print("all {:.4f}\n", trained_sum / blank_sum);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: train_surface_priors LIST [FOLDER]\n";
    return 2;
  }
  std::vector<Job> jobs;
  std::ifstream list(argv[1]);
  for (std::string line; std::getline(list, line);) {
    std::istringstream in(line);
    Job job;
    std::string poses;
    in >> job.group >> poses;
    const std::vector<RigidMotion> motions =
        poses == "-" ? std::vector<RigidMotion>(1) : read_motions(poses);
    std::size_t k = 0;
    for (std::string path; in >> path && k < motions.size(); ++k) {
      const auto cloud = read_cloud(path);
      if (!cloud) {
        std::cerr << cloud.error().message << '\n';
        return 1;
      }
      job.name = path;
      job.map.add(*cloud, motions[k], 1);
    }
    jobs.push_back(std::move(job));
  }
  for (const std::string scene : {"street", "forest", "newer-college", "corridor", "room"}) {
    jobs.push_back({"sim-" + scene, scene, simulated(scene, 3, "hdl64e-kitti")});
    jobs.push_back({"sim-" + scene, scene, simulated(scene, 4, "os1-64")});
  }
  const auto settings = settings_of_training();
  std::vector<std::vector<training::Example<TileScan>>> found(jobs.size() * settings.size());
  parallel_for(found.size(), 0, [&](std::size_t i) {
    const Job& job = jobs[i / settings.size()];
    for (const auto& [key, grid] : job.map.tiles()) {
      auto tile = encode_tile(grid.samples(), settings[i % settings.size()], kSide_m, true);
      if (!tile || tile->bytes.size() < 24) continue;
      found[i].push_back({job.group, {job.name, tile->layout, std::move(tile->roots)}});
    }
    std::cerr << '.' << std::flush;
  });
  std::vector<training::Example<TileScan>> examples;
  for (auto& some : found) {
    for (auto& one : some) examples.push_back(std::move(one));
  }
  std::cerr << examples.size() << " tiles\n";
  const Trainer trainer(TileRoom{}, examples, kTileMixRate);
  if (argc < 3 || std::string(argv[2]) == "-") {
    report(trainer, examples);
    return 0;
  }
  const auto priors = trainer.train({"test"});
  std::vector<std::int32_t> weights;
  for (const std::int32_t weight : priors.weights) weights.push_back(weight / 16);
  const std::string folder = argv[2];
  const bool written =
      training::write_text(
          folder + "/surface.txt",
          training::format_states(priors.states,
                                  "# First states of the models of a surface tile, kind by kind: "
                                  "see the specification.\n")) &&
      training::write_text(
          folder + "/surface_mix.txt",
          training::format_weights(weights, "# First weights of its mixes, five to a mix.\n"));
  return written ? 0 : 1;
}
