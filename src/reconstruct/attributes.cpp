// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/attributes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "base/parallel.hpp"

namespace curlidar {
namespace {

/// Coded returns and their weights, which add up to 1 or, where nothing is known, are all 0.
struct Blend {
  std::array<std::uint32_t, 4> number{};
  std::array<double, 4> weight{};

  std::size_t heaviest() const {
    return static_cast<std::size_t>(std::max_element(weight.begin(), weight.end()) -
                                    weight.begin());
  }
};

Blend blend_at(const Field& field, const std::vector<std::uint32_t>& numbers, const Vec3& point) {
  Blend blend;
  if (std::isnan(point.x)) return blend;
  const Sources sources = field.sources_at(point);
  double sum = 0;
  for (std::size_t k = 0; k < blend.weight.size(); ++k) {
    if (sources.weight[k] <= 0 || numbers[sources.cell[k]] == kNoReturn) continue;
    blend.number[k] = numbers[sources.cell[k]];
    blend.weight[k] = sources.weight[k];
    sum += sources.weight[k];
  }
  for (double& weight : blend.weight) weight = sum > 0 ? weight / sum : 0;
  return blend;
}

template <class T>
T to_value(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    constexpr auto low = static_cast<double>(std::numeric_limits<T>::min());
    constexpr auto high = static_cast<double>(std::numeric_limits<T>::max());
    return static_cast<T>(std::clamp(std::round(value), low, high));
  }
}

/// Component `c` of `components`, between the blended returns; those that are no number are left
/// out.
template <class T>
T mixed(const std::vector<T>& values, std::size_t components, std::size_t c, const Blend& blend) {
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < blend.weight.size(); ++k) {
    if (blend.weight[k] == 0) continue;
    const auto value = static_cast<double>(values[blend.number[k] * components + c]);
    if (!std::isfinite(value)) continue;
    sum += blend.weight[k] * value;
    weight += blend.weight[k];
  }
  return weight > 0 ? to_value<T>(sum / weight)
                    : values[blend.number[blend.heaviest()] * components + c];
}

/// Fills the values of the points from `begin` on.
template <class T>
void fill(const std::vector<T>& from, std::size_t components, bool interpolated,
          std::span<const Blend> blends, std::size_t begin, std::vector<T>& to) {
  for (std::size_t i = 0; i < blends.size(); ++i) {
    const Blend& blend = blends[i];
    const std::size_t heaviest = blend.heaviest();
    if (blend.weight[heaviest] == 0) continue;
    for (std::size_t c = 0; c < components; ++c) {
      to[(begin + i) * components + c] = interpolated && blend.weight[heaviest] < 1
                                             ? mixed(from, components, c, blend)
                                             : from[blend.number[heaviest] * components + c];
    }
  }
}

bool contains_any(std::string_view name, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return name.find(word) != std::string_view::npos;
  });
}

bool is_any(std::string_view name, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), name) != words.end();
}

}  // namespace

std::vector<std::uint32_t> number_returns(const Field& field) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(field.lattice().cells());
  std::uint32_t next = 0;
  for (std::uint32_t row = 0; row < field.lattice().rows(); ++row) {
    for (std::uint32_t column = 0; column < field.lattice().columns(); ++column) {
      numbers.push_back(field.occupied(row, column) ? next++ : kNoReturn);
    }
  }
  return numbers;
}

Attribute gather(const Attribute& from, const std::vector<std::uint32_t>& returns) {
  const std::size_t k = from.components;
  Attribute to{from.name, from.components, make_column(type_of(from.values), returns.size() * k)};
  std::visit(
      [&](auto& values) {
        const auto& source = std::get<std::decay_t<decltype(values)>>(from.values);
        for (std::size_t i = 0; i < returns.size(); ++i) {
          if (returns[i] == kNoReturn) continue;
          std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(returns[i] * k), k,
                      values.begin() + static_cast<std::ptrdiff_t>(i * k));
        }
      },
      to.values);
  return to;
}

bool is_interpolated(const Attribute& attribute) {
  const ScalarType type = type_of(attribute.values);
  if (type == ScalarType::int64 || type == ScalarType::uint64) return false;
  std::string name = attribute.name;
  std::transform(name.begin(), name.end(), name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return !contains_any(name, {"ring", "time", "stamp", "return", "label", "class", "laser",
                              "channel", "semantic", "instance", "index", "flag", "tag", "number",
                              "count", "rgb", "normal"}) &&
         !is_any(name, {"t", "id", "line", "row", "column", "col", "echo", "valid"});
}

std::vector<Attribute> attributes_at(const DecodedScan& scan, const Field& field,
                                     std::span<const Vec3> points, std::size_t threads) {
  constexpr std::size_t kChunk = 4096;
  std::vector<Attribute> attributes;
  for (const Attribute& from : scan.attributes) {
    attributes.push_back({from.name, from.components,
                          make_column(type_of(from.values), points.size() * from.components)});
  }
  if (attributes.empty()) return attributes;
  const std::vector<std::uint32_t> numbers = number_returns(field);
  parallel_for((points.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    const std::size_t begin = chunk * kChunk, end = std::min(points.size(), begin + kChunk);
    std::vector<Blend> blends;
    for (std::size_t i = begin; i < end; ++i) blends.push_back(blend_at(field, numbers, points[i]));
    for (std::size_t a = 0; a < attributes.size(); ++a) {
      std::visit(
          [&](auto& values) {
            const auto& from = std::get<std::decay_t<decltype(values)>>(scan.attributes[a].values);
            fill(from, attributes[a].components, is_interpolated(attributes[a]), blends, begin,
                 values);
          },
          attributes[a].values);
    }
  });
  return attributes;
}

}  // namespace curlidar
