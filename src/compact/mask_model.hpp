// SPDX-License-Identifier: BSD-3-Clause
// Models of a mask's cells, and the one walk over them that encoder, decoder and trainer share.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compact/mask_contexts.hpp"
#include "compact/mask_window.hpp"
#include "entropy/averaged_mix.hpp"
#include "entropy/model.hpp"

namespace curlidar::compact {

/// How a mask learns, chosen by the encoder for each segment.
struct MaskLearning {
  bool priors;          ///< starts from the trained states and weights; else from nothing
  std::uint16_t trust;  ///< visits that a trained state counts for at most
  std::int32_t rate;    ///< of the weights, in 1/1024
};
inline constexpr std::array<MaskLearning, 4> kMaskLearning = {
    {{true, 255, 5}, {true, 255, 14}, {true, 6, 10}, {false, 0, 10}}};

inline constexpr std::uint32_t kMaskLimit = 255;

/// What eight single cells say to the mix: half a nat for or against.
inline constexpr auto kMaskEvidence = [] {
  std::array<std::array<std::int16_t, 8>, 256> table{};
  for (std::size_t bits = 0; bits < 256; ++bits) {
    for (std::size_t c = 0; c < 8; ++c) table[bits][c] = (bits >> c & 1) != 0 ? 128 : -128;
  }
  return table;
}();

/// What adapts while a mask is coded.
class MaskModel {
 public:
  static constexpr std::size_t kModels = kMaskModels * kMaskContexts;
  static constexpr std::size_t kWeightSets =
      kMaskWeightSets[0] + kMaskWeightSets[1] + kMaskWeightSets[2];

  /// Knows nothing yet: every model counts alike, no single cell does.
  MaskModel();

  /// Lets every model count for at most so many visits.
  void doubt(std::uint16_t visits) {
    for (BitModel& model : models_) model.visits = std::min(model.visits, visits);
  }

  std::span<BitModel> models() { return models_; }
  std::span<WeightSet<kMaskInputs>> weights() { return weights_; }
  std::span<const WeightSet<kMaskInputs>> weights() const { return weights_; }

  /// Codes a cell.
  template <class Coder>
  bool code(Coder& coder, const MaskWindow& window, std::uint32_t scale, std::int32_t rate,
            bool occupied);

 private:
  std::vector<BitModel> models_;  ///< those of the first model first
  std::vector<WeightSet<kMaskInputs>> weights_;
};

template <class Coder>
bool MaskModel::code(Coder& coder, const MaskWindow& window, std::uint32_t scale, std::int32_t rate,
                     bool occupied) {
  const MaskFeatures features(window);
  const auto contexts = mask_contexts(window, features);
  std::array<BitModel*, kMaskModels> models;
  alignas(16) std::array<std::int16_t, kMaskInputs> inputs;
  for (std::size_t m = 0; m < kMaskModels; ++m) {
    models[m] = &models_[m * kMaskContexts + contexts[m]];
    inputs[m] = static_cast<std::int16_t>(stretch(models[m]->probability));
  }
  const std::uint64_t cells = mask_cells(window);
  for (std::size_t c = 0; c < kMaskCells; c += 8) {
    std::copy_n(kMaskEvidence[cells >> c & 0xff].begin(), 8, inputs.begin() + kMaskModels + c);
  }
  const auto sets = mask_weight_sets(window, features, scale);
  const std::array<WeightSet<kMaskInputs>*, 3> chosen = {
      &weights_[sets[0]], &weights_[kMaskWeightSets[0] + sets[1]],
      &weights_[kMaskWeightSets[0] + kMaskWeightSets[1] + sets[2]]};

  AveragedMix<kMaskInputs, 3> mix(inputs, chosen);
  occupied = coder.code(mix.probability(), occupied);
  mix.update(occupied, rate);
  for (BitModel* model : models) {
    observe(coder, *model, occupied);
    model->update(occupied, kMaskLimit);
  }
  return occupied;
}

/// Goes over the rows of a mask from the top until `row_done(row)` says no, and calls
/// `code_cell(window, row, column, bit)` for every cell. Cells are read or written.
template <bool kDecodes, class Cell, class CodeCell, class RowDone>
void walk_mask(const MaskShape& shape, Cell* cells, const CodeCell& code_cell, RowDone&& row_done) {
  MaskScan scan(shape);
  for (std::size_t row = 0; row < shape.rows; ++row) {
    scan.begin_row();
    for (std::size_t column = 0; column < shape.columns; ++column, ++cells) {
      scan.begin_cell();
      const bool bit = !kDecodes && *cells != 0;
      const bool occupied = code_cell(scan.window(), row, column, bit);
      if constexpr (kDecodes) *cells = occupied;
      scan.end_cell(occupied);
    }
    if (!row_done(row)) return;
  }
}

/// Codes rows of a mask, as walk_mask goes over them.
template <class Coder, class Cell, class RowDone>
void code_mask(Coder& coder, MaskModel& model, const MaskShape& shape, std::int32_t rate,
               Cell* cells, RowDone&& row_done) {
  const std::uint32_t scale = mask_scale(shape.turn_columns);
  walk_mask<Coder::kDecodes>(
      shape, cells,
      [&](const MaskWindow& window, std::size_t, std::size_t, bool bit) {
        return model.code(coder, window, scale, rate, bit);
      },
      row_done);
}

}  // namespace curlidar::compact
