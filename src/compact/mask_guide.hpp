// SPDX-License-Identifier: BSD-3-Clause
// What the mask of a predicted scan is told by besides its own cells. The numbers are part of the
// format.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/mask_model.hpp"
#include "compact/prediction_guide.hpp"

namespace curlidar::compact {

/// Around a cell. Of seven cells of a row, bit 3 - k is the one k columns to the right, of three
/// bit 1 - k.
struct HintWindow {
  std::uint32_t near = 0, near_above = 0, near_below = 0;     ///< a surface is expected
  std::uint32_t there = 0, there_above = 0, there_below = 0;  ///< the reference had a return
  std::uint32_t level = 0;  ///< how far the surface is: 0, 1, 2..3, more or none
};

class MaskHints {
 public:
  MaskHints(const Guide& guide, const MaskShape& shape)
      : rows_(shape.rows), stride_(shape.columns + 2 * kPad), cells_((rows_ + 2) * stride_, 0) {
    const bool closed = shape.columns == shape.turn_columns;
    const auto columns = static_cast<std::int64_t>(shape.columns);
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::int64_t k = -kPad; k < columns + kPad; ++k) {
        const std::int64_t column =
            closed ? (k + kPad * columns) % columns : std::clamp<std::int64_t>(k, 0, columns - 1);
        const std::size_t cell = row * shape.columns + static_cast<std::size_t>(column);
        cells_[(row + 1) * stride_ + static_cast<std::size_t>(k + kPad)] = packed(guide, cell);
      }
    }
  }

  HintWindow at(std::size_t row, std::size_t column) const {
    const std::uint8_t* cell = cells_.data() + (row + 1) * stride_ + kPad + column;
    HintWindow out;
    for (std::ptrdiff_t k = -3; k <= 3; ++k) {
      out.near = out.near << 1 | (cell[k] & 1u);
      out.there = out.there << 1 | (cell[k] >> 1 & 1u);
    }
    const auto stride = static_cast<std::ptrdiff_t>(stride_);
    for (std::ptrdiff_t k = -1; k <= 1; ++k) {
      out.near_above = out.near_above << 1 | (cell[k - stride] & 1u);
      out.there_above = out.there_above << 1 | (cell[k - stride] >> 1 & 1u);
      out.near_below = out.near_below << 1 | (cell[k + stride] & 1u);
      out.there_below = out.there_below << 1 | (cell[k + stride] >> 1 & 1u);
    }
    out.level = cell[0] >> 2;
    return out;
  }

 private:
  static constexpr std::int64_t kPad = 3;

  static std::uint8_t packed(const Guide& guide, std::size_t cell) {
    const std::uint32_t level = guide.level[cell];
    const std::uint32_t far = level < 2 ? level : level < 4 ? 2 : 3;
    return static_cast<std::uint8_t>((level < 2 ? 1u : 0u) |
                                     (guide.was_there[cell] != 0 ? 2u : 0u) | far << 2);
  }

  std::size_t rows_, stride_;
  std::vector<std::uint8_t> cells_;
};

inline constexpr std::size_t kHintModels = 5, kHintCells = 24;
inline constexpr std::size_t kGuidedMaskModels = kMaskModels + kHintModels;
inline constexpr std::size_t kGuidedMaskInputs = kMaskInputs + kHintModels + kHintCells;
inline constexpr std::size_t kHintWeightSets = 64;

/// The contexts of the further models, below kMaskContexts.
inline std::array<std::uint32_t, kHintModels> hint_contexts(const HintWindow& h,
                                                            const MaskWindow& w) {
  using mask_detail::count;
  const std::uint32_t left = w.left & 1, here = MaskWindow::at(w.above, 0);
  const std::uint32_t near = h.near >> 3 & 1, there = h.there >> 3 & 1;
  const std::uint32_t next = MaskWindow::at(w.above, 1);
  // Cells already known that are unlike what is said of them.
  const std::uint32_t left3 = w.left & 7;
  const std::uint32_t above3 = MaskWindow::cut(w.above, -1, 1);
  const std::uint32_t wrong_there = count(left3 ^ h.there >> 4) + count(above3 ^ h.there_above);
  const std::uint32_t wrong_near = count(left3 ^ h.near >> 4) + count(above3 ^ h.near_above);
  return {
      (h.near >> 2 & 7) | h.near_above << 3 | h.near_below << 6 | left << 9,
      (h.there >> 1 & 31) | (h.there_above >> 1 & 1) << 5 | (h.there_below >> 1 & 1) << 6 |
          left << 7 | here << 8 | near << 9,
      h.level | there << 2 | std::min(wrong_there, 3u) << 3 | std::min(wrong_near, 3u) << 5 |
          left << 7 | here << 8 | next << 9,
      (h.there >> 2 & 7) | h.level << 3 | (left ^ (h.there >> 4 & 1)) << 5 |
          (here ^ (h.there_above >> 1 & 1)) << 6 | left << 7 | here << 8 |
          (next ^ (h.there_above & 1)) << 9,
      std::min(count(h.near) + count(h.near_above) + count(h.near_below), 15u) |
          std::min((count(h.there) + count(h.there_above) + count(h.there_below)) / 2, 7u) << 4 |
          left << 7 | here << 8 | there << 9,
  };
}

