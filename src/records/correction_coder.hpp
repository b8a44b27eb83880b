// SPDX-License-Identifier: BSD-3-Clause
// Codes by how many steps points lie off their prediction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "records/points.hpp"

namespace curlidar::records {

/// Steps from the prediction to the point: of a grid of offsets, or from the number next to the
/// prediction to that of the point, modulo 2^64.
Triple steps_between(const Numbers& numbers, const Vec3& predicted, const Vec3& point);

/// The predicted point moved by steps; none if that is no finite point. Exactly the prediction
/// where a grid of offsets says 0.
std::optional<Vec3> moved(const Numbers& numbers, const Vec3& predicted, const Triple& steps);

/// Encoder: whether a decoded point will do. Only the origin is decoded to the origin.
bool is_within(const Vec3& decoded, const Vec3& original, double max_error_m);

/// The models of corrections.
class CorrectionCoder {
 public:
  explicit CorrectionCoder(const Numbers& numbers) : numbers_(numbers) {}

  /// Codes the next point's steps; `predicted` is known.
  template <class Coder>
  void code(Coder& coder, const Vec3& predicted, Triple& steps) {
    if (numbers_.kind() == NumberKind::steps) {
      code_offset(coder, steps);
    } else {
      code_exact(coder, predicted, steps);
    }
  }

 private:
  static constexpr std::uint32_t kErrors = 32;
  static constexpr std::uint32_t kFractions = 16;
  static constexpr std::uint32_t kSizes = 16;  ///< classes of a number of steps
  static constexpr std::uint32_t kFlagLimit = 255;

  /// Most points of a bound stay as they are: a decision first.
  template <class Coder>
  void code_offset(Coder& coder, Triple& steps) {
    const bool corrected = code_bit(coder, flags_[history_], kFlagLimit, steps != Triple{});
    history_ = (history_ << 1 | (corrected ? 1u : 0u)) & (kHistories - 1);
    if (!corrected) {
      steps = {};
      return;
    }
    std::uint32_t others = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t last = size_class(last_[axis]);
      steps[axis] = coders_[axis].code(coder, {last * kSizes + others, last, others},
                                       side(last_[axis]), steps[axis]);
      others = std::min(others + size_class(steps[axis]), kSizes - 1);
    }
    last_ = steps;
  }

  template <class Coder>
  void code_exact(Coder& coder, const Vec3& predicted, Triple& steps) {
    const std::array<double, 3> values = as_array(predicted);
    std::uint32_t others = 0, sides = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double position = numbers_.position_of_value(values[axis]);
      const double base = numbers_.position(numbers_.number(values[axis]));
      const double spacing = numbers_.spacing(position);
      const double fraction = std::clamp((position - base) / spacing, -0.5, 0.5);
      const std::uint32_t part =
          std::min(static_cast<std::uint32_t>((fraction + 0.5) * kFractions), kFractions - 1);
      const std::uint32_t recent = error_class(recent_[axis] / spacing);
      const std::uint32_t drift = drift_class(drift_[axis] / spacing);
      steps[axis] =
          coders_[axis].code(coder,
                             {recent * kFractions + part, (drift * 9 + sides) * kFractions + part,
                              recent * kSizes + others},
                             (drift * 3 + side(last_[axis])) * kFractions + part, steps[axis]);
      others = std::min(others + size_class(steps[axis]), kSizes - 1);
      sides = sides * 3 + side(steps[axis]);
      learn(axis, (static_cast<double>(steps[axis]) - fraction) * spacing);
    }
    last_ = steps;
  }

  void learn(std::size_t axis, double error) {
    recent_[axis] += (std::abs(error) - recent_[axis]) * 0.125;
    drift_[axis] += (error - drift_[axis]) * 0.125;
  }

  static std::uint32_t size_class(std::int64_t steps) {
    return std::min(half_octave(magnitude_of(steps)), kSizes - 1);
  }
  static std::uint32_t side(std::int64_t steps) { return steps < 0 ? 0 : steps > 0 ? 2 : 1; }
  /// Half octaves of sixteenths of a step.
  static std::uint32_t error_class(double steps) {
    const auto parts = static_cast<std::uint64_t>(std::min(steps * 16, 0x1p60));
    return std::min(half_octave(parts), kErrors - 1);
  }
  static std::uint32_t drift_class(double steps) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(steps * 8 + 0.5), -3.0, 3.0) + 3);
  }

  static constexpr std::uint32_t kHistories = 16;
  static IntegerCoder<3> make_coder() {
    return {{kErrors * kSizes, 7 * 9 * kFractions, kErrors * kSizes}, 7 * 3 * kFractions};
  }

  Numbers numbers_;
  std::array<BitModel, kHistories> flags_;
  std::uint32_t history_ = 0;
  std::array<IntegerCoder<3>, 3> coders_{make_coder(), make_coder(), make_coder()};
  Triple last_{};
  Position recent_{}, drift_{};  ///< mean error of late, without and with its sign
};

}  // namespace curlidar::records
