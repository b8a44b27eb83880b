// SPDX-License-Identifier: BSD-3-Clause
// Sensor profiles as TOML text; docs/sensors.md describes the format.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "base/try.hpp"
#include "curlidar/sensor.hpp"
#include "sensor/angles.hpp"
#include "sensor/tomlpp.hpp"
#include "sensor/utf8.hpp"

namespace curlidar {
namespace {

/// A quantity of Ring, and its keys in the [rings] table.
struct RingField {
  double Ring::*member;
  const char *key, *radian_key;  ///< radian_key is null for lengths
};

constexpr std::array<RingField, 5> kRingFields{
    {{&Ring::elevation, "elevation_deg", "elevation_rad"},
     {&Ring::azimuth_offset, "azimuth_offset_deg", "azimuth_offset_rad"},
     {&Ring::vertical_offset_m, "vertical_offset_m", nullptr},
     {&Ring::horizontal_offset_m, "horizontal_offset_m", nullptr},
     {&Ring::range_phase_m, "range_phase_m", nullptr}}};

Error error_at(const std::string& where, const toml::source_region& source, std::string_view what,
               ErrorCode code = ErrorCode::invalid_argument) {
  return {code, fmt::format("{}, line {}: {}", where, source.begin.line, what)};
}

/// Reads the keys of one table; the first failure is kept and later reads do nothing.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string where)
      : table_(table), where_(std::move(where)) {}

  std::optional<double> number(const char* key) {
    const toml::node* node = take(key);
    if (node == nullptr) return std::nullopt;
    const auto value = node->value<double>();
    if (!node->is_number() || !value) fail(*node, fmt::format("{} must be a number", key));
    return status_ ? value : std::nullopt;
  }
  std::optional<std::uint32_t> count(const char* key, std::uint32_t limit) {
    const toml::node* node = take(key);
    if (node == nullptr) return std::nullopt;
    const auto value = node->value<std::int64_t>();
    if (!node->is_integer() || !value || *value < 1 || *value > limit) {
      fail(*node, fmt::format("{} must be a whole number from 1 to {}", key, limit));
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(*value);
  }
  std::optional<std::string> text(const char* key) {
    const toml::node* node = take(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_string()) fail(*node, fmt::format("{} must be a string", key));
    return status_ ? node->value<std::string>() : std::nullopt;
  }
  /// One number for each ring.
  std::optional<std::vector<double>> numbers(const char* key) {
    const toml::node* node = take(key);
    if (node == nullptr) return std::nullopt;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->empty() || array->size() > kMaxRings) {
      fail(*node, fmt::format("{} must be a list of 1 to {} numbers", key, kMaxRings));
      return std::nullopt;
    }
    std::vector<double> out;
    for (const toml::node& element : *array) {
      const auto value = element.value<double>();
      if (!element.is_number() || !value) {
        fail(element, fmt::format("{} must hold numbers only", key));
        return std::nullopt;
      }
      out.push_back(*value);
    }
    return out;
  }
  /// An angle in radians, from `degree_key` or `radian_key`.
  std::optional<double> angle(const char* degree_key, const char* radian_key) {
    const std::optional<double> degrees = number(degree_key), radians = number(radian_key);
    if (degrees && radians) fail_twice(degree_key, radian_key);
    return degrees ? radians_of(*degrees) : radians;
  }
  void fail_twice(const char* first, const char* second) {
    fail(*table_.get(second), fmt::format("give {} or {}, not both", first, second));
  }
  void fail(const toml::node& node, std::string_view what) {
    if (status_) status_ = error_at(where_, node.source(), what);
  }
  /// Counts a key as known, without reading it.
  const toml::node* take(const char* key) {
    known_.emplace_back(key);
    return status_ ? table_.get(key) : nullptr;
  }
  /// The first failure; or that of a key nobody has asked for.
  Status finish() {
    for (const auto& [key, node] : table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end() && status_) {
        status_ = error_at(where_, key.source(),
                           fmt::format("unknown key \"{}\"; docs/sensors.md lists the keys",
                                       key.str().substr(0, 64)));
      }
    }
    return status_;
  }

 private:
  const toml::table& table_;
  std::string where_;
  std::vector<std::string> known_;
  Status status_;
};