/// The weight set that the further part of the mix takes.
inline std::uint32_t hint_weight_set(const HintWindow& h, const MaskWindow& w) {
  return h.level | (h.there >> 3 & 1) << 2 | (w.left & 1) << 3 | MaskWindow::at(w.above, 0) << 4 |
         (h.near >> 2 & 1) << 5;
}

/// The further single cells of the mix, from bit 0 on.
inline std::uint32_t hint_cells(const HintWindow& h) {
  return h.near | h.there << 7 | h.near_above << 14 | h.near_below << 17 | h.there_above << 20 |
         (h.there_below >> 1 & 1) << 23;
}

/// What adapts while the mask of a predicted scan is coded.
class GuidedMaskModel {
 public:
  static constexpr std::size_t kModels = kGuidedMaskModels * kMaskContexts;
  static constexpr std::size_t kWeightSets = MaskModel::kWeightSets + kHintWeightSets;

  GuidedMaskModel();

  void doubt(std::uint16_t visits) {
    for (BitModel& model : models_) model.visits = std::min(model.visits, visits);
  }
  std::span<BitModel> models() { return models_; }
  std::span<WeightSet<kGuidedMaskInputs>> weights() { return weights_; }
  std::span<const WeightSet<kGuidedMaskInputs>> weights() const { return weights_; }

  template <class Coder>
  bool code(Coder& coder, const MaskWindow& window, const HintWindow& hints, std::uint32_t scale,
            std::int32_t rate, bool occupied);

 private:
  std::vector<BitModel> models_;  ///< those of the first model first
  std::vector<WeightSet<kGuidedMaskInputs>> weights_;
};

template <class Coder>
bool GuidedMaskModel::code(Coder& coder, const MaskWindow& window, const HintWindow& hints,
                           std::uint32_t scale, std::int32_t rate, bool occupied) {
  const MaskFeatures features(window);
  const auto own = mask_contexts(window, features);
  const auto told = hint_contexts(hints, window);
  std::array<BitModel*, kGuidedMaskModels> models;
  alignas(16) std::array<std::int16_t, kGuidedMaskInputs> inputs;
  const std::uint64_t cells = mask_cells(window);
  for (std::size_t c = 0; c < kMaskCells; c += 8) {
    std::copy_n(kMaskEvidence[cells >> c & 0xff].begin(), 8, inputs.begin() + kMaskModels + c);
  }
  const std::uint32_t more = hint_cells(hints);
  for (std::size_t c = 0; c < kHintCells; c += 8) {
    std::copy_n(kMaskEvidence[more >> c & 0xff].begin(), 8, inputs.begin() + kMaskInputs + c);
  }
  for (std::size_t m = 0; m < kGuidedMaskModels; ++m) {
    const bool is_own = m < kMaskModels;
    models[m] = &models_[m * kMaskContexts + (is_own ? own[m] : told[m - kMaskModels])];
    inputs[is_own ? m : m + kMaskCells + kHintCells] =
        static_cast<std::int16_t>(stretch(models[m]->probability));
  }
  const auto sets = mask_weight_sets(window, features, scale);
  const std::array<WeightSet<kGuidedMaskInputs>*, 4> chosen = {
      &weights_[sets[0]], &weights_[kMaskWeightSets[0] + sets[1]],
      &weights_[kMaskWeightSets[0] + kMaskWeightSets[1] + sets[2]],
      &weights_[MaskModel::kWeightSets + hint_weight_set(hints, window)]};

  AveragedMix<kGuidedMaskInputs, 4> mix(inputs, chosen);
  occupied = coder.code(mix.probability(), occupied);
  mix.update(occupied, rate);
  for (BitModel* model : models) {
    observe(coder, *model, occupied);
    model->update(occupied, kMaskLimit);
  }
  return occupied;
}

/// As code_mask.
template <class Coder, class Cell, class RowDone>
void code_guided_mask(Coder& coder, GuidedMaskModel& model, const MaskHints& hints,
                      const MaskShape& shape, std::int32_t rate, Cell* cells, RowDone&& row_done) {
  const std::uint32_t scale = mask_scale(shape.turn_columns);
  walk_mask<Coder::kDecodes>(
      shape, cells,
      [&](const MaskWindow& window, std::size_t row, std::size_t column, bool bit) {
        return model.code(coder, window, hints.at(row, column), scale, rate, bit);
      },
      row_done);
}

}  // namespace curlidar::compact
