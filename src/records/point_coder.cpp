// SPDX-License-Identifier: BSD-3-Clause
#include "records/point_coder.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar::records {
namespace {

/// Class of an error in steps: half octaves of its eighths, from the 33rd on whole ones. 0 .. 63.
std::uint32_t error_class(double steps) {
  const auto eighths = static_cast<std::uint64_t>(std::min(steps * 8, 0x1p60));
  const std::uint32_t fine = half_octave(eighths);
  return std::min(fine <= 32 ? fine : 32 + (fine - 32) / 2, 63u);
}

/// -1, 0 or 1, as 0, 1, 2.
std::uint32_t side(double value, double least) {
  return value < -least ? 0 : value > least ? 2 : 1;
}

}  // namespace

PointCoder::Expected PointCoder::expect(std::size_t axis, const Position& known,
                                        std::uint32_t before) const {
  Expected e;
  e.guess = predictor_.guess(axis, known);
  const Guess& g = e.guess;
  e.base = numbers_.number_at(g.value);
  const double base = numbers_.position(e.base), spacing = numbers_.spacing(base);
  const auto offset = [&](double position) {
    const double steps = std::floor((position - base) / spacing + 0.5);
    return static_cast<std::int64_t>(std::clamp(steps, -3.0, 3.0));
  };
  e.parallel = offset(g.parallel);
  const double fraction = std::clamp((g.value - base) / spacing, -0.5, 0.5);
  const double spread = std::abs(g.slow - g.turned) + std::abs(g.fast - g.slow);
  const std::uint32_t recent = error_class(predictor_.recent_error(axis) / spacing);
  const std::uint32_t matched = error_class(predictor_.matched_error(axis) / spacing);
  const std::uint32_t last = error_class(predictor_.last_error(axis) / spacing);
  const auto eighths = std::min(static_cast<std::uint32_t>(std::abs(fraction) * 8), 3u);
  const auto place = [](std::int64_t steps) { return static_cast<std::uint32_t>(steps + 3); };
  e.contexts = {recent * 4 + eighths, matched * 12 + std::min(before, 11u),
                error_class(spread / spacing) * 16 + std::min(recent / 2, 15u),
                last * 16 + std::min(matched / 2, 15u),
                ((place(offset(g.turned)) * kOffsets + place(offset(g.last))) * kOffsets +
                 place(e.parallel)) *
                        (kLongRun + 1) +
                    runs_[axis]};
  const auto ninths = std::min(static_cast<std::uint32_t>((fraction + 0.5) * 9), 8u);
  e.sign = (ninths * 3 + side(g.slow - g.value, 0.1 * spacing)) * 3 + (e.parallel < 0   ? 0
                                                                       : e.parallel > 0 ? 2
                                                                                        : 1);
  return e;
}

std::uint64_t PointCoder::cost(const Triple& numbers) const {
  Position known{};
  std::uint32_t before = 0;
  std::uint64_t sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Expected e = expect(axis, known, before);
    const std::int64_t rest = difference(numbers[axis], e.base);
    sum += coders_[axis].cost(e.contexts, e.sign, rest);
    known[axis] = numbers_.position(numbers[axis]);
    before = half_octave(magnitude_of(rest));
  }
  return sum;
}

}  // namespace curlidar::records
