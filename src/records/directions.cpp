// SPDX-License-Identifier: BSD-3-Clause
#include "records/directions.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/try.hpp"
#include "entropy/range_coder.hpp"
#include "fixed/fixed.hpp"
#include "format/payload.hpp"
#include "records/integers.hpp"

namespace curlidar {
namespace {

constexpr std::int64_t kRadianAngle = 683565276;  // round(2^32 / 2 pi)
constexpr std::int32_t kMaxStep = 1 << 30;
constexpr std::uint32_t kStepClasses = 64;
constexpr std::uint32_t kMostClass = 11;

using Pair = std::array<std::int32_t, 2>;  ///< across, up

/// Of the nearest occupied cells that came before, in steps of the cell to code.
struct Around {
  std::int64_t left = 0, above = 0;
};

std::int32_t as_angle(std::int64_t angle) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(angle, INT32_MIN, INT32_MAX));
}

class OffsetCoder {
 public:
  explicit OffsetCoder(std::uint32_t columns) : above_(columns), coders_{make(), make()} {}

  /// Codes the offset of the next occupied cell: `offset` to the nearest step, as it is decoded.
  template <class Coder>
  Pair code(Coder& coder, std::uint32_t column, std::int64_t step, const Pair& offset) {
    const auto scale =
        std::min(records::half_octave(static_cast<std::uint64_t>(step)) / 2, kStepClasses - 1);
    Pair decoded{};
    std::int64_t across = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const Around around{div_round(left_[i], step), div_round(above_[column][i], step)};
      const std::int64_t value =
          code_steps(coder, i, around, scale, across, div_round(offset[i], step));
      decoded[i] = as_angle(std::clamp<std::int64_t>(value, -kMost, kMost) * step);
      across = value;
    }
    left_ = above_[column] = decoded;
    return decoded;
  }

 private:
  static constexpr std::int64_t kMost = std::int64_t{1} << 32;
  using Coder3 = records::IntegerCoder<3>;
  static Coder3 make() {
    return {{kStepClasses * (2 * kMostClass + 1), kStepClasses * (2 * kMostClass + 1),
             (2 * kMostClass + 1) * (2 * kMostClass + 1)},
            (2 * kMostClass + 1) * 3};
  }
  /// Sign and size of a number of steps, 0 .. 2 kMostClass.
  static std::uint32_t signed_class(std::int64_t steps) {
    const auto size =
        std::min(records::half_octave(static_cast<std::uint64_t>(std::abs(steps))), kMostClass);
    return steps < 0 ? kMostClass - size : kMostClass + size;
  }

  template <class Coder>
  std::int64_t code_steps(Coder& coder, std::size_t axis, const Around& around, std::uint32_t scale,
                          std::int64_t other, std::int64_t value) {
    const std::uint32_t left = signed_class(around.left), above = signed_class(around.above);
    constexpr std::uint32_t classes = 2 * kMostClass + 1;
    const std::uint32_t sign_of_above = around.above < 0 ? 0 : around.above > 0 ? 2 : 1;
    (void)other;
    return coders_[axis].code(
        coder, {left * kStepClasses + scale, above * kStepClasses + scale, left * classes + above},
        left * 3 + sign_of_above, value);
  }

  Pair left_{};
  std::vector<Pair> above_;
  std::array<Coder3, 2> coders_;
};

/// Codes the offsets of all occupied cells; `at(i)` takes and gives them.
template <class Coder, class Offsets>
bool code_all(Coder& coder, const CellGrid& grid, std::span<const std::int32_t> ranges,
              std::int32_t step, Offsets& offsets) {
  OffsetCoder models(grid.columns);
  std::size_t i = 0;
  for (std::size_t cell = 0; cell < grid.occupied.size(); ++cell) {
    if (grid.occupied[cell] == 0) continue;
    const auto column = static_cast<std::uint32_t>(cell % grid.columns);
    const Pair decoded = models.code(coder, column, direction_step(ranges[i], step),
                                     {offsets[i].across, offsets[i].up});
    offsets[i++] = {decoded[0], decoded[1]};
    if constexpr (Coder::kDecodes) {
      if (coder.exhausted()) return false;
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
    return reader.corrupt("the offsets end early");
  }
  return offsets;
}

}  // namespace curlidar
