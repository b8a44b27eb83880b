// SPDX-License-Identifier: BSD-3-Clause
#include "records/correction_coder.hpp"

namespace curlidar::records {
namespace {

std::int64_t wrapped_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t wrapped_difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

std::optional<double> moved(const Numbers& numbers, double predicted, std::int64_t steps) {
  double value = predicted;
  if (numbers.kind() != NumberKind::steps) {
    const std::int64_t number = wrapped_sum(numbers.number(predicted), steps);
    return numbers.value(number, value) ? std::optional(value) : std::nullopt;
  }
  if (steps > kMostSteps || steps < -kMostSteps) return std::nullopt;
  if (steps != 0) value += static_cast<double>(steps) * numbers.step();
  return round_to(numbers.type(), value) ? std::optional(value) : std::nullopt;
}

}  // namespace

Triple steps_between(const Numbers& numbers, const Vec3& predicted, const Vec3& point) {
  if (numbers.kind() == NumberKind::steps) return numbers_of(numbers, point - predicted);
  const Triple from = numbers_of(numbers, predicted), to = numbers_of(numbers, point);
  return {wrapped_difference(to[0], from[0]), wrapped_difference(to[1], from[1]),
          wrapped_difference(to[2], from[2])};
}

std::optional<Vec3> moved(const Numbers& numbers, const Vec3& predicted, const Triple& steps) {
  const auto x = moved(numbers, predicted.x, steps[0]);
  const auto y = moved(numbers, predicted.y, steps[1]);
  const auto z = moved(numbers, predicted.z, steps[2]);
  if (!x || !y || !z) return std::nullopt;
  return Vec3{*x, *y, *z};
}

bool is_within(const Vec3& decoded, const Vec3& original, double max_error_m) {
  if (decoded == Vec3{} && original != Vec3{}) return false;
  return norm(decoded - original) <= max_error_m;
}

}  // namespace curlidar::records
