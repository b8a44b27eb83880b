// SPDX-License-Identifier: BSD-3-Clause
#include "io/float_records.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/try.hpp"
#include "io/columns.hpp"

namespace curlidar::io {
namespace {

/// Names of attributes that the format has no field for, and of those with several components.
std::vector<std::string> unheld_attributes(const Cloud& cloud,
                                           const std::vector<std::string>& fields) {
  std::vector<std::string> names;
  for (const Attribute& attribute : cloud.attributes) {
    const bool known = std::find(fields.begin(), fields.end(), attribute.name) != fields.end();
    if (!known || attribute.components != 1) names.push_back(attribute.name);
  }
  return names;
}

Column as_float32(const Attribute* attribute, std::size_t points) {
  std::vector<float> out(points, 0.0f);
  if (attribute != nullptr) {
    std::visit(
        [&](const auto& values) {
          std::transform(values.begin(), values.end(), out.begin(),
                         [](auto value) { return static_cast<float>(value); });
        },
        attribute->values);
  }
  return out;
}

}  // namespace

Result<Cloud> parse_float_records(const Source& source, const char* format,
                                  const std::vector<std::string>& fields) {
  const std::size_t record = fields.size() * sizeof(float);
  const std::size_t points = source.bytes.size() / record;
  if (source.bytes.size() % record != 0) {
    return error_at_byte(
        source, points * record,
        fmt::format("{} bytes are left after the last whole record; {} files have {} bytes a "
                    "point: the file is truncated or has another format",
                    source.bytes.size() % record, format, record));
  }
  CURLIDAR_TRY(check_point_count(source, points));
  const Block block{source.bytes, static_cast<std::uint32_t>(points), 1, false};
  std::vector<Attribute> columns;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    columns.push_back(
        gather(block, {fields[i], ScalarType::float32, 1, i * sizeof(float), 0, record}));
  }
  return assemble_cloud(source, std::move(columns), block.width, 1);
}

Result<Bytes> format_float_records(const Cloud& cloud, const char* format,
                                   const std::vector<std::string>& fields) {
  const std::vector<std::string> unheld = unheld_attributes(cloud, fields);
  if (!unheld.empty()) {
    return Error{ErrorCode::unsupported,
                 fmt::format("{} files cannot hold the attribute{} {}; they have only {}. Choose "
                             "the attributes to keep, or write PCD or PLY",
                             format, unheld.size() > 1 ? "s" : "", fmt::join(unheld, ", "),
                             fmt::join(fields, ", "))};
  }
  const std::array<Column, 3> axes = coordinate_columns(cloud, ScalarType::float32);
  std::vector<Column> storage;
  storage.reserve(fields.size());
  std::vector<OutColumn> columns;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i >= 3) storage.push_back(as_float32(cloud.find(fields[i]), cloud.size()));
    columns.push_back({fields[i], 1, i < 3 ? &axes[i] : &storage.back()});
  }
  Bytes out;
  append_records(columns, cloud.size(), false, out);
  return out;
}

}  // namespace curlidar::io
