// SPDX-License-Identifier: BSD-3-Clause
#include "io/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace curlidar::io {
namespace {

template <class T, bool BigEndian>
T load(const std::byte* bytes) {
  if constexpr (BigEndian) {
    return load_big_endian<T>(bytes);
  } else {
    return load_little_endian<T>(bytes);
  }
}

template <bool BigEndian, class T>
void gather_values(const Block& block, const FieldView& field, std::vector<T>& values) {
  if (values.empty()) return;  // nothing, which may lie nowhere
  T* out = values.data();
  for (std::size_t row = 0; row < block.height; ++row) {
    const std::byte* point = block.bytes.data() + field.offset + row * field.row_stride;
    for (std::size_t column = 0; column < block.width; ++column, point += field.column_stride) {
      for (std::size_t k = 0; k < field.components; ++k) {
        *out++ = load<T, BigEndian>(point + k * sizeof(T));
      }
    }
  }
}

template <class T>
void store(T value, std::byte* out, bool big_endian) {
  const auto bits = std::bit_cast<UnsignedOfSize<sizeof(T)>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    const std::size_t shift = 8 * (big_endian ? sizeof(T) - 1 - i : i);
    out[i] = static_cast<std::byte>((static_cast<std::uint64_t>(bits) >> shift) & 0xff);
  }
}

/// Whether float32 holds every value of the type.
bool fits_float32(ScalarType type) {
  switch (type) {
    case ScalarType::int8:
    case ScalarType::uint8:
    case ScalarType::int16:
    case ScalarType::uint16:
    case ScalarType::float32:
      return true;
    default:
      return false;
  }
}

std::string first_duplicate(std::vector<std::string_view> names) {
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  return twice == names.end() ? std::string() : std::string(*twice);
}

std::vector<std::string_view> names_of(const std::vector<Attribute>& fields) {
  std::vector<std::string_view> names;
  for (const Attribute& field : fields) names.push_back(field.name);
  return names;
}

constexpr std::array<std::string_view, 3> kAxisNames{"x", "y", "z"};
constexpr std::array<double Vec3::*, 3> kAxes{&Vec3::x, &Vec3::y, &Vec3::z};

bool is_axis(std::string_view name) {
  return std::find(kAxisNames.begin(), kAxisNames.end(), name) != kAxisNames.end();
}

const Attribute* find_field(const std::vector<Attribute>& fields, std::string_view name) {
  const auto at = std::find_if(fields.begin(), fields.end(),
                               [&](const Attribute& field) { return field.name == name; });
  return at == fields.end() ? nullptr : &*at;
}

}  // namespace

Attribute gather(const Block& block, const FieldView& field) {
  const std::size_t points = std::size_t{block.width} * block.height;
  Attribute out{field.name, field.components, make_column(field.type, points * field.components)};
  std::visit(
      [&](auto& values) {
        if (block.big_endian) {
          gather_values<true>(block, field, values);
        } else {
          gather_values<false>(block, field, values);
        }
      },
      out.values);
  return out;
}

Result<Cloud> assemble_cloud(const Source& source, std::vector<Attribute> fields,
                             std::uint32_t width, std::uint32_t height) {
  const std::string twice = first_duplicate(names_of(fields));
  if (!twice.empty()) {
    return Error{ErrorCode::corrupt,
                 fmt::format("{}: two fields are named {}", source.name, quoted(twice))};
  }
  const std::size_t points = std::size_t{width} * height;
  for (const std::string_view name : kAxisNames) {
    const Attribute* field = find_field(fields, name);
    if (field == nullptr || field->components != 1) {
      return Error{ErrorCode::corrupt,
                   fmt::format("{}: {} field '{}'; a cloud needs x, y and z, one number each",
                               source.name, field == nullptr ? "no" : "several numbers in", name)};
    }
  }
  Cloud cloud;
  cloud.positions.resize(points);
  cloud.width = points == 0 ? 0 : width;
  cloud.height = points == 0 ? 1 : height;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Column& column = find_field(fields, kAxisNames[axis])->values;
    if (!fits_float32(type_of(column))) cloud.position_type = ScalarType::float64;
    std::visit(
        [&](const auto& values) {
          for (std::size_t i = 0; i < points; ++i) {
            cloud.positions[i].*kAxes[axis] = static_cast<double>(values[i]);
          }
        },
        column);
  }
  for (Attribute& field : fields) {
    if (!is_axis(field.name)) cloud.attributes.push_back(std::move(field));
  }
  return cloud;
}

std::vector<std::string> default_column_names(std::size_t columns) {
  std::vector<std::string> names{"x", "y", "z"};
  if (columns == 4 || columns == 5) names.push_back("intensity");
  if (columns == 5) names.push_back("ring");
  for (std::size_t i = names.size(); i < columns; ++i) names.push_back(fmt::format("column{}", i));
  return names;
}

