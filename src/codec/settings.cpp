// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/settings.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace curlidar {
namespace {

struct NamedPreset {
  std::string_view name;
  PaperSettings (*make)();
};

PaperSettings indoor() {
  PaperSettings s;
  s.min_range_m = 1;
  s.max_range = {};
  s.cliffs = {0.1, 0.1, 0.1414};
  s.accept_m = 0.1;
  return s;
}

PaperSettings newer_college() {
  PaperSettings s;
  s.min_range_m = 3;
  s.max_range = {};
  s.cliffs = {5, 2, 5.385};
  return s;
}

constexpr std::array<NamedPreset, 4> kPresets{{
    {"outdoor", [] { return PaperSettings{}; }},
    {"indoor", indoor},
    {"newer-college", newer_college},
    {"superrso", newer_college},
}};

constexpr std::array<Profile, 4> kProfiles{Profile::compact, Profile::paper, Profile::paper_1to1,
                                           Profile::paper_global};

bool limits_range(const RangeLimit& limit) {
  return limit.metres != 0 || limit.percentile != 0;
}

}  // namespace

const char* to_string(Profile profile) {
  switch (profile) {
    case Profile::compact:
      return "compact";
    case Profile::paper:
      return "paper";
    case Profile::paper_1to1:
      return "paper-1to1";
    case Profile::paper_global:
      return "paper-global";
  }
  return "unknown";
}

Result<Profile> profile_by_name(std::string_view name) {
  for (const Profile profile : kProfiles) {
    if (name == to_string(profile)) return profile;
  }
  return Error{ErrorCode::invalid_argument,
               "unknown profile '" + std::string(name) +
                   "'; known: compact, paper, paper-1to1, paper-global"};
}

bool keeps_every_return(const CompactSettings& s) {
  if (s.coverage != Coverage::automatic) return s.coverage == Coverage::every_return;
  return s.columns == 0 && s.min_range_m == 0 && !limits_range(s.max_range);
}

Status validate(const CompactSettings& s) {
  constexpr std::uint32_t kMaxParts = 64;
  const auto invalid = [](std::string what) {
    return Error{ErrorCode::invalid_argument, std::move(what)};
  };
  if (s.columns != 0 && (s.columns < 4 || s.columns > 65536)) {
    return invalid("columns must be in 4..65536, or 0 for a choice by the cloud");
  }
  if (!(s.min_range_m >= 0) || !std::isfinite(s.min_range_m)) {
    return invalid("the minimum range must be a finite number of metres, 0 or more");
  }
  if (!(s.max_range.metres >= 0) || !(s.max_range.percentile >= 0) ||
      s.max_range.percentile > 100) {
    return invalid("the maximum range must be metres above 0 or a percentile in (0, 100]");
  }
  if (s.effort < 1 || s.effort > kMaxEffort) return invalid("the effort must be in 1..9");
  if (s.bands > kMaxParts || s.sectors > kMaxParts) {
    return invalid("a scan has at most 64 bands of rows and 64 sectors of columns");
  }
  const bool limited = s.columns != 0 || s.min_range_m > 0 || limits_range(s.max_range);
  if (s.coverage == Coverage::every_return && limited) {
    return invalid("a file with every return has no columns or limits of range to choose");
  }
  if (!keeps_every_return(s) &&
      (s.target == CompactTarget::max_error || s.target == CompactTarget::lossless)) {
    return invalid(
        "a bound, and coordinates bit for bit, are for files with every return: leave columns and "
        "limits of range out (--cols, --min-range, --max-range)");
  }
  if (s.target == CompactTarget::lossless) return {};
  const bool metres = s.target != CompactTarget::bits_per_point;
  if (!(s.target_value > 0) || s.target_value > (metres ? 100 : 1000)) {
    return invalid(metres ? "the wanted error or step must be above 0 and at most 100 m"
                          : "the wanted bits per point must be above 0 and at most 1000");
  }
  return {};
}

std::vector<std::string> paper_preset_names() {
  std::vector<std::string> names;
  for (const NamedPreset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

std::string suggest_preset(const Cloud& cloud) {
  std::size_t returns = 0, near = 0;
  for (const Vec3& p : cloud.positions) {
    if (!is_return(p)) continue;
    ++returns;
    near += norm(p) < PaperSettings{}.min_range_m ? 1 : 0;
  }
  return 2 * near > returns ? "indoor" : "outdoor";
}

Result<PaperSettings> paper_preset(std::string_view name) {
  for (const NamedPreset& preset : kPresets) {
    if (preset.name == name) return preset.make();
  }
  return Error{ErrorCode::invalid_argument,
               "unknown preset '" + std::string(name) +
                   "'; known: outdoor, indoor, newer-college, superrso"};
}

PaperSettings for_profile(PaperSettings settings, Profile profile) {
  if (profile == Profile::paper_1to1) {
    settings.upsample_rows = settings.upsample_columns = 1;
    settings.overlap = 0;
    settings.accept_m = 0.01;
    settings.reject_m = 0.05;
    settings.stop_on_total_error = false;
  }
  return settings;
}

}  // namespace curlidar
