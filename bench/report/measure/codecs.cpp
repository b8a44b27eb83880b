// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/codecs.hpp"

#include <fmt/format.h>

namespace curlidar::bench {
namespace {

EncodeSettings compact(Coverage coverage, CompactTarget target, double value) {
  EncodeSettings settings;
  settings.profile = Profile::compact;
  settings.compact.coverage = coverage;
  settings.compact.target = target;
  settings.compact.target_value = value;
  settings.compact.index = false;
  settings.attributes.emplace();
  settings.threads = 1;
  return settings;
}

}  // namespace

EncodeSettings compact_of_image(double error_m) {
  return compact(Coverage::image, CompactTarget::error, error_m);
}

EncodeSettings compact_of_scan(CompactTarget target, double value) {
  return compact(Coverage::every_return, target, value);
}

std::string paper_setting(Profile profile) {
  const PaperSettings settings = for_profile({}, profile);
  if (profile == Profile::paper_global) return fmt::format("degree {}", settings.global_degree);
  return fmt::format("S {}x{}, P_r {}", settings.upsample_rows, settings.upsample_columns,
                     settings.patch);
}

std::string error_setting(double error_m) {
  return error_m < 0.01 ? fmt::format("{:g} mm", 1000 * error_m)
                        : fmt::format("{:g} cm", 100 * error_m);
}

}  // namespace curlidar::bench
