// SPDX-License-Identifier: BSD-3-Clause
// Integers of unknown spread in contexts: zero flag, sign, size class, bits from the top
// (an adaptive Exp-Golomb code), every decision of the first kinds mixed from several contexts.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "entropy/model.hpp"

namespace curlidar::records {

/// Equally likely bits, the highest first.
template <class Coder>
std::uint64_t code_plain(Coder& coder, std::uint64_t value, unsigned bits) {
  std::uint64_t found = 0;
  for (unsigned i = bits; i-- > 0;) {
    found = found << 1 | (coder.code(32768, (value >> i & 1) != 0) ? 1u : 0u);
  }
  return found;
}

/// An angle or error as a class: 0, 1, 2, 3, then two classes an octave. At most 127.
inline std::uint32_t half_octave(std::uint64_t magnitude) {
  if (magnitude < 4) return static_cast<std::uint32_t>(magnitude);
  const auto top = static_cast<std::uint32_t>(std::bit_width(magnitude)) - 1;
  return 2 * top + static_cast<std::uint32_t>(magnitude >> (top - 1) & 1);
}

/// Codes signed integers. Each of `Inputs` contexts counts from 0; the context of the sign comes
/// apart. Integers beyond +-2^63 cannot be coded; a decoder gives some integer for any bytes.
template <std::size_t Inputs>
class IntegerCoder {
 public:
  using Contexts = std::array<std::uint32_t, Inputs>;

  /// `contexts`: how many there are for each input. `signs`: how many contexts of the sign.
  IntegerCoder(const Contexts& contexts, std::uint32_t signs) : signs_(signs), weights_(kNodes) {
    for (std::size_t i = 0; i < Inputs; ++i) models_[i].resize(std::size_t{contexts[i]} * kNodes);
  }

  template <class Coder>
  std::int64_t code(Coder& coder, const Contexts& contexts, std::uint32_t sign_context,
                    std::int64_t value) {
    if (node(coder, contexts, 0, value == 0)) return 0;
    const bool negative = code_bit(coder, signs_[sign_context], kLimit, value < 0);
    const std::uint64_t target =
        (negative ? ~static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value) - 1);
    const auto size =
        code_size(coder, contexts, static_cast<std::uint32_t>(std::bit_width(target)));
    const std::uint64_t magnitude = code_bits(coder, size, target);
    return static_cast<std::int64_t>(negative ? ~magnitude : magnitude + 1);
  }

 private:
  static constexpr std::uint32_t kLimit = 255;
  static constexpr std::uint32_t kMaxSize = 63;
  static constexpr std::uint32_t kNodes = 1 + kMaxSize;
  static constexpr std::int32_t kRate = 6;

  template <class Coder>
  bool node(Coder& coder, const Contexts& contexts, std::uint32_t node, bool bit) {
    std::array<BitModel*, Inputs> models;
    for (std::size_t i = 0; i < Inputs; ++i) {
      models[i] = &models_[i][std::size_t{contexts[i]} * kNodes + node];
    }
    return code_bit(coder, models, weights_[node], kRate, kLimit, bit);
  }

  /// How many bits the magnitude less one has.
  template <class Coder>
  std::uint32_t code_size(Coder& coder, const Contexts& contexts, std::uint32_t target) {
    std::uint32_t size = 0;
    while (size < kMaxSize && node(coder, contexts, 1 + size, target > size)) ++size;
    return size;
  }

  template <class Coder>
  std::uint64_t code_bits(Coder& coder, std::uint32_t size, std::uint64_t target) {
    if (size < 2) return size;
    std::uint64_t magnitude = 1;
    std::uint32_t place = size - 1;
    for (std::uint32_t known = 1; place > 0 && known < 8;) {
      --place;
      const bool bit = code_bit(coder, bits_[size * 8 + known], kLimit, (target >> place & 1) != 0);
      magnitude = magnitude << 1 | (bit ? 1 : 0);
      known = known << 1 | (bit ? 1 : 0);
    }
    return magnitude << place | code_plain(coder, target, place);
  }

  std::array<std::vector<BitModel>, Inputs> models_;
  std::vector<BitModel> signs_;
  std::vector<MixWeights<Inputs>> weights_;
  std::array<BitModel, (kMaxSize + 1) * 8> bits_;
};

}  // namespace curlidar::records
