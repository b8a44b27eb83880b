// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kMaxProfileBytes = std::size_t{4} << 20;

bool has_extension(const std::string& path, std::string_view extension) {
  if (path.size() <= extension.size()) return false;
  const std::string_view end = std::string_view(path).substr(path.size() - extension.size());
  return std::equal(end.begin(), end.end(), extension.begin(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

}  // namespace

Result<SensorProfile> load_sensor(const std::string& name_or_path) {
  const bool is_toml = has_extension(name_or_path, ".toml");
  if (!is_toml && !has_extension(name_or_path, ".json")) {
    if (name_or_path.find('/') == std::string::npos) return builtin_sensor(name_or_path);
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: a sensor file must end in .toml or .json", name_or_path)};
  }
  CURLIDAR_TRY_ASSIGN(bytes, read_file(name_or_path));
  if (bytes.size() > kMaxProfileBytes) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("{}: {} bytes are too many for a sensor description", name_or_path,
                             bytes.size())};
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return is_toml ? parse_sensor_toml(text, name_or_path)
                 : parse_ouster_metadata(text, name_or_path);
}

}  // namespace curlidar
