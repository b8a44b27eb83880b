// SPDX-License-Identifier: BSD-3-Clause
// train_field_priors LIST [FOLDER]: reads lines "GROUP PATH" of organised clouds (one sensor or
// drive a group), searches fields for each at several steps, says what they cost with priors that
// their own group did not teach, and writes field.txt and field_mix.txt, taught by all groups but
// "test", into FOLDER.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "base/parallel.hpp"
#include "compact/field_encoder.hpp"
#include "compact/scan_effort.hpp"
#include "curlidar/io.hpp"
#include "priors/train.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::compact;

/// A scan as the field sees it.
struct Grid {
  std::unique_ptr<Geometry> geometry;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges;
};

struct FieldScan {
  std::string name;
  const Grid* grid = nullptr;
  FieldSettings settings;
  std::vector<Node> roots;
};

struct FieldRoom {
  using Model = FieldModels;
  using Scan = FieldScan;

  Model fresh() const { return FieldModels::blank(); }
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
      model.weights[i / kFieldInputs].weight[i % kFieldInputs] = weights[i];
    }
  }
  template <class Coder>
  void code(Coder& coder, Model& model, const Scan& scan, std::int32_t rate) const {
    FieldState state(*scan.grid->geometry, scan.grid->occupied, scan.settings);
    MixSink<Coder> sink(coder, model, rate);
    std::vector<Node> roots = scan.roots;
    for (Node& root : roots) code_node(sink, state, root);
  }
};

bool read_grid(const std::string& path, Grid& grid) {
  const auto cloud = read_cloud(path);
  if (!cloud || !cloud->organised()) {
    std::cerr << path << ": not an organised cloud\n";
    return false;
  }
  std::vector<std::int32_t> elevations(cloud->height);
  double previous = 0.1;
  for (std::size_t row = 0; row < cloud->height; ++row) {
    double sum = 0;
    int count = 0;
    for (std::size_t column = 0; column < cloud->width; ++column) {
      const Vec3& p = cloud->positions[row * cloud->width + column];
      const double range = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
      const bool occupied = is_return(p);
      grid.occupied.push_back(occupied ? 1 : 0);
      grid.ranges.push_back(occupied ? static_cast<std::int32_t>(std::lround(range * kRangeUnit))
                                     : 0);
      if (!occupied) continue;
      sum += std::asin(p.z / range);
      ++count;
    }
    previous = count > 0 ? sum / count : previous - 0.007;
    elevations[row] = static_cast<std::int32_t>(angle_from_radians(previous));
  }
  grid.geometry = std::make_unique<Geometry>(std::move(elevations), cloud->width, 0, cloud->width);
  return true;
}

/// A thorough search that still takes seconds.
constexpr std::uint32_t kEffort = 7;

/// Takes each ring's offset, the median of what a coarse field leaves, off its ranges.
void remove_ring_offsets(Grid& grid) {
  const FieldSettings settings{kRangeUnit * 3 / 10, 4, 8};
  for (int round = 0; round < 2; ++round) {
    FieldState state(*grid.geometry, grid.occupied, settings);
    encode_field(state, grid.ranges, search_settings(kEffort, settings.step, 0).search);
    const std::size_t columns = grid.geometry->columns();
    for (std::size_t row = 0; row < grid.geometry->rows(); ++row) {
      std::vector<std::int32_t> left;
      for (std::size_t p = row * columns; p < (row + 1) * columns; ++p) {
        const std::int32_t error = grid.ranges[p] - state.range[p];
        if (grid.occupied[p] && std::abs(error) < kRangeUnit / 2) left.push_back(error);
      }
      if (left.size() < 50) continue;
      const auto middle = left.begin() + static_cast<std::ptrdiff_t>(left.size() / 2);
      std::nth_element(left.begin(), middle, left.end());
      for (std::size_t p = row * columns; p < (row + 1) * columns; ++p) {
        if (grid.occupied[p]) grid.ranges[p] = std::max(grid.ranges[p] - *middle, 1);
      }
    }
  }
}

/// Steps of training, millimetres; the last two below a residual layer.
constexpr int kSteps_mm[] = {800, 500, 300, 200, 120, 60, 40, 25};
constexpr int kResidualBelow_mm = 50;

FieldScan search_scan(const Grid& grid, const std::string& name, int step_mm) {
  FieldScan scan{name, &grid, {kRangeUnit * step_mm / 1000, 4, 8}, {}};
  const std::int32_t residual_step = step_mm < kResidualBelow_mm ? scan.settings.step : 0;
  const Effort effort = search_settings(kEffort, scan.settings.step, residual_step);
  FieldState state(*grid.geometry, grid.occupied, scan.settings);
  scan.roots = encode_field(state, grid.ranges, effort.search).roots;
  return scan;
}

using Trainer = training::Trainer<FieldRoom>;

void report(const Trainer& trainer, const std::vector<training::Example<FieldScan>>& examples) {
  double blank_sum = 0, trained_sum = 0;
  for (const std::string& group : trainer.groups()) {
    const auto priors = trainer.train({group, "test"});
    for (const auto& example : examples) {
      if (example.group != group) continue;
      const double blank = trainer.bits(example.scan, FieldModels::blank(), kFieldMixRate);
      const double trained = trainer.bits(example.scan, trainer.start(priors), kFieldMixRate);
      fmt::print("{:10} {:40} blank {:9.0f} trained {:9.0f} bits {:6.3f}\n", group,
                 example.scan.name, blank, trained, trained / blank);
      blank_sum += 1;
      trained_sum += trained / blank;
    }
  }
  fmt::print("mean ratio {:.4f}\n", trained_sum / blank_sum);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: train_field_priors LIST [FOLDER]\n";
    return 2;
  }
  std::ifstream list(argv[1]);
  std::vector<std::string> groups, paths;
  for (std::string group, path; list >> group >> path;) {
    groups.push_back(group);
    paths.push_back(path);
  }
  std::vector<Grid> grids(paths.size());
  const std::size_t steps = std::size(kSteps_mm);
  std::vector<training::Example<FieldScan>> examples(paths.size() * steps);
  std::vector<char> good(paths.size());
  parallel_for(paths.size(), 0, [&](std::size_t i) {
    if (!read_grid(paths[i], grids[i])) return;
    good[i] = 1;
    remove_ring_offsets(grids[i]);
    const std::string name = paths[i].substr(paths[i].rfind('/') + 1);
    for (std::size_t s = 0; s < steps; ++s) {
      examples[i * steps + s] = {
          groups[i],
          search_scan(grids[i], fmt::format("{} {} mm", name, kSteps_mm[s]), kSteps_mm[s])};
    }
    std::cerr << '.' << std::flush;
  });
  if (std::find(good.begin(), good.end(), 0) != good.end()) return 1;
  const Trainer trainer(FieldRoom{}, examples, kFieldMixRate);
  report(trainer, examples);
  if (argc < 3) return 0;
  const auto priors = trainer.train({"test"});
  std::vector<std::int32_t> weights;
  for (const std::int32_t weight : priors.weights) weights.push_back(weight / 16);
  const std::string folder = argv[2];
  const bool written =
      training::write_text(
          folder + "/field.txt",
          training::format_states(
              priors.states,
              "# First states of the field's models, kind by kind: see the specification.\n")) &&
      training::write_text(folder + "/field_mix.txt",
                           training::format_weights(
                               weights, "# First weights of the field's mixes, four to a mix.\n"));
  return written ? 0 : 1;
}
