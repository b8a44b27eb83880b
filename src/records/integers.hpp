// SPDX-License-Identifier: BSD-3-Clause
// Integers of unknown spread in contexts: zero flag, sign, size class, bits from the top (an
// adaptive Exp-Golomb code); flag and size class are mixed from several contexts.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "entropy/model.hpp"
#include "entropy/plain_bits.hpp"

namespace curlidar::records {

/// 0, 1, 2, 3, then two classes an octave; at most 127.
inline std::uint32_t half_octave(std::uint64_t magnitude) {
  if (magnitude < 4) return static_cast<std::uint32_t>(magnitude);
  const auto top = static_cast<std::uint32_t>(std::bit_width(magnitude)) - 1;
  return 2 * top + static_cast<std::uint32_t>(magnitude >> (top - 1) & 1);
}

inline std::uint64_t magnitude_of(std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  return value < 0 ? 0 - bits : bits;
}

/// Codes signed integers of 64 bits. Each of `Inputs` contexts counts from 0; the context of the
/// sign comes apart. A decoder gives some integer for any bytes.
template <std::size_t Inputs>
class IntegerCoder {
 public:
  using Contexts = std::array<std::uint32_t, Inputs>;

  /// `contexts`: how many there are for each input. `signs`: how many contexts of the sign.
  IntegerCoder(const Contexts& contexts, std::uint32_t signs)
      : blocks_(1), signs_(signs), weights_(kNodes) {
    for (std::size_t i = 0; i < Inputs; ++i) block_of_[i].resize(contexts[i], kUnseen);
  }

  template <class Coder>
  std::int64_t code(Coder& coder, const Contexts& contexts, std::uint32_t sign,
                    std::int64_t value) {
    see(contexts);
    if (code_node(coder, contexts, 0, value == 0)) return 0;
    const bool negative = code_bit(coder, signs_[sign], kLimit, value < 0);
    const std::uint64_t rest = rest_of(value);
    const auto wanted = static_cast<std::uint32_t>(std::bit_width(rest));
    std::uint32_t size = 0;
    while (size < kMostBits && code_node(coder, contexts, 1 + size, wanted > size)) ++size;
    const std::uint64_t found = code_rest(coder, size, rest);
    return static_cast<std::int64_t>(negative ? ~found : found + 1);
  }

  /// About what `code` would cost, in 1/256 bit. Encoder only.
  std::uint64_t cost(const Contexts& contexts, std::uint32_t sign, std::int64_t value) const {
    std::uint64_t sum = node_cost(contexts, 0, value == 0);
    if (value == 0) return sum;
    sum += bit_cost(coder_probability(signs_[sign].probability), value < 0);
    const auto wanted = static_cast<std::uint32_t>(std::bit_width(rest_of(value)));
    for (std::uint32_t size = 0; size < kMostBits && size <= wanted; ++size) {
      sum += node_cost(contexts, 1 + size, wanted > size);
    }
    return sum + (wanted > 1 ? 256 * (wanted - 1) : 0);
  }

 private:
  static constexpr std::uint32_t kLimit = 255;
  static constexpr std::int32_t kRate = 6;
  static constexpr std::uint32_t kMostBits = 63;
  static constexpr std::uint32_t kNodes = 1 + kMostBits;
  static constexpr std::uint32_t kPrefixes = 8;

  /// The magnitude less one.
  static std::uint64_t rest_of(std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    return value < 0 ? ~bits : bits - (value != 0);
  }

  /// Gives the contexts that come for the first time models of their own: most never come.
  void see(const Contexts& contexts) {
    for (std::size_t i = 0; i < Inputs; ++i) {
      std::uint32_t& block = block_of_[i][contexts[i]];
      if (block != kUnseen) continue;
      block = static_cast<std::uint32_t>(blocks_.size());
      blocks_.emplace_back();
    }
  }

  template <class Coder>
  bool code_node(Coder& coder, const Contexts& contexts, std::uint32_t node, bool bit) {
    std::array<BitModel*, Inputs> models;
    for (std::size_t i = 0; i < Inputs; ++i) {
      models[i] = &blocks_[block_of_[i][contexts[i]]][node];
    }
    return code_bit(coder, models, weights_[node], kRate, kLimit, bit);
  }

  std::uint32_t node_cost(const Contexts& contexts, std::uint32_t node, bool bit) const {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < Inputs; ++i) {
      const BitModel& model = blocks_[block_of_[i][contexts[i]]][node];
      sum += std::int64_t{weights_[node].weight[i]} * stretch(model.probability);
    }
    constexpr std::int64_t most = kStretchLimit;
    sum = (sum + 32768) >> 16;
    return bit_cost(squash(static_cast<int>(sum > most ? most : sum < -most ? -most : sum)), bit);
  }

  /// The bits below the highest of a number of `size` bits: three in contexts, the others plain.
  template <class Coder>
  std::uint64_t code_rest(Coder& coder, std::uint32_t size, std::uint64_t rest) {
    if (size < 2) return size;
    std::uint64_t found = 1;
    std::uint32_t place = size - 1;
    while (place > 0 && found < kPrefixes) {
      --place;
      BitModel& model = bits_[size * kPrefixes + static_cast<std::uint32_t>(found)];
      found = found << 1 | (code_bit(coder, model, kLimit, (rest >> place & 1) != 0) ? 1u : 0u);
    }
    return found << place | code_plain(coder, rest, place);
  }

  static constexpr std::uint32_t kUnseen = 0;

  std::array<std::vector<std::uint32_t>, Inputs> block_of_;  ///< of each context
  std::vector<std::array<BitModel, kNodes>> blocks_;         ///< the first one never learns
  std::vector<BitModel> signs_;
  std::vector<MixWeights<Inputs>> weights_;
  std::array<BitModel, (kMostBits + 1) * kPrefixes> bits_;
};

}  // namespace curlidar::records
