// SPDX-License-Identifier: BSD-3-Clause
#include "records/directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/try.hpp"
#include "entropy/range_coder.hpp"
#include "fixed/fixed.hpp"
#include "format/payload.hpp"
#include "records/integers.hpp"

namespace curlidar {
namespace {

constexpr std::int64_t kRadianAngle = 683565276;  // round(2^32 / 2 pi)
constexpr std::int64_t kMaxStep = 1 << 30;
constexpr std::int64_t kTurn = std::int64_t{1} << 32;

constexpr std::size_t kGuesses = 4;
using Pair = std::array<std::int64_t, 2>;  ///< angles across and up
using Guesses = std::array<std::int64_t, kGuesses>;

/// Offsets that came before, near the cell to code.
struct Around {
  Pair left{}, second{};       ///< the last two in the row
  Pair above{}, above_left{};  ///< the last ones in this column and in that of `left`
};

/// Errors of late, in angles.
struct Misses {
  std::array<std::int64_t, kGuesses> guesses{};
  std::int64_t best = 0;

  static void learn(std::int64_t& mean, std::int64_t error) {
    mean += shift_right_round((std::abs(error) << 8) - mean, 3);
  }
};

/// Codes offsets as whole steps beside the best of a few guesses.
class OffsetCoder {
 public:
  explicit OffsetCoder(std::uint32_t columns) : cell_(kTurn / std::max(columns, 1u)) {}

  template <class Coder>
  Pair code(Coder& coder, const Around& around, std::int64_t step, const Pair& offset) {
    Pair decoded{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Guesses guesses = guess(axis, around);
      const std::size_t best = best_of(axis);
      const Expected e = expect(axis, guesses, guesses[best], step);
      const std::int64_t wanted = div_round(offset[axis], step) - e.base;
      const std::int64_t rest = coders_[axis].code(coder, e.contexts, e.sign, wanted);
      decoded[axis] = angle(e.base, rest, step);
      learn(axis, guesses, decoded[axis], rest);
    }
    return decoded;
  }

 private:
  static constexpr std::uint32_t kErrors = 40;
  static constexpr std::uint32_t kSides = 5;  ///< -2 .. 2
  static constexpr std::uint32_t kParts = 8;  ///< of a step
  static constexpr std::uint32_t kSizes = 12;

  struct Expected {
    std::int64_t base = 0;
    std::array<std::uint32_t, 3> contexts{};
    std::uint32_t sign = 0;
  };

  static records::IntegerCoder<3> make_coder() {
    return {{kErrors * kParts, kSides * kSides * kSides * kErrors, kErrors * kSizes * kSizes},
            kParts * kSides * kSides};
  }

  /// The angle within half a cell of the middle, by whole cells; along rows only.
  std::int64_t wrapped(std::size_t axis, std::int64_t angle) const {
    return axis == 0 ? angle - div_round(angle, cell_) * cell_ : angle;
  }

  Guesses guess(std::size_t axis, const Around& a) const {
    const std::int64_t left = a.left[axis], above = a.above[axis];
    return {left, wrapped(axis, 2 * left - a.second[axis]),
            wrapped(axis, left + above - a.above_left[axis]), above};
  }

  std::size_t best_of(std::size_t axis) const {
    const auto& misses = misses_[axis].guesses;
    return static_cast<std::size_t>(std::min_element(misses.begin(), misses.end()) -
                                    misses.begin());
  }

  Expected expect(std::size_t axis, const Guesses& guesses, std::int64_t best,
                  std::int64_t step) const {
    Expected e;
    e.base = div_round(best, step);
    const auto beside = [&](std::int64_t guess) {
      const std::int64_t steps = div_round(guess, step) - e.base;
      return static_cast<std::uint32_t>(std::clamp<std::int64_t>(steps, -2, 2) + 2);
    };
    // Where in its step the guess lies: 0 .. kParts - 1.
    const std::int64_t into =
        std::clamp<std::int64_t>(best - e.base * step + step / 2, 0, step - 1);
    const auto part = static_cast<std::uint32_t>(into * kParts / step);
    const std::uint32_t error = error_class(misses_[axis].best, step);
    const std::uint32_t parallel = beside(guesses[2]), left = beside(guesses[0]);
    e.contexts = {error * kParts + part,
                  ((parallel * kSides + left) * kSides + beside(guesses[3])) * kErrors + error,
                  (error * kSizes + last_[axis]) * kSizes + (axis == 1 ? last_[0] : last_[1])};
    e.sign = (part * kSides + parallel) * kSides + left;
    return e;
  }

