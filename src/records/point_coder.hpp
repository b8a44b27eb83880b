// SPDX-License-Identifier: BSD-3-Clause
// Codes points as three numbers each, in contexts of what the predictor expects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "records/coordinates.hpp"
#include "records/integers.hpp"
#include "records/point_predictor.hpp"
#include "records/points.hpp"

namespace curlidar::records {

/// The models of points and what has been coded. For each point: begin(), then code() or raw().
class PointCoder {
 public:
  explicit PointCoder(const Numbers& numbers) : numbers_(numbers) {}

  void begin() { predictor_.begin(); }

  /// Codes the point that begin() expects. The decoder's numbers may be of no value.
  template <class Coder>
  void code(Coder& coder, Triple& numbers) {
    Position known{}, errors{};
    std::uint32_t before = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Expected e = expect(axis, known, before);
      const std::int64_t rest =
          coders_[axis].code(coder, e.contexts, e.sign, difference(numbers[axis], e.base));
      numbers[axis] = sum(e.base, rest);
      known[axis] = numbers_.position(numbers[axis]);
      before = half_octave(magnitude_of(rest));
      errors[axis] = std::abs(known[axis] - e.guess.value);
      std::uint32_t& run = runs_[axis];
      run = clipped(rest) == e.parallel ? (run < kLongRun ? run + 1 : kLongRun) : 0;
      predictor_.learn(axis, e.guess, known[axis]);
    }
    predictor_.push(known, errors);
  }

  /// About what code() would cost, in 1/256 bit. Encoder only.
  std::uint64_t cost(const Triple& numbers) const;

  /// Takes note of a point that was told otherwise.
  void raw(const Position& position) { predictor_.push(position, {}); }

 private:
  static constexpr std::uint32_t kLongRun = 3;
  static constexpr std::uint32_t kErrors = 64;    ///< classes of errors
  static constexpr std::uint32_t kOffsets = 7;    ///< -3 .. 3 steps
  static constexpr std::uint32_t kFractions = 9;  ///< of a step

  struct Expected {
    Guess guess;
    std::int64_t base = 0;      ///< the number next to the guess
    std::int64_t parallel = 0;  ///< from there to guess.parallel, -3 .. 3
    std::array<std::uint32_t, 5> contexts{};
    std::uint32_t sign = 0;
  };

  // Modulo 2^64: the ranks of float64 may lie that far apart.
  static std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
  }
  static std::int64_t sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
  }
  static std::int64_t clipped(std::int64_t steps) {
    return steps < -3 ? -3 : steps > 3 ? 3 : steps;
  }

  /// `before` is the class of what the guess missed on the axis before.
  Expected expect(std::size_t axis, const Position& known, std::uint32_t before) const;

  static IntegerCoder<5> make_coder() {
    return {{kErrors * 4, kErrors * 12, kErrors * 16, kErrors * 16,
             kOffsets * kOffsets * kOffsets * (kLongRun + 1)},
            kFractions * 3 * 3};
  }

  Numbers numbers_;
  PointPredictor predictor_;
  std::array<IntegerCoder<5>, 3> coders_{make_coder(), make_coder(), make_coder()};
  std::array<std::uint32_t, 3> runs_{};  ///< how long guess.parallel was right
};

}  // namespace curlidar::records
