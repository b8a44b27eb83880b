// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_coder.hpp"

#include <algorithm>
#include <cstdlib>

#include "compact/residual_predictor.hpp"
#include "compact/residual_symbol.hpp"
#include "entropy/range_coder.hpp"

namespace curlidar {
namespace {

std::int32_t clamp_range(std::int64_t range) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(range, 1, kMaxRangeQ16));
}

/// Visits the cells of a segment in raster order: `choose(row, cell, prediction, symbols)` codes or
/// decodes a residual.
template <class Choose, class RowDone>
void code_segment(const ResidualSegment& segment, std::int32_t step,
                  std::span<std::int32_t> decoded, const Choose& choose, const RowDone& row_done) {
  ResidualPredictor predictor(segment.columns, step);
  ResidualSymbols symbols(step);
  RangePrediction prediction;
  for (std::size_t row = 0; row < segment.rows; ++row) {
    predictor.start_row();
    for (std::size_t column = 0; column < segment.columns; ++column) {
      const std::size_t cell = row * segment.columns + column;
      if (!segment.occupied[cell]) {
        decoded[cell] = 0;
        continue;
      }
      const std::int32_t field = clamp_range(segment.field[cell]);
      if (!segment.coded[cell]) {
        decoded[cell] = field;
        continue;
      }
      predictor.predict(column, field, segment.surface[cell], prediction);
      symbols.set_cell(prediction);
      const std::int32_t q = choose(cell, prediction.range, symbols);
      decoded[cell] = clamp_range(prediction.range + std::int64_t{q} * step);
      predictor.learn(column, decoded[cell], prediction);
    }
    if (!row_done(row)) return;
  }
}

/// The level nearest to a difference.
std::int32_t nearest_level(std::int64_t difference, std::int32_t step) {
  const std::int64_t size = (2 * std::abs(difference) + step) / (2 * step);
  return static_cast<std::int32_t>(difference < 0 ? -size : size);
}

/// The level that costs least in error and bits: the nearest, the next towards zero, or zero.
std::int32_t best_level(std::int64_t difference, std::int32_t step, std::uint32_t lambda,
                        ResidualSymbols& symbols) {
  const std::int32_t nearest = nearest_level(difference, step);
  if (nearest == 0 || lambda == 0) return nearest;
  std::int32_t best = nearest;
  std::int64_t best_cost = -1;
  for (const std::int32_t q : {nearest, nearest > 0 ? nearest - 1 : nearest + 1, 0}) {
    const std::int64_t error = std::abs(difference - std::int64_t{q} * step);
    const std::int64_t cost = error * 65536 + static_cast<std::int64_t>(lambda) * symbols.cost(q);
    if (best_cost < 0 || cost < best_cost) {
      best = q;
      best_cost = cost;
    }
  }
  return best;
}

}  // namespace

std::vector<std::byte> encode_residual(const ResidualSegment& segment,
                                       std::span<const std::int32_t> ranges, std::int32_t step,
                                       std::uint32_t lambda, std::span<std::int32_t> decoded) {
  RangeEncoder coder;
  code_segment(
      segment, step, decoded,
      [&](std::size_t cell, std::int32_t prediction, ResidualSymbols& symbols) {
        const std::int64_t difference = std::int64_t{ranges[cell]} - prediction;
        return symbols.code(coder, best_level(difference, step, lambda, symbols));
      },
      [](std::size_t) { return true; });
  return std::move(coder).finish();
}

std::size_t decode_residual(ByteSpan bytes, const ResidualSegment& segment, std::int32_t step,
                            std::span<std::int32_t> decoded) {
  RangeDecoder coder(bytes);
  std::size_t complete = 0;
  for (std::size_t cell = 0; cell < decoded.size(); ++cell) {
    decoded[cell] = segment.occupied[cell] ? clamp_range(segment.field[cell]) : 0;
  }
  code_segment(
      segment, step, decoded,
      [&](std::size_t, std::int32_t, ResidualSymbols& symbols) { return symbols.code(coder, 0); },
      [&](std::size_t row) {
        if (!coder.exhausted()) complete = row + 1;
        return !coder.exhausted();
      });
  return complete;
}

}  // namespace curlidar
