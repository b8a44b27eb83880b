// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/cloud.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace curlidar {
namespace {

template <std::size_t... Index>
Column make_column_of(std::size_t type, std::size_t size, std::index_sequence<Index...>) {
  Column column;
  ((type == Index ? void(column.emplace<Index>(size)) : void()), ...);
  return column;
}

}  // namespace

std::size_t size_of(ScalarType type) {
  constexpr std::array<std::size_t, 10> kSizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

const char* to_string(ScalarType type) {
  constexpr std::array<const char*, 10> kNames{"int8",   "uint8", "int16",  "uint16",  "int32",
                                               "uint32", "int64", "uint64", "float32", "float64"};
  return kNames[static_cast<std::size_t>(type)];
}

ScalarType type_of(const Column& column) { return static_cast<ScalarType>(column.index()); }

std::size_t size_of(const Column& column) {
  return std::visit([](const auto& values) { return values.size(); }, column);
}

Column make_column(ScalarType type, std::size_t size) {
  return make_column_of(static_cast<std::size_t>(type), size,
                        std::make_index_sequence<std::variant_size_v<Column>>{});
}

double Attribute::as_double(std::size_t i) const {
  return std::visit(
      [&](const auto& v) { return static_cast<double>(v[i * components]); }, values);
}

const Attribute* Cloud::find(std::string_view name) const {
  for (const Attribute& attribute : attributes) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

std::size_t count_returns(const Cloud& cloud) {
  return static_cast<std::size_t>(
      std::count_if(cloud.positions.begin(), cloud.positions.end(), is_return));
}

Cloud select(const Cloud& cloud, const std::vector<std::uint32_t>& indices) {
  Cloud out;
  out.position_type = cloud.position_type;
  out.metadata = cloud.metadata;
  out.width = static_cast<std::uint32_t>(indices.size());
  out.positions.reserve(indices.size());
  for (const std::uint32_t i : indices) out.positions.push_back(cloud.positions[i]);
  for (const Attribute& attribute : cloud.attributes) {
    const std::size_t k = attribute.components;
    Attribute chosen{attribute.name, attribute.components,
                     make_column(type_of(attribute.values), indices.size() * k)};
    std::visit(
        [&](auto& to) {
          const auto& from = std::get<std::decay_t<decltype(to)>>(attribute.values);
          for (std::size_t j = 0; j < indices.size(); ++j) {
            std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(indices[j] * k), k,
                        to.begin() + static_cast<std::ptrdiff_t>(j * k));
          }
        },
        chosen.values);
    out.attributes.push_back(std::move(chosen));
  }
  return out;
}

double percentile(std::vector<double>& values, double fraction) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), nth, values.end());
  const double low = *nth;
  if (below + 1 >= values.size()) return low;
  const double high = *std::min_element(nth + 1, values.end());
  return low + (high - low) * (position - static_cast<double>(below));
}

}  // namespace curlidar
