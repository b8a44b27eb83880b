// SPDX-License-Identifier: BSD-3-Clause
// Coordinates as integers: steps of a grid, decimals, or the bits of floating-point numbers.
#pragma once

#include <cstdint>

#include "curlidar/cloud.hpp"

namespace curlidar::records {

enum class NumberKind : std::uint8_t {
  steps,     ///< n * step
  decimals,  ///< n / 10^places
  float32,   ///< the n-th float32 from zero
  float64,   ///< the n-th float64 from zero
};

/// No grid has numbers beyond this, in magnitude.
inline constexpr std::int64_t kMostSteps = std::int64_t{1} << 46;
inline constexpr std::uint32_t kMostPlaces = 9;
/// The scale of the bits of floating-point numbers, a power of two, lies within these.
inline constexpr int kMostScale = 1000;

/// The float32 or float64 with these bits counted from zero (0 is +0, -1 is -0), and back.
std::int64_t rank_of(double value, ScalarType type);
double value_of_rank(std::int64_t rank, ScalarType type);
/// Whether the rank is that of a finite number of the type.
bool is_rank(std::int64_t rank, ScalarType type);

/// `value` in the precision of the type; false if it is not finite there.
bool round_to(ScalarType type, double& value);

/// How integers n stand for coordinates of a type. `position` is the coordinate in units that make
/// predictions and their errors comparable: steps of the grid, or 2^scale metres.
class Numbers {
 public:
  static Numbers of_steps(ScalarType type, double step) {
    return {NumberKind::steps, type, step, 0};
  }
  static Numbers of_decimals(ScalarType type, std::uint32_t places);
  /// `bits` is float32 or float64; 2^scale should be the spacing of the largest coordinates.
  static Numbers of_bits(ScalarType type, ScalarType bits, int scale);

  NumberKind kind() const { return kind_; }
  ScalarType type() const { return type_; }
  /// The step; the power of ten; the scale.
  double step() const { return step_; }
  int parameter() const { return parameter_; }

  /// The coordinate of a number; false if there is none.
  bool value(std::int64_t number, double& value) const;
  /// The number next to a coordinate; beyond any number where it is too large.
  std::int64_t number(double value) const;

  double position(std::int64_t number) const;
  double position_of_value(double value) const;
  std::int64_t number_at(double position) const;
  /// Distance of the numbers near a position.
  double spacing(double position) const;

 private:
  Numbers(NumberKind kind, ScalarType type, double step, int parameter)
      : kind_(kind), type_(type), step_(step), parameter_(parameter) {}
  bool is_grid() const { return kind_ <= NumberKind::decimals; }
  ScalarType bits() const {
    return kind_ == NumberKind::float32 ? ScalarType::float32 : ScalarType::float64;
  }

  NumberKind kind_;
  ScalarType type_;
  double step_;
  int parameter_;
};

}  // namespace curlidar::records
