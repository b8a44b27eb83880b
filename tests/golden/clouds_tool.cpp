// SPDX-License-Identifier: BSD-3-Clause
// Makes the golden files with every return anew, for changes of the format only.
//   clouds_tool FOLDER      writes FOLDER/NAME.curl and FOLDER/NAME.json
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "golden/clouds_twin.hpp"
#include "support/promised_clouds.hpp"

namespace curlidar::test {
namespace {

struct Golden {
  std::string name;
  Cloud cloud;
  CompactTarget target;
  double value;
  std::optional<SensorProfile> sensor{};
  std::vector<std::string> attributes{};
};

std::vector<Golden> golden_clouds() {
  const SensorProfile sensor = exact_sensor(6, 48);
  const Cloud rays = exact_scan(sensor);
  const Cloud two = with_second_returns(
      rays, [](std::size_t i, const Vec3& p) { return i % 9 == 0 ? p * 1.3 : Vec3{}; });
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Cloud holes =
      with_holes(with_holes(unsteady_scan(6, 64), 7, {nan, nan, nan}), 30, {0, 0, 0});
  const Cloud doubles = points_by(90, ScalarType::float64, [](std::size_t i, Random& random) {
    return Vec3{uniform(random, -9, 9), i % 10 == 0 ? -0.0 : uniform(random, -9, 9), 1e6};
  });
  Cloud typed = organised_scan(6, 40);
  std::vector<std::uint16_t> row;
  std::vector<float> hundredths;
  std::vector<std::int8_t> level;
  for (std::uint32_t i = 0; i < typed.size(); ++i) {
    row.push_back(static_cast<std::uint16_t>(i / typed.width));
    hundredths.push_back(static_cast<float>(mixed(i) % 17) / 100);
    level.push_back(static_cast<std::int8_t>(20 * std::sin(i % 40 * 0.2) + mixed(i) % 5));
  }
  typed.attributes = {{"row", 1, std::move(row)},
                      {"intensity", 1, std::move(hundredths)},
                      {"level", 1, std::move(level)}};
  return {{"rays-bound", two, CompactTarget::max_error, 0.02, sensor, {"ring", "return"}},
          {"rays-lossless", shuffled(rays), CompactTarget::lossless, 0, sensor, {"ring"}},
          {"rings-directions", holes, CompactTarget::error, 0.1, {}, {"ring"}},
          {"loose-doubles", doubles, CompactTarget::lossless, 0},
          {"organised", organised_scan(8, 48), CompactTarget::max_error, 0.01},
          {"attributes", typed, CompactTarget::error_nn, 0.03, {}, {"row", "intensity", "level"}}};
}

int write(const std::filesystem::path& folder, const Golden& golden) {
  EncodeSettings settings;
  settings.sensor = golden.sensor;
  settings.attributes = golden.attributes;
  settings.compact.target = golden.target;
  settings.compact.target_value = golden.value;
  settings.compact.effort = 1;
  const auto file = encode(golden.cloud, settings);
  const auto scan = file ? decode(file->bytes) : Result<DecodedScan>(file.error());
  if (!scan) {
    std::fprintf(stderr, "%s: %s\n", golden.name.c_str(), scan.error().message.c_str());
    return 1;
  }
  std::ofstream curl(folder / (golden.name + ".curl"), std::ios::binary);
  for (const std::byte b : file->bytes) curl.put(static_cast<char>(b));
  std::ofstream(folder / (golden.name + ".json")) << twin_of(*scan).dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace curlidar::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: clouds_tool FOLDER\n", stderr);
    return 2;
  }
  int failed = 0;
  for (const auto& golden : curlidar::test::golden_clouds()) {
    failed |= curlidar::test::write(argv[1], golden);
  }
  return failed;
}
