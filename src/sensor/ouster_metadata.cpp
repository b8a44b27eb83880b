// SPDX-License-Identifier: BSD-3-Clause
// Ouster sensors describe themselves in JSON: flat up to firmware 2.x, in sections since.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/try.hpp"
#include "curlidar/sensor.hpp"
#include "sensor/angles.hpp"
#include "sensor/cones.hpp"

namespace curlidar {
namespace {

using nlohmann::json;

Error invalid(const std::string& where, std::string_view what) {
  return {ErrorCode::invalid_argument, fmt::format("{}: Ouster metadata: {}", where, what)};
}

/// A key at the top or in any of the sections that one firmware or another uses.
const json* find_key(const json& root, const char* key) {
  for (const char* section : {"", "beam_intrinsics", "config_params", "lidar_data_format",
                              "data_format", "sensor_info", "lidar_intrinsics"}) {
    const json* table = &root;
    if (*section != '\0') {
      const auto found = root.find(section);
      if (found == root.end() || !found->is_object()) continue;
      table = &*found;
    }
    if (const auto found = table->find(key); found != table->end()) return &*found;
  }
  return nullptr;
}

Result<std::vector<double>> read_angles(const json& root, const char* key, double limit_deg,
                                        const std::string& where) {
  const json* list = find_key(root, key);
  if (list == nullptr || !list->is_array()) {
    return invalid(where, fmt::format("no list {}; is this the sensor's metadata?", key));
  }
  if (list->empty() || list->size() > kMaxRings) {
    return invalid(
        where, fmt::format("{} has {} entries, expected 1 to {}", key, list->size(), kMaxRings));
  }
  std::vector<double> out;
  for (const json& value : *list) {
    if (value.is_array()) {
      return Error{ErrorCode::unsupported,
                   fmt::format("{}: {} is a table of pixels: a flash scanner with a limited field, "
                               "which the paper's profiles cannot code",
                               where, key)};
    }
    if (!value.is_number()) return invalid(where, fmt::format("{} must hold numbers", key));
    out.push_back(value.get<double>());
    if (!(std::abs(out.back()) <= limit_deg)) {
      return invalid(where, fmt::format("{} must lie within +-{} degrees", key, limit_deg));
    }
  }
  return out;
}

std::optional<double> read_number(const json& root, const char* key) {
  const json* value = find_key(root, key);
  if (value == nullptr || !value->is_number()) return std::nullopt;
  return value->get<double>();
}

std::string read_text(const json& root, const char* key) {
  const json* value = find_key(root, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

/// "1024x10" is 1024 columns at 10 turns a second.
Result<std::uint32_t> read_columns(const json& root, const std::string& where) {
  const std::string mode = read_text(root, "lidar_mode");
  std::uint32_t columns = 0;
  const auto [end, error] = std::from_chars(mode.data(), mode.data() + mode.size(), columns);
  if (error == std::errc() && end != mode.data() + mode.size() && *end == 'x') return columns;
  const double stated = read_number(root, "columns_per_frame").value_or(0);
  if (stated >= 1 && stated <= 65536) return static_cast<std::uint32_t>(stated);
  return invalid(where, "no usable lidar_mode (such as \"1024x10\") or columns_per_frame");
}

/// Generous limits by product line; nothing the sensor reports lies beyond.
double max_range_of(std::string_view product) {
  if (product.starts_with("OS-2") || product.starts_with("OS2")) return 480;
  if (product.starts_with("OS-1") || product.starts_with("OS1")) return 240;
  return 120;
}

/// Packets with 15 bits for a range count 8 mm, all others 1 mm.
double range_unit_of(std::string_view packet_profile) {
  return packet_profile.find("RNG15") != std::string_view::npos ? 0.008 : 0.001;
}

std::string name_of(std::string_view product) {
  if (product.empty()) return "ouster";
  std::string name;
  for (const char c : product.substr(0, 64)) {
    name.push_back(c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
  }
  return "ouster-" + name;
}

Result<SensorProfile> read_metadata(const json& root, const std::string& where) {
  if (!root.is_object()) return invalid(where, "the file must hold one JSON object");
  CURLIDAR_TRY_ASSIGN(altitudes, read_angles(root, "beam_altitude_angles", 90, where));
  CURLIDAR_TRY_ASSIGN(azimuths, read_angles(root, "beam_azimuth_angles", 360, where));
  CURLIDAR_TRY_ASSIGN(columns, read_columns(root, where));
  if (azimuths.size() != altitudes.size()) {
    return invalid(where, fmt::format("{} altitude angles but {} azimuth angles", altitudes.size(),
                                      azimuths.size()));
  }
  SensorProfile profile;
  const std::string product = read_text(root, "prod_line");
  profile.name = name_of(product);
  profile.description = fmt::format("Ouster {} from its metadata", product);
  profile.columns = columns;
  for (std::size_t i = 0; i < altitudes.size(); ++i) {
    // Ouster counts beam azimuths clockwise.
    profile.rings.push_back({radians_of(altitudes[i]), -radians_of(azimuths[i]), 0, 0});
  }
  std::stable_sort(profile.rings.begin(), profile.rings.end(),
                   [](const Ring& a, const Ring& b) { return a.elevation > b.elevation; });
  std::vector<double> elevations = profile.elevations();
  make_strictly_descending(elevations);
  for (std::size_t i = 0; i < elevations.size(); ++i) profile.rings[i].elevation = elevations[i];
  profile.fov_up = profile.rings.front().elevation;
  profile.fov_down = profile.rings.back().elevation;
  profile.min_range_m = 0;
  profile.max_range_m = max_range_of(product);
  profile.beam_origin_radius_m =
      read_number(root, "lidar_origin_to_beam_origin_mm").value_or(0) / 1000;
  profile.slots = columns;
  profile.range_unit_m = range_unit_of(read_text(root, "udp_profile_lidar"));
  if (Status status = validate(profile); !status) {
    return invalid(where, status.error().message);
  }
  return profile;
}

}  // namespace

Result<SensorProfile> parse_ouster_metadata(std::string_view text, const std::string& where) {
  // The parser reports by exceptions where the mistake is; they end here.
  try {
    return read_metadata(json::parse(text), where);
  } catch (const json::exception& error) {
    return Error{ErrorCode::corrupt, fmt::format("{}: not JSON: {}", where, error.what())};
  }
}

}  // namespace curlidar