  /// Half octaves of sixteenths of a step; `mean` in 1/256.
  static std::uint32_t error_class(std::int64_t mean, std::int64_t step) {
    const auto parts = static_cast<std::uint64_t>(div_floor(mean, step)) >> 4;
    return std::min(records::half_octave(parts), kErrors - 1);
  }

  /// Of any number of steps, within a turn.
  static std::int64_t angle(std::int64_t base, std::int64_t rest, std::int64_t step) {
    const std::int64_t most = kTurn / step + 1;
    const std::int64_t steps = std::clamp<std::int64_t>(rest, -kTurn, kTurn) + base;
    return std::clamp<std::int64_t>(std::clamp(steps, -most, most) * step, INT32_MIN, INT32_MAX);
  }

  void learn(std::size_t axis, const Guesses& guesses, std::int64_t value, std::int64_t rest) {
    Misses& misses = misses_[axis];
    Misses::learn(misses.best, guesses[best_of(axis)] - value);
    for (std::size_t i = 0; i < kGuesses; ++i) {
      Misses::learn(misses.guesses[i], guesses[i] - value);
    }
    last_[axis] = std::min(records::half_octave(records::magnitude_of(rest)), kSizes - 1);
  }

  std::int64_t cell_;
  std::array<Misses, 2> misses_{};
  std::array<records::IntegerCoder<3>, 2> coders_{make_coder(), make_coder()};
  std::array<std::uint32_t, 2> last_{};  ///< size classes
};

Pair as_pair(const DirectionOffset& offset) {
  return {offset.across, offset.up};
}

/// Codes the offsets of all occupied cells in place.
template <class Coder>
bool code_all(Coder& coder, const CellGrid& grid, std::span<const std::int32_t> ranges,
              std::int32_t step, std::span<DirectionOffset> offsets) {
  OffsetCoder models(grid.columns);
  // The last offset in each column.
  std::vector<Pair> last(grid.columns);
  std::size_t i = 0;
  for (std::uint32_t row = 0; row < grid.rows; ++row) {
    Around around;
    for (std::uint32_t column = 0; column < grid.columns; ++column) {
      if (grid.occupied[std::size_t{row} * grid.columns + column] == 0) continue;
      around.above = last[column];
      const Pair decoded =
          models.code(coder, around, direction_step(ranges[i], step), as_pair(offsets[i]));
      offsets[i++] = {static_cast<std::int32_t>(decoded[0]), static_cast<std::int32_t>(decoded[1])};
      around = {decoded, around.left, {}, around.above};
      last[column] = decoded;
      if constexpr (Coder::kDecodes) {
        if (coder.exhausted()) return false;
      }
    }
  }
  return true;
}

}  // namespace

std::int64_t direction_step(std::int32_t range, std::int32_t step) {
  return std::max<std::int64_t>(1, div_floor(step * kRadianAngle, range));
}

CodedDirections encode_directions(const CellGrid& grid, std::span<const std::int32_t> ranges,
                                  std::span<const DirectionOffset> offsets, std::int32_t step) {
  CodedDirections result;
  result.decoded.assign(offsets.begin(), offsets.end());
  ByteWriter writer;
  writer.write_varint(static_cast<std::uint64_t>(step));
  RangeEncoder encoder;
  code_all(encoder, grid, ranges, step, result.decoded);
  writer.write_bytes(std::move(encoder).finish());
  result.bytes = std::move(writer).bytes();
  return result;
}

Result<std::vector<DirectionOffset>> decode_directions(const Chunk& chunk, const CellGrid& grid,
                                                       std::span<const std::int32_t> ranges) {
  PayloadReader reader(chunk);
  CURLIDAR_TRY_ASSIGN(step, reader.read_count("units of step", kMaxStep));
  if (step == 0) return reader.corrupt("a step of zero");
  RangeDecoder decoder(reader.take(reader.remaining()));
  std::vector<DirectionOffset> offsets(ranges.size());
  if (!code_all(decoder, grid, ranges, static_cast<std::int32_t>(step), offsets)) {
    return reader.corrupt(fmt::format("the offsets of {} cells end early", ranges.size()));
  }
  return offsets;
}

}  // namespace curlidar
