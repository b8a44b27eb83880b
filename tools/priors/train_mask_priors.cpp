// SPDX-License-Identifier: BSD-3-Clause
// train_mask_priors LIST [FOLDER]: reads lines "GROUP PATH" of organised clouds (one sensor or
// drive a group), says what masks cost with priors that their own group did not teach (one column
// for each way of learning), and writes mask.txt and mask_mix.txt, taught by all groups but "test",
// into FOLDER.
//
// Those of docs/format/priors come from `curlidar project --rows rings` of KITTI (odometry 00, raw,
// object), HDL-32E, Ouster OS-0, OS-1 and OS-2, XT16, and a room scanned by a tilting laser (181
// uniform rows): 512 and 1024 columns from 5 m to p90, 1024 and, but for KITTI odometry 00 and
// Ouster, 2048 columns from 1 m on. Changing them changes the format.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "compact/mask_model.hpp"
#include "curlidar/io.hpp"
#include "priors/train.hpp"

namespace {

using namespace curlidar;

struct MaskScanCells {
  std::string name;
  compact::MaskShape shape;
  std::vector<std::uint8_t> occupied;
  std::size_t count = 0;
};

struct MaskRoom {
  using Model = compact::MaskModel;
  using Scan = MaskScanCells;

  Model fresh() const { return Model(); }
  std::span<BitModel> models(Model& model) const { return model.models(); }
  std::vector<std::int32_t> weights(const Model& model) const {
    std::vector<std::int32_t> out;
    for (const auto& set : model.weights()) {
      for (std::size_t i = 0; i < compact::kMaskInputs; ++i) out.push_back(set.fine(i) >> 4);
    }
    return out;
  }
  void set_weights(Model& model, std::span<const std::int32_t> weights) const {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      model.weights()[i / compact::kMaskInputs].set(i % compact::kMaskInputs, weights[i] * 16);
    }
  }
  template <class Coder>
  void code(Coder& coder, Model& model, const Scan& scan, std::int32_t rate) const {
    compact::code_mask(coder, model, scan.shape, rate, scan.occupied.data(),
                       [](std::size_t) { return true; });
  }
};

using Examples = std::vector<training::Example<MaskScanCells>>;

bool read_scan(const std::string& path, MaskScanCells& scan) {
  const auto cloud = read_cloud(path);
  if (!cloud || !cloud->organised()) {
    std::cerr << path << ": not an organised cloud\n";
    return false;
  }
  scan.name = path.substr(path.rfind('/') + 1);
  scan.shape = {cloud->height, cloud->width, cloud->width};
  for (const Vec3& p : cloud->positions) scan.occupied.push_back(is_return(p));
  scan.count = count_returns(*cloud);
  return true;
}

/// The world seen in a mirror is as likely: twice the scans to learn from.
MaskScanCells mirrored(MaskScanCells scan) {
  for (std::size_t row = 0; row < scan.shape.rows; ++row) {
    const auto begin =
        scan.occupied.begin() + static_cast<std::ptrdiff_t>(row * scan.shape.columns);
    std::reverse(begin, begin + static_cast<std::ptrdiff_t>(scan.shape.columns));
  }
  return scan;
}

void report(const training::Trainer<MaskRoom>& trainer, const Examples& scans,
            const std::string& group, const training::Priors& priors) {
  const auto& ways = compact::kMaskLearning;
  for (const auto& [name, scan] : scans) {
    if (name != group) continue;
    fmt::print("{:<28} {:>3} x {:<4} {:>6} occupied, bits each:", scan.name, scan.shape.rows,
               scan.shape.columns, scan.count);
    for (const auto& way : ways) {
      compact::MaskModel model = way.priors ? trainer.start(priors) : compact::MaskModel();
      model.doubt(way.trust);
      const double bits = trainer.bits(scan, std::move(model), way.rate);
      fmt::print(" {:.4f}", bits / static_cast<double>(scan.count));
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "Usage: train_mask_priors LIST [FOLDER]\n";
    return 2;
  }
  Examples scans, lessons;
  std::ifstream list(argv[1]);
  for (std::string group, path; list >> group >> path;) {
    MaskScanCells scan;
    if (!read_scan(path, scan)) return 1;
    if (scan.count == 0) continue;
    scans.push_back({group, scan});
    if (group == "test") continue;
    lessons.push_back({group, scan});
    lessons.push_back({group, mirrored(scan)});
  }
  const training::Trainer<MaskRoom> trainer(MaskRoom{}, lessons, compact::kMaskLearning[0].rate);
  for (const std::string& group : trainer.groups()) {
    report(trainer, scans, group, trainer.train({group}));
  }
  training::Priors priors = trainer.train({});
  report(trainer, scans, "test", priors);
  if (argc < 3) return 0;
  for (std::int32_t& weight : priors.weights) weight = (weight + 8) >> 4;
  const std::string folder = std::string(argv[2]) + "/";
  const bool written =
      training::write_text(
          folder + "mask.txt",
          training::format_states(priors.states, "# States of the mask's models: 8 x 1024.\n")) &&
      training::write_text(
          folder + "mask_mix.txt",
          training::format_weights(priors.weights, "# Weights of the mask's mix: 128 x 48.\n"));
  if (!written) std::cerr << folder << ": cannot write\n";
  return written ? 0 : 1;
}
