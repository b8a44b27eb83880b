// SPDX-License-Identifier: BSD-3-Clause
#include "records/points.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/try.hpp"

namespace curlidar::records {
namespace {

constexpr std::uint8_t kSomeRaw = 1;  ///< flag of the header
constexpr double kOctavesOfTen = 3.3219;

bool is_coordinate_type(ScalarType type) {
  return type == ScalarType::float32 || type == ScalarType::float64;
}

/// Whether at least 31 of 32 points have numbers.
bool fits(const Numbers& numbers, std::span<const Vec3> points) {
  std::size_t others = 0;
  for (const Vec3& p : points) {
    if (!exact_numbers_of(numbers, p) && ++others > points.size() / 32) return false;
  }
  return true;
}

int precision(ScalarType type) {
  return type == ScalarType::float32 ? 23 : 52;
}

/// Octaves by which integers lie farther apart than the floating-point numbers there, on average.
double octaves_saved(std::span<const Vec3> points, ScalarType type) {
  double sum = 0;
  for (const Vec3& p : points) {
    for (const double x : as_array(p)) {
      if (x != 0) sum += precision(type) - std::ilogb(x);
    }
  }
  return sum / (3 * static_cast<double>(points.size()));
}

Result<Numbers> read_numbers(PayloadReader& reader, NumberKind kind, ScalarType type) {
  if (kind == NumberKind::steps) {
    const auto step = reader.read<double>();
    CURLIDAR_TRY(reader.check("step of the grid"));
    if (!(step > 0 && std::isfinite(step))) return reader.corrupt("the step is not positive");
    return Numbers::of_steps(type, step);
  }
  const auto parameter = reader.read<std::int16_t>();
  CURLIDAR_TRY(reader.check("scale of the numbers"));
  if (kind == NumberKind::decimals) {
    if (parameter < 0 || parameter > static_cast<int>(kMostPlaces)) {
      return reader.corrupt(fmt::format("{} decimal places", parameter));
    }
    return Numbers::of_decimals(type, static_cast<std::uint32_t>(parameter));
  }
  if (std::abs(parameter) > kMostScale) {
    return reader.corrupt(fmt::format("a scale of 2^{}", parameter));
  }
  const bool single = kind == NumberKind::float32;
  return Numbers::of_bits(type, single ? ScalarType::float32 : ScalarType::float64, parameter);
}

}  // namespace

std::optional<Vec3> point_of(const Numbers& numbers, const Triple& triple) {
  Vec3 p;
  if (!numbers.value(triple[0], p.x) || !numbers.value(triple[1], p.y) ||
      !numbers.value(triple[2], p.z)) {
    return std::nullopt;
  }
  return p;
}

std::optional<Triple> exact_numbers_of(const Numbers& numbers, const Vec3& p) {
  const Triple triple = numbers_of(numbers, p);
  const auto point = point_of(numbers, triple);
  if (!point || !same_bits(*point, p)) return std::nullopt;
  return triple;
}

Status check_points(std::span<const Vec3> points, ScalarType type) {
  if (!is_coordinate_type(type)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("coordinates of type {}: only float32 and float64 can be coded",
                             to_string(type))};
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 rounded = points[i];
    const bool finite =
        round_to(type, rounded.x) && round_to(type, rounded.y) && round_to(type, rounded.z);
    if (finite && same_bits(rounded, points[i])) continue;
    return Error{ErrorCode::invalid_argument,
                 fmt::format("point {}, ({}, {}, {}), is not of finite {} coordinates", i,
                             points[i].x, points[i].y, points[i].z, to_string(type))};
  }
  return {};
}

Status check_setting(double value, const char* what) {
  if (value >= 0 && std::isfinite(value)) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("a {} of {}: give a positive number, or 0 for none", what, value)};
}

Numbers exact_numbers(std::span<const Vec3> points, ScalarType type) {
  double most = 0;
  bool single = true;
  for (const Vec3& p : points) {
    for (const double x : as_array(p)) {
      most = std::max(most, std::abs(x));
      double rounded = x;
      single = single && round_to(ScalarType::float32, rounded) && rounded == x;
    }
  }
  const ScalarType bits = single ? ScalarType::float32 : ScalarType::float64;
  const double octaves = points.empty() ? 0 : octaves_saved(points, bits);
  for (std::uint32_t places = 0; places <= kMostPlaces; ++places) {
    if (octaves - kOctavesOfTen * places < 1) break;
    const Numbers decimals = Numbers::of_decimals(type, places);
    const auto some = points.first(std::min<std::size_t>(points.size(), 256));
    if (fits(decimals, some) && fits(decimals, points)) return decimals;
  }
  const int scale = most > 0 ? std::ilogb(most) - precision(bits) : 0;
  return Numbers::of_bits(type, bits, std::max(scale, -kMostScale));
}

void write_header(ByteWriter& writer, const PointsHeader& header) {
  const Numbers& numbers = header.numbers;
  writer.write(static_cast<std::uint8_t>(numbers.kind()));
  writer.write(static_cast<std::uint8_t>(numbers.type()));
  writer.write(header.some_raw ? kSomeRaw : std::uint8_t{0});
  writer.write_varint(header.count);
  if (numbers.kind() == NumberKind::steps) {
    writer.write(numbers.step());
  } else {
    writer.write(static_cast<std::int16_t>(numbers.parameter()));
  }
}

Result<PointsHeader> read_header(PayloadReader& reader, std::uint64_t max_points) {
  const auto kind = reader.read<std::uint8_t>();
  const auto type = static_cast<ScalarType>(reader.read<std::uint8_t>());
  const auto flags = reader.read<std::uint8_t>();
  const std::uint64_t count = reader.read_varint();
  CURLIDAR_TRY(reader.check("header of the points"));
  if (kind > static_cast<std::uint8_t>(NumberKind::float64) || flags > kSomeRaw ||
      !is_coordinate_type(type)) {
    return reader.corrupt("unknown kind of coordinates");
  }
  if (count > max_points) {
    return reader.error(ErrorCode::limit_exceeded,
                        fmt::format("{} points, at most {} are allowed here", count, max_points));
  }
  CURLIDAR_TRY_ASSIGN(numbers, read_numbers(reader, static_cast<NumberKind>(kind), type));
  return PointsHeader{numbers, flags == kSomeRaw, count};
}

}  // namespace curlidar::records
