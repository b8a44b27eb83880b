// SPDX-License-Identifier: BSD-3-Clause
#include "compact/residual_coder.hpp"

#include <algorithm>
#include <cstdlib>

#include "compact/residual_predictor.hpp"
#include "compact/residual_symbols.hpp"
#include "entropy/range_coder.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint64_t kMaxLattice = std::uint64_t{1} << 40;

std::int32_t clamp_range(std::int64_t range) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(range, 1, kMaxRangeQ16));
}

/// Rounded quotient, halves away from zero.
std::int64_t divide_rounded(std::int64_t value, std::int64_t by) {
  const std::int64_t size = (std::abs(value) + by / 2) / by;
  return value < 0 ? -size : size;
}

/// The levels of one cell, numbered from the one nearest its prediction.
class CellLevels {
 public:
  CellLevels(const ResidualLevels& levels, std::int32_t prediction)
      : step_(levels.step),
        lattice_(static_cast<std::int64_t>(levels.lattice_q32)),
        prediction_(prediction) {
    if (lattice_ != 0) first_ = divide_rounded(std::int64_t{prediction} << 16, lattice_);
  }

  std::int32_t range(std::int32_t number) const {
    if (lattice_ == 0) return clamp_range(prediction_ + std::int64_t{number} * step_);
    const std::int64_t most = (std::int64_t{kMaxRangeQ16} << 16) / lattice_ + 1;
    const std::int64_t multiple = std::clamp<std::int64_t>(first_ + number, 0, most);
    return clamp_range((multiple * lattice_ + 32768) >> 16);
  }
  std::int32_t nearest(std::int32_t range) const {
    return static_cast<std::int32_t>(
        lattice_ == 0 ? divide_rounded(std::int64_t{range} - prediction_, step_)
                      : divide_rounded(std::int64_t{range} << 16, lattice_) - first_);
  }

 private:
  std::int64_t step_, lattice_;
  std::int32_t prediction_;
  std::int64_t first_ = 0;
};

/// The limits that callers are to keep, for whoever does not.
ResidualLevels within_limits(ResidualLevels levels) {
  levels.step = std::clamp(levels.step, 1, 1 << 24);
  if (levels.lattice_q32 != 0) {
    levels.lattice_q32 = std::clamp(levels.lattice_q32, std::uint64_t{1} << 16, kMaxLattice);
    levels.step = static_cast<std::int32_t>((levels.lattice_q32 + 32768) >> 16);
  }
  return levels;
}

/// Walks the coded cells in raster order: `choose(cell, levels, symbols)` codes or decodes a
/// residual; `row_done(row)` says whether to go on.
template <class Choose, class RowDone>
void code_segment(const ResidualSegment& segment, const ResidualLevels& asked,
                  std::span<std::int32_t> decoded, const Choose& choose, const RowDone& row_done) {
  const ResidualLevels levels = within_limits(asked);
  ResidualPredictor predictor(segment.columns, levels.step);
  ResidualSymbols symbols(levels.step);
  RangePrediction prediction;
  for (std::size_t row = 0; row < segment.rows; ++row) {
    predictor.start_row();
    for (std::size_t column = 0; column < segment.columns; ++column) {
      const std::size_t cell = row * segment.columns + column;
      if (!segment.occupied[cell] || !segment.coded[cell]) continue;
      predictor.predict(column, clamp_range(segment.field[cell]), segment.surface[cell],
                        prediction);
      const CellLevels cell_levels(levels, prediction.blend);
      symbols.set_cell(prediction, cell_levels.range(0));
      decoded[cell] = cell_levels.range(choose(cell, cell_levels, symbols));
      predictor.learn(column, decoded[cell], prediction);
    }
    if (!row_done(row)) return;
  }
}

/// The cells from `begin` on without their residuals.
void start_from_field(const ResidualSegment& segment, std::size_t begin,
                      std::span<std::int32_t> decoded) {
  for (std::size_t cell = begin; cell < decoded.size(); ++cell) {
    decoded[cell] = segment.occupied[cell] ? clamp_range(segment.field[cell]) : 0;
  }
}

/// The residual that costs least in error and bits: the nearest, the next towards zero, or zero.
std::int32_t best_residual(std::int32_t range, const CellLevels& levels,
                           const ResidualBalance& balance, ResidualSymbols& symbols) {
  const std::int32_t nearest = levels.nearest(range);
  if (nearest == 0 || balance.lambda == 0) return nearest;
  std::int32_t best = nearest;
  std::int64_t best_cost = -1;
  for (const std::int32_t residual : {nearest, nearest > 0 ? nearest - 1 : nearest + 1, 0}) {
    const std::int64_t error = std::abs(range - levels.range(residual));
    if (balance.max_error > 0 && residual != nearest && error > balance.max_error) continue;
    const std::int64_t cost = error * 65536 + std::int64_t{balance.lambda} * symbols.cost(residual);
    if (best_cost < 0 || cost < best_cost) {
      best = residual;
      best_cost = cost;
    }
  }
  return best;
}

}  // namespace

std::vector<std::byte> encode_residual(const ResidualSegment& segment,
                                       std::span<const std::int32_t> ranges,
                                       const ResidualLevels& levels, const ResidualBalance& balance,
                                       std::span<std::int32_t> decoded) {
  start_from_field(segment, 0, decoded);
  RangeEncoder coder;
  code_segment(
      segment, levels, decoded,
      [&](std::size_t cell, const CellLevels& cell_levels, ResidualSymbols& symbols) {
        return symbols.code(coder, best_residual(ranges[cell], cell_levels, balance, symbols));
      },
      [](std::size_t) { return true; });
  return std::move(coder).finish();
}

std::size_t decode_residual(ByteSpan bytes, const ResidualSegment& segment,
                            const ResidualLevels& levels, std::span<std::int32_t> decoded,
                            bool cut) {
  start_from_field(segment, 0, decoded);
  RangeDecoder coder(bytes);
  // The decoder reads ahead: a row is sure only while bytes are left, the last ones once the end
  // is reached with nothing missing.
  std::size_t sure = 0;
  code_segment(
      segment, levels, decoded,
      [&](std::size_t, const CellLevels&, ResidualSymbols& symbols) {
        return symbols.code(coder, 0);
      },
      [&](std::size_t row) {
        if (!coder.finished()) sure = row + 1;
        return !coder.exhausted();
      });
  if (!cut && !coder.exhausted()) return segment.rows;
  start_from_field(segment, sure * segment.columns, decoded);
  return sure;
}

}  // namespace curlidar::compact
