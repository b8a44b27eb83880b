// SPDX-License-Identifier: BSD-3-Clause
#include "compact/mask_coder.hpp"

#include <algorithm>

#include "compact/learnt_models.hpp"
#include "compact/mask_guide.hpp"
#include "compact/mask_model.hpp"
#include "compact/mask_priors.hpp"
#include "entropy/range_coder.hpp"

namespace curlidar::compact {
namespace {

template <class Model>
Model start(const MaskLearning& learning, const Model& priors) {
  if (!learning.priors) return {};
  Model model = priors;
  model.doubt(learning.trust);
  return model;
}

/// What a guided mask begins with.
GuidedMaskModel known_before(const Guide& guide) {
  if (guide.learnt != nullptr && guide.learnt->mask) return *guide.learnt->mask;
  GuidedMaskModel model = guided_mask_priors();
  if (guide.learnt != nullptr) std::ranges::copy(guide.learnt->plain_mask, model.models().begin());
  return model;
}

/// One walk for writing and reading, with a guide or without.
template <class Coder, class Cell, class RowDone>
void code_rows(Coder& coder, const MaskLearning& learning, const MaskShape& shape,
               const Guide* guide, Cell* cells, const RowDone& row_done,
               LearntModels* learnt = nullptr) {
  if (guide == nullptr) {
    MaskModel model = start(learning, mask_priors());
    code_mask(coder, model, shape, learning.rate, cells, row_done);
    if (learnt != nullptr) learnt->plain_mask.assign(model.models().begin(), model.models().end());
    return;
  }
  GuidedMaskModel model = start(learning, known_before(*guide));
  code_guided_mask(coder, model, MaskHints(*guide, shape), shape, learning.rate, cells, row_done);
  if (learnt != nullptr) learnt->mask = std::move(model);
}

/// Codes which way of learning follows.
template <class Coder>
std::size_t code_learning(Coder& coder, std::size_t way) {
  const bool high = coder.code(32768, (way & 2) != 0);
  const bool low = coder.code(32768, (way & 1) != 0);
  return (high ? 2u : 0u) + (low ? 1u : 0u);
}

std::vector<std::byte> encode(std::span<const std::uint8_t> occupied, const MaskShape& shape,
                              std::size_t way, const Guide* guide) {
  RangeEncoder coder;
  code_learning(coder, way);
  code_rows(coder, kMaskLearning[way], shape, guide, occupied.data(),
            [](std::size_t) { return true; });
  return std::move(coder).finish();
}

}  // namespace

std::vector<std::byte> encode_mask(std::span<const std::uint8_t> occupied, const MaskShape& shape,
                                   bool thorough, const Guide* guide) {
  if (shape.rows == 0 || shape.columns == 0) return {};
  std::vector<std::byte> best = encode(occupied, shape, 0, guide);
  for (std::size_t way = 1; thorough && way < kMaskLearning.size(); ++way) {
    std::vector<std::byte> other = encode(occupied, shape, way, guide);
    if (other.size() < best.size()) best = std::move(other);
  }
  return best;
}

std::size_t decode_mask(ByteSpan bytes, const MaskShape& shape, bool whole,
                        std::span<std::uint8_t> occupied, const Guide* guide,
                        LearntModels* learnt) {
  if (shape.rows == 0 || shape.columns == 0) return shape.rows;
  std::fill(occupied.begin(), occupied.end(), std::uint8_t{0});
  RangeDecoder coder(bytes);
  const MaskLearning& learning = kMaskLearning[code_learning(coder, 0)];
  std::size_t sure = 0;
  code_rows(
      coder, learning, shape, guide, occupied.data(),
      [&](std::size_t row) {
        const bool known = whole ? !coder.exhausted() : !coder.finished();
        if (known) sure = row + 1;
        return known;
      },
      learnt);
  std::fill(occupied.begin() + static_cast<std::ptrdiff_t>(sure * shape.columns), occupied.end(),
            std::uint8_t{0});
  return sure;
}

}  // namespace curlidar::compact
