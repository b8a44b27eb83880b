// SPDX-License-Identifier: BSD-3-Clause
// surface_tool FOLDER CORPUS: makes the golden tiles and their twins, and seeds of fuzzing, anew;
// for changes of the format only.
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "golden/surface_twin.hpp"
#include "map/surface_tile.hpp"
#include "support/surface_scenes.hpp"

namespace {

using namespace curlidar;

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// `more`: samples of passes after the first.
bool make(const std::string& folder, const std::string& corpus, const std::string& name,
          std::vector<MapSample> samples, const SurfaceSettings& settings,
          const std::vector<std::vector<MapSample>>& more = {}) {
  // Fewer samples: the second decoder is slow.
  for (MapSample& sample : samples) sample.intensity = static_cast<float>(sample.position.x) / 16;
  auto bytes = encode_surface_tile(samples, settings, 16);
  if (!bytes) return false;
  for (const std::vector<MapSample>& added : more) {
    auto longer = append_surface_tile(*bytes, added, settings);
    if (!longer || longer->bytes.empty()) return false;
    *bytes = std::move(longer->bytes);
  }
  const auto tile = decode_surface_tile(*bytes);
  if (!tile) return false;
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  write(folder + "/" + name + ".tile", text);
  write(folder + "/" + name + ".txt", test::surface_twin(*tile));
  write(corpus + "/" + name, "\x02" + text);
  std::printf("%s: %zu bytes, %zu leaves\n", name.c_str(), bytes->size(), tile->leaves.size());
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  SurfaceSettings fine;
  fine.step_m = 0.03;
  fine.metres_per_bit = 0.05;
  fine.footprint_m = 0.125;
  SurfaceSettings bent = fine;
  bent.curves = bent.intensity = true;
  bent.intensity_step = 0.25;
  SurfaceSettings deep;
  deep.root_m = 8;
  deep.smallest_leaf_m = 0.25;
  deep.footprint_m = 0.5;
  deep.metres_per_bit = 0.02;
  const bool made = make(argv[1], argv[2], "plane", test::plane_samples(16, 0.05), {}) &&
                    make(argv[1], argv[2], "box", test::box_samples(16), fine) &&
                    make(argv[1], argv[2], "sphere-curves", test::sphere_samples(16), bent) &&
                    make(argv[1], argv[2], "box-deep", test::box_samples(16), deep) &&
                    make(argv[1], argv[2], "nothing", {}, {}) &&
                    make(argv[1], argv[2], "passes", test::plane_samples(16, 0.05), fine,
                         {test::box_samples(16), test::sphere_samples(16)});
  return made ? 0 : 1;
}