std::vector<Ring> uniform_rings(std::uint32_t count, double up, double down) {
  std::vector<Ring> rings(count);
  const double step = count > 1 ? (up - down) / (count - 1) : 0;
  for (std::uint32_t i = 0; i < count; ++i) rings[i].elevation = up - step * i;
  if (count > 1) rings.back().elevation = down;
  return rings;
}

void read_ring_field(TableReader& reader, const RingField& field, const toml::table& table,
                     std::vector<Ring>& rings) {
  auto values = reader.numbers(field.key);
  if (field.radian_key != nullptr) {
    auto radians = reader.numbers(field.radian_key);
    if (values && radians) return reader.fail_twice(field.key, field.radian_key);
    if (values) std::transform(values->begin(), values->end(), values->begin(), radians_of);
    if (radians) values = std::move(radians);
  }
  if (!values) return;
  if (rings.empty()) rings.resize(values->size());
  if (values->size() != rings.size()) {
    const toml::node* node = table.get(field.key);
    if (node == nullptr) node = table.get(field.radian_key);
    return reader.fail(*node, fmt::format("{} has {} numbers, but there are {} rings", field.key,
                                          values->size(), rings.size()));
  }
  for (std::size_t i = 0; i < rings.size(); ++i) rings[i].*field.member = (*values)[i];
}

Result<std::vector<Ring>> read_rings(const toml::table& table, const SensorProfile& profile,
                                     const std::string& where) {
  TableReader reader(table, where);
  std::vector<Ring> rings;
  const auto uniform = reader.count("uniform", kMaxRings);
  const bool listed = table.contains("elevation_deg") || table.contains("elevation_rad");
  if (uniform && listed) {
    reader.fail(*table.get("uniform"), "give uniform or a list of elevations, not both");
  }
  if (uniform) rings = uniform_rings(*uniform, profile.fov_up, profile.fov_down);
  for (const RingField& field : kRingFields) read_ring_field(reader, field, table, rings);
  CURLIDAR_TRY(reader.finish());
  if (!uniform && !listed) {
    return error_at(where, table.source(),
                    "[rings] needs elevation_deg = [...], or uniform = the number of rings");
  }
  return rings;
}

Result<ScanPattern> read_pattern(TableReader& reader, const toml::table& root) {
  const std::string pattern = reader.text("pattern").value_or("spinning");
  if (pattern != "spinning" && pattern != "limited_field") {
    reader.fail(*root.get("pattern"), "pattern must be \"spinning\" or \"limited_field\"");
  }
  return pattern == "limited_field" ? ScanPattern::limited_field : ScanPattern::spinning;
}

Result<SensorProfile> read_profile(const toml::table& root, const std::string& where) {
  TableReader reader(root, where);
  SensorProfile profile;
  profile.name = reader.text("name").value_or("custom");
  profile.description = reader.text("description").value_or("");
  CURLIDAR_TRY_ASSIGN(pattern, read_pattern(reader, root));
  profile.pattern = pattern;
  profile.columns = reader.count("columns", 65536).value_or(profile.columns);
  const auto fov_up = reader.angle("fov_up_deg", "fov_up_rad");
  const auto fov_down = reader.angle("fov_down_deg", "fov_down_rad");
  profile.min_range_m = reader.number("min_range_m").value_or(profile.min_range_m);
  profile.max_range_m = reader.number("max_range_m").value_or(profile.max_range_m);
  profile.beam_origin_radius_m = reader.number("beam_origin_radius_m").value_or(0);
  profile.slots = reader.count("slots", kMaxSlots).value_or(0);
  profile.range_unit_m = reader.number("range_unit_m").value_or(0);
  const toml::node* rings = reader.take("rings");
  CURLIDAR_TRY(reader.finish());
  if (rings == nullptr || !rings->is_table()) {
    const auto source = rings != nullptr ? rings->source() : root.source();
    return error_at(where, source, "a table [rings] with elevation_deg = [...] is missing");
  }
  const bool uniform = rings->as_table()->contains("uniform");
  if (uniform && !(fov_up && fov_down)) {
    return error_at(where, rings->source(), "uniform rings need fov_up_deg and fov_down_deg");
  }
  profile.fov_up = fov_up.value_or(0);
  profile.fov_down = fov_down.value_or(0);
  CURLIDAR_TRY_ASSIGN(ring_list, read_rings(*rings->as_table(), profile, where));
  profile.rings = std::move(ring_list);
  if (!fov_up) profile.fov_up = profile.rings.front().elevation;
  if (!fov_down) profile.fov_down = profile.rings.back().elevation;
  if (Status status = validate(profile); !status) {
    return error_at(where, rings->source(), status.error().message);
  }
  return profile;
}