ScalarType written_position_type(const Cloud& cloud) {
  return fits_float32(cloud.position_type) ? ScalarType::float32 : ScalarType::float64;
}

std::array<Column, 3> coordinate_columns(const Cloud& cloud, ScalarType type) {
  std::array<Column, 3> axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes[axis] = make_column(type, cloud.size());
    std::visit(
        [&](auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<Value>(cloud.positions[i].*kAxes[axis]);
          }
        },
        axes[axis]);
  }
  return axes;
}

std::vector<OutColumn> out_columns(const Cloud& cloud, const std::array<Column, 3>& axes) {
  std::vector<OutColumn> columns;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns.push_back({std::string(kAxisNames[axis]), 1, &axes[axis]});
  }
  for (const Attribute& attribute : cloud.attributes) {
    columns.push_back({attribute.name, attribute.components, &attribute.values});
  }
  return columns;
}

std::vector<OutColumn> split_components(const std::vector<OutColumn>& columns, std::size_t points,
                                        std::vector<Column>& storage) {
  std::size_t parts = 0;
  for (const OutColumn& column : columns) parts += column.components;
  storage.reserve(parts);  // so that pointers into it stay valid
  std::vector<OutColumn> out;
  for (const OutColumn& column : columns) {
    if (column.components == 1) {
      out.push_back(column);
      continue;
    }
    for (std::uint32_t k = 0; k < column.components; ++k) {
      Column& part = storage.emplace_back(make_column(column.type(), points));
      std::visit(
          [&](auto& to) {
            const auto& from = *std::get_if<std::decay_t<decltype(to)>>(column.values);
            for (std::size_t i = 0; i < points; ++i) to[i] = from[i * column.components + k];
          },
          part);
      out.push_back({fmt::format("{}_{}", column.name, k), 1, &part});
    }
  }
  return out;
}

void scatter(const OutColumn& column, std::byte* first, std::size_t stride, bool big_endian) {
  std::visit(
      [&](const auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        const std::size_t points = values.size() / column.components;
        for (std::size_t i = 0; i < points; ++i) {
          for (std::size_t k = 0; k < column.components; ++k) {
            store(values[i * column.components + k], first + i * stride + k * sizeof(Value),
                  big_endian);
          }
        }
      },
      *column.values);
}

void append_records(const std::vector<OutColumn>& columns, std::size_t points, bool big_endian,
                    Bytes& out) {
  std::size_t record = 0;
  for (const OutColumn& column : columns) record += column.bytes_per_point();
  std::size_t offset = out.size();
  out.resize(out.size() + record * points);
  if (points == 0) return;
  for (const OutColumn& column : columns) {
    scatter(column, out.data() + offset, record, big_endian);
    offset += column.bytes_per_point();
  }
}

Status check_writable(const Cloud& cloud) {
  const auto invalid = [](std::string message) {
    return Error{ErrorCode::invalid_argument, std::move(message)};
  };
  if (cloud.organised() && std::size_t{cloud.width} * cloud.height != cloud.size()) {
    return invalid(fmt::format("an organised cloud of {} x {} must not have {} points", cloud.width,
                               cloud.height, cloud.size()));
  }
  for (const Attribute& attribute : cloud.attributes) {
    if (attribute.components == 0 ||
        size_of(attribute.values) != cloud.size() * attribute.components) {
      return invalid(fmt::format("attribute {} has {} values, {} points of {} components need {}",
                                 quoted(attribute.name), size_of(attribute.values), cloud.size(),
                                 attribute.components, cloud.size() * attribute.components));
    }
    if (attribute.name.empty() || is_axis(attribute.name)) {
      return invalid(fmt::format("an attribute must not be named {}", quoted(attribute.name)));
    }
  }
  const std::string twice = first_duplicate(names_of(cloud.attributes));
  if (!twice.empty()) return invalid(fmt::format("two attributes are named {}", quoted(twice)));
  return {};
}

Status check_names_are_words(const std::vector<OutColumn>& columns, const char* format) {
  std::vector<std::string_view> names;
  for (const OutColumn& column : columns) {
    names.push_back(column.name);
    const bool word = std::all_of(column.name.begin(), column.name.end(), [](char c) {
      return static_cast<unsigned char>(c) > 0x20 && c != 0x7f;
    });
    if (!word) {
      return Error{ErrorCode::unsupported,
                   fmt::format("{} cannot hold an attribute named {}: rename it without blanks",
                               format, quoted(column.name))};
    }
  }
  const std::string twice = first_duplicate(std::move(names));
  if (twice.empty()) return {};
  return Error{ErrorCode::unsupported,
               fmt::format("{} cannot hold two columns named {}", format, quoted(twice))};
}

}  // namespace curlidar::io
