// SPDX-License-Identifier: BSD-3-Clause
#include "compact/mask_coder.hpp"

#include <algorithm>

#include "compact/mask_model.hpp"
#include "compact/mask_priors.hpp"
#include "entropy/range_coder.hpp"

namespace curlidar::compact {
namespace {

MaskModel start(const MaskLearning& learning) {
  if (!learning.priors) return {};
  MaskModel model = mask_priors();
  model.doubt(learning.trust);
  return model;
}

/// Codes which way of learning follows.
template <class Coder>
std::size_t code_learning(Coder& coder, std::size_t way) {
  const bool high = coder.code(32768, (way & 2) != 0);
  const bool low = coder.code(32768, (way & 1) != 0);
  return (high ? 2u : 0u) + (low ? 1u : 0u);
}

std::vector<std::byte> encode(std::span<const std::uint8_t> occupied, const MaskShape& shape,
                              std::size_t way) {
  RangeEncoder coder;
  code_learning(coder, way);
  MaskModel model = start(kMaskLearning[way]);
  code_mask(coder, model, shape, kMaskLearning[way].rate, occupied.data(),
            [](std::size_t) { return true; });
  return std::move(coder).finish();
}

}  // namespace

std::vector<std::byte> encode_mask(std::span<const std::uint8_t> occupied, const MaskShape& shape,
                                   bool thorough) {
  if (shape.rows == 0 || shape.columns == 0) return {};
  std::vector<std::byte> best = encode(occupied, shape, 0);
  for (std::size_t way = 1; thorough && way < kMaskLearning.size(); ++way) {
    std::vector<std::byte> other = encode(occupied, shape, way);
    if (other.size() < best.size()) best = std::move(other);
  }
  return best;
}

std::size_t decode_mask(ByteSpan bytes, const MaskShape& shape, bool whole,
                        std::span<std::uint8_t> occupied) {
  if (shape.rows == 0 || shape.columns == 0) return shape.rows;
  std::fill(occupied.begin(), occupied.end(), std::uint8_t{0});
  RangeDecoder coder(bytes);
  const MaskLearning& learning = kMaskLearning[code_learning(coder, 0)];
  MaskModel model = start(learning);
  std::size_t sure = 0;
  code_mask(coder, model, shape, learning.rate, occupied.data(), [&](std::size_t row) {
    const bool known = whole ? !coder.exhausted() : !coder.finished();
    if (known) sure = row + 1;
    return known;
  });
  std::fill(occupied.begin() + static_cast<std::ptrdiff_t>(sure * shape.columns), occupied.end(),
            std::uint8_t{0});
  return sure;
}

}  // namespace curlidar::compact