/// The shortest decimal number of degrees that radians_of() turns into exactly `radians`.
std::optional<std::string> exact_degrees(double radians) {
  const double degrees = degrees_of(radians);
  for (int digits = 1; digits <= 17; ++digits) {
    const std::string text = fmt::format("{:.{}g}", degrees, digits);
    double parsed = 0;
    std::from_chars(text.data(), text.data() + text.size(), parsed);
    if (radians_of(parsed) == radians) return text;
  }
  // Division and multiplication round; one of the neighbours may still hit.
  for (const double neighbour : {std::nextafter(degrees, 1e3), std::nextafter(degrees, -1e3)}) {
    if (radians_of(neighbour) == radians) return fmt::format("{}", neighbour);
  }
  return std::nullopt;
}

void append_angle(std::string& out, const char* key, double radians) {
  const auto degrees = exact_degrees(radians);
  out += fmt::format("{}_{} = {}\n", key, degrees ? "deg" : "rad",
                     degrees ? *degrees : fmt::format("{}", radians));
}

void append_ring_field(std::string& out, const RingField& field, const std::vector<Ring>& rings) {
  std::vector<std::string> texts;
  bool exact = field.radian_key != nullptr;
  for (const Ring& ring : rings) {
    const auto degrees = exact ? exact_degrees(ring.*field.member) : std::nullopt;
    if (!degrees) break;
    texts.push_back(*degrees);
  }
  exact = texts.size() == rings.size();
  if (!exact) {
    texts.clear();
    for (const Ring& ring : rings) texts.push_back(fmt::format("{}", ring.*field.member));
  }
  out += fmt::format("{} = [", exact || !field.radian_key ? field.key : field.radian_key);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    out += fmt::format("{}{},", i % 8 == 0 ? "\n  " : " ", texts[i]);
  }
  out += "\n]\n";
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == 0x7f) {
      out += fmt::format("\\u{:04X}", code);
    } else {
      out += c;
    }
  }
  return out + "\"";
}

}  // namespace

std::string sensor_to_toml(const SensorProfile& profile) {
  std::string out;
  out += fmt::format("name = {}\n", quoted(profile.name));
  out += fmt::format("description = {}\n", quoted(profile.description));
  out += fmt::format("pattern = \"{}\"\n",
                     profile.pattern == ScanPattern::spinning ? "spinning" : "limited_field");
  out += fmt::format("columns = {}\n", profile.columns);
  append_angle(out, "fov_up", profile.fov_up);
  append_angle(out, "fov_down", profile.fov_down);
  out +=
      fmt::format("min_range_m = {}\nmax_range_m = {}\n", profile.min_range_m, profile.max_range_m);
  if (profile.beam_origin_radius_m != 0) {
    out += fmt::format("beam_origin_radius_m = {}\n", profile.beam_origin_radius_m);
  }
  if (profile.slots != 0) out += fmt::format("slots = {}\n", profile.slots);
  if (profile.range_unit_m != 0) out += fmt::format("range_unit_m = {}\n", profile.range_unit_m);
  out += "\n[rings]\n";
  for (const RingField& field : kRingFields) {
    const bool needed = field.member == &Ring::elevation ||
                        std::any_of(profile.rings.begin(), profile.rings.end(),
                                    [&](const Ring& ring) { return ring.*field.member != 0; });
    if (needed) append_ring_field(out, field, profile.rings);
  }
  return out;
}

Result<SensorProfile> parse_sensor_toml(std::string_view text, const std::string& where) {
  // toml++ 3.3 runs into undefined behaviour on some characters beyond ASCII outside strings.
  // Escaped they mean the same inside double quotes, and are mistakes it can tell elsewhere.
  const std::optional<std::string> ascii = escape_non_ascii(text);
  if (!ascii) return Error{ErrorCode::corrupt, where + ": not UTF-8 text"};
  const toml::parse_result parsed = toml::parse(*ascii, where);
  if (!parsed) {
    return error_at(where, parsed.error().source(),
                    fmt::format("not TOML: {}", parsed.error().description()), ErrorCode::corrupt);
  }
  return read_profile(parsed.table(), where);
}

}  // namespace curlidar
