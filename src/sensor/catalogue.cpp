// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "curlidar/sensor.hpp"
#include "sensor/embedded_profiles.hpp"

namespace curlidar {
namespace {

using Alias = std::pair<std::string_view, std::string_view>;

constexpr std::array<Alias, 10> kAliases{{{"hdl32", "hdl32e"},
                                          {"hdl64e", "hdl64e-kitti"},
                                          {"kitti", "hdl64e-kitti"},
                                          {"vlp32", "vlp32c"},
                                          {"pandar40", "pandar40p"},
                                          {"pandar128e4x", "pandar128"},
                                          {"qt64", "pandarqt64"},
                                          {"qt128", "pandarqt128"},
                                          {"xt16", "pandarxt16"},
                                          {"xt32", "pandarxt32"}}};

/// Scanners without rings that turn all the way; people ask for them by these words.
constexpr std::array<std::string_view, 13> kLimitedField{
    "livox", "avia",  "horizon",     "mid40", "mid70",  "mid360", "tele15",
    "hap",   "at128", "pandarat128", "flash", "cepton", "innoviz"};

/// Lower case, without the separators that data sheets put in different places.
std::string squeeze(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '-' || c == '_' || c == ' ' || c == '.') continue;
    out.push_back(c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
  }
  return out;
}

/// Levenshtein distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j] ? 1 : 0);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string nearest_names(const std::string& wanted) {
  std::vector<std::pair<std::size_t, std::string_view>> ranked;
  for (const EmbeddedText& profile : embedded_profiles()) {
    ranked.emplace_back(edit_distance(wanted, squeeze(profile.name)), profile.name);
  }
  std::sort(ranked.begin(), ranked.end());
  std::string out;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, ranked.size()); ++i) {
    out += fmt::format("{}{}", i == 0 ? "" : ", ", ranked[i].second);
  }
  return out;
}

}  // namespace

std::vector<std::string> builtin_sensor_names() {
  std::vector<std::string> out;
  for (const EmbeddedText& profile : embedded_profiles()) out.emplace_back(profile.name);
  std::sort(out.begin(), out.end());
  return out;
}

Result<SensorProfile> builtin_sensor(std::string_view name) {
  // A longer text is no name of ours, and the edit distance would take its time.
  const std::string wanted = squeeze(name.substr(0, 64));
  std::string_view known = wanted;
  for (const auto& [alias, target] : kAliases) {
    if (wanted == alias) known = target;
  }
  for (const EmbeddedText& profile : embedded_profiles()) {
    if (squeeze(profile.name) != squeeze(known)) continue;
    return parse_sensor_toml(profile.text, fmt::format("built-in sensor {}", profile.name));
  }
  for (const std::string_view word : kLimitedField) {
    if (!wanted.starts_with(word)) continue;
    return Error{ErrorCode::unsupported,
                 fmt::format("sensor \"{}\": a limited-field scanner without full turns of rings, "
                             "which the paper's profiles cannot code",
                             name.substr(0, 64))};
  }
  return Error{ErrorCode::not_found,
               fmt::format("no built-in sensor is called \"{}\"; the nearest names are {}",
                           name.substr(0, 64), nearest_names(wanted))};
}

}  // namespace curlidar
