// SPDX-License-Identifier: BSD-3-Clause
// Measurements of the report that the command cannot make: a verb each, JSON lines out.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/measure/verbs.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::bench;

struct Verb {
  const char* name;
  std::size_t words;
  std::vector<std::string> options;
  const char* usage;
  Status (*run)(const Arguments&);
};

const std::vector<Verb> kVerbs{
    {"one-to-one", 1, {"preset", "sensor"}, "SCAN [--preset P] [--sensor S]", one_to_one},
    {"truth",
     3,
     {"factors", "seed", "baseline", "rays"},
     "SCENE SENSOR PRESET [--factors 2,4,8] [--seed N] [--baseline 1] [--rays N]",
     truth},
    {"held-out",
     1,
     {"every", "preset", "sensor", "profile", "confidence"},
     "SCAN [--every K] [--preset P] [--sensor S] [--profile P] [--confidence P]",
     held_out},
    {"borders", 1, {"preset", "sensor"}, "SCAN [--preset P] [--sensor S]", borders},
    {"borders-truth", 3, {"seed"}, "SCENE SENSOR PRESET [--seed N]", borders_truth},
    {"range-images",
     2,
     {"every", "factor", "preset", "sensor"},
     "SCAN OUT.npy [--every K] [--factor R] [--preset P] [--sensor S]",
     range_images},
    {"range-images-truth",
     4,
     {"factor", "seed"},
     "SCENE SENSOR PRESET OUT.npy [--factor R] [--seed N]",
     range_images_truth},
    {"nearest",
     1,
     {"every", "preset", "sensor"},
     "SCAN [--every K] [--preset P] [--sensor S]",
     nearest},
    {"sparse", 1, {"every", "preset", "sensor"}, "SCAN [--every K] [--sensor S]", sparse},
    {"as-sensor", 4, {"seed"}, "SCENE SENSOR PRESET OTHER_SENSOR [--seed N]", as_sensor},
    {"timing",
     1,
     {"runs", "preset", "sensor"},
     "SCAN [--runs N] [--preset P] [--sensor S]",
     timing},
    {"upsampling",
     1,
     {"preset", "sensor", "profile", "rings-profile"},
     "SCAN [--sensor S] [--profile P] [--rings-profile P]",
     upsampling},
};

int usage() {
  fmt::print(stderr, "usage:\n");
  for (const Verb& verb : kVerbs) {
    fmt::print(stderr, "  report_measure {} {}\n", verb.name, verb.usage);
  }
  return 2;
}

int run(const std::vector<std::string>& given) {
  for (const Verb& verb : kVerbs) {
    if (given.empty() || given.front() != verb.name) continue;
    const Result<Arguments> arguments =
        parse_arguments({given.begin() + 1, given.end()}, verb.words, verb.options);
    if (!arguments) {
      fmt::print(stderr, "report_measure {}: {}\nusage: report_measure {} {}\n", verb.name,
                 arguments.error().message, verb.name, verb.usage);
      return 2;
    }
    const Status status = verb.run(*arguments);
    if (status) return 0;
    fmt::print(stderr, "report_measure {}: {}\n", verb.name, status.error().message);
    return 1;
  }
  return usage();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {  // of peer codecs and the standard library
    fmt::print(stderr, "report_measure: {}\n", error.what());
    return 1;
  }
}
