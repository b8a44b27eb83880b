// SPDX-License-Identifier: BSD-3-Clause
#include "records/coordinates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/float32.hpp"

namespace curlidar::records {
namespace {

constexpr double kMostPosition = 0x1p58;
/// Spacings lie within two to these, so that products and quotients of them are finite.
constexpr int kLeastSpacing = -800, kMostSpacing = 60;

double largest(ScalarType type) {
  return type == ScalarType::float32 ? double{std::numeric_limits<float>::max()}
                                     : std::numeric_limits<double>::max();
}

double bounded(double position) {
  return position > kMostPosition    ? kMostPosition
         : position > -kMostPosition ? position
                                     : -kMostPosition;
}

std::int64_t nearest(double position) {
  return static_cast<std::int64_t>(std::floor(bounded(position) + 0.5));
}

}  // namespace

std::int64_t rank_of(double value, ScalarType type) {
  if (type == ScalarType::float32) {
    const auto bits = std::bit_cast<std::int32_t>(static_cast<float>(value));
    return bits < 0 ? bits ^ INT32_MAX : bits;
  }
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits < 0 ? bits ^ INT64_MAX : bits;
}

double value_of_rank(std::int64_t rank, ScalarType type) {
  if (type == ScalarType::float32) {
    const auto bits = static_cast<std::int32_t>(rank);
    return std::bit_cast<float>(bits < 0 ? bits ^ INT32_MAX : bits);
  }
  return std::bit_cast<double>(rank < 0 ? rank ^ INT64_MAX : rank);
}

bool is_rank(std::int64_t rank, ScalarType type) {
  const std::int64_t most = rank_of(largest(type), type);
  return rank <= most && rank >= -most - 1;
}

bool round_to(ScalarType type, double& value) {
  if (type == ScalarType::float64) return std::isfinite(value);
  // Halfway to what would be the next float32 and beyond, it would round to infinity.
  if (!(std::abs(value) < 0x1.ffffffp127)) return false;
  value = round_to_float32(value);
  return true;
}

Numbers Numbers::of_decimals(ScalarType type, std::uint32_t places) {
  double power = 1;
  for (std::uint32_t i = 0; i < places; ++i) power *= 10;
  return {NumberKind::decimals, type, power, static_cast<int>(places)};
}

Numbers Numbers::of_bits(ScalarType type, ScalarType bits, int scale) {
  const NumberKind kind = bits == ScalarType::float32 ? NumberKind::float32 : NumberKind::float64;
  return {kind, type, std::ldexp(1.0, scale), scale};
}

bool Numbers::value(std::int64_t number, double& value) const {
  if (!is_grid()) {
    if (!is_rank(number, bits())) return false;
    value = value_of_rank(number, bits());
    return round_to(type_, value);
  }
  if (number > kMostSteps || number < -kMostSteps) return false;
  const auto steps = static_cast<double>(number);
  value = kind_ == NumberKind::steps ? steps * step_ : steps / step_;
  return round_to(type_, value);
}

std::int64_t Numbers::number(double value) const {
  if (is_grid()) return nearest(position_of_value(value));
  const double most = largest(bits());
  return rank_of(std::clamp(value, -most, most), bits());
}

double Numbers::position_of_value(double value) const {
  return bounded(kind_ == NumberKind::decimals ? value * step_ : value / step_);
}

double Numbers::position(std::int64_t number) const {
  if (is_grid()) return static_cast<double>(number);
  return position_of_value(value_of_rank(number, bits()));
}

std::int64_t Numbers::number_at(double position) const {
  if (is_grid()) return nearest(position);
  const double most = largest(bits());
  return rank_of(std::clamp(position * step_, -most, most), bits());
}

double Numbers::spacing(double position) const {
  if (is_grid()) return 1;
  const bool single = bits() == ScalarType::float32;
  const double value =
      std::clamp(std::abs(position * step_), single ? 0x1p-126 : 0x1p-1022, largest(bits()));
  int exponent = 0;
  std::frexp(value, &exponent);
  return std::ldexp(
      1.0, std::clamp(exponent - (single ? 24 : 53) - parameter_, kLeastSpacing, kMostSpacing));
}

}  // namespace curlidar::records
