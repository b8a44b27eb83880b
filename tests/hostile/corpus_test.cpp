// SPDX-License-Identifier: BSD-3-Clause
// The inputs kept of fuzzing, through the same targets: tests/hostile/corpus/TARGET/*, seeds and
// what once broke something.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "hostile/targets/container.hpp"
#include "hostile/targets/decode.hpp"
#include "hostile/targets/density.hpp"
#include "hostile/targets/field.hpp"
#include "hostile/targets/map.hpp"
#include "hostile/targets/mask.hpp"
#include "hostile/targets/points.hpp"
#include "hostile/targets/poses.hpp"
#include "hostile/targets/predicted.hpp"
#include "hostile/targets/rays.hpp"
#include "hostile/targets/records.hpp"
#include "hostile/targets/residual.hpp"
#include "hostile/targets/scan.hpp"
#include "hostile/targets/sequence.hpp"
#include "hostile/targets/surface.hpp"

namespace curlidar {
namespace {

struct Target {
  const char* name;
  std::string (*run)(ByteSpan);
};

constexpr Target kTargets[] = {{"container", test::container_target},
                               {"map", test::map_target},
                               {"mask", test::mask_target},
                               {"field", test::field_target},
                               {"residual", test::residual_target},
                               {"scan", test::scan_target},
                               {"decode", test::decode_target},
                               {"density", test::density_target},
                               {"poses", test::poses_target},
                               {"rays", test::rays_target},
                               {"order", test::order_target},
                               {"records", test::records_target},
                               {"loose", test::loose_target},
                               {"corrections", test::corrections_target},
                               {"directions", test::directions_target},
                               {"surface", test::surface_target},
                               {"predicted", test::predicted_target},
                               {"sequence", test::sequence_target}};

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const ByteSpan bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

class Corpus : public testing::TestWithParam<Target> {};

TEST_P(Corpus, BreaksNoPromise) {
  const std::filesystem::path folder =
      std::filesystem::path(CURLIDAR_TEST_FOLDER) / "corpus" / GetParam().name;
  std::size_t inputs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::vector<std::byte> bytes = bytes_of(entry.path());
    EXPECT_EQ(GetParam().run(bytes), "") << entry.path();
    // What a fuzzer would try first: the same with its end cut off.
    EXPECT_EQ(GetParam().run(ByteSpan(bytes).first(bytes.size() / 2)), "") << entry.path();
    ++inputs;
  }
  EXPECT_GT(inputs, 0u);
}

INSTANTIATE_TEST_SUITE_P(All, Corpus, testing::ValuesIn(kTargets),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace curlidar
