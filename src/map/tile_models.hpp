// SPDX-License-Identifier: BSD-3-Clause
// The adaptive models of a tile's syntax: which decision of which element learns where.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "entropy/model.hpp"

namespace curlidar::tile {

/// Every decision is a mix of this many models; the first is the one that a search trusts alone.
inline constexpr std::size_t kTileInputs = 5;

enum TileDecision : std::uint32_t {
  kOccupied,
  kSplitCube,
  kNewPlane,
  kCandidate,
  kAxis,
  kTerms,
  kCurved,
  kValueZero,
  kValueSign,
  kValueClass,
  kValueBits,
  kFull,
  kCell,
  kTileDecisions
};

struct TileDecisionKind {
  std::array<std::uint32_t, kTileInputs> contexts;
  std::uint32_t mixers;
};

inline constexpr std::array<TileDecisionKind, kTileDecisions> kTileDecisionKinds = {{
    {{6 * 64 * 3, 6 * 64 * 4, 6 * 27, 6 * 8 * 12, 6 * 64}, 6},      // kOccupied
    {{6 * 3 * 3, 6 * 27, 6 * 64, 6 * 16, 6 * 12}, 6},               // kSplitCube
    {{6 * 4, 6 * 27, 6 * 12, 64, 6 * 3}, 3},                        // kNewPlane
    {{6 * 3, 6 * 9, 2 * 27, 6 * 4, 2}, 2},                          // kCandidate
    {{2, 2 * 6, 2 * 64, 2, 2}, 2},                                  // kAxis
    {{6 * 4, 6 * 4 * 3, 6 * 4 * 4, 12, 6 * 4 * 3}, 4},              // kTerms
    {{6, 12, 6, 18, 6}, 1},                                         // kCurved
    {{6 * 8, 6 * 8 * 3, 8, 6 * 8 * 4, 8}, 8},                       // kValueZero
    {{8, 8 * 6, 8 * 3, 8, 8}, 1},                                   // kValueSign
    {{8 * 24, 8 * 6 * 24, 8 * 24, 8 * 4 * 24, 24}, 2},              // kValueClass
    {{24 * 8, 24 * 8, 24, 24, 24 * 8}, 1},                          // kValueBits
    {{6 * 3, 6 * 16, 6 * 27, 6 * 5, 6 * 6}, 6},                     // kFull
    {{256 * 3, 256 * 6, 256 * 2, 16 * 8 * 3, 64 * 17}, 3 * 3 * 3},  // kCell
}};

/// Where the models of each input of one kind of decision begin, and its first mixer.
struct TileModelRange {
  std::array<std::uint32_t, kTileInputs> begin{};
  std::uint32_t mixer = 0;
};

inline constexpr std::array<TileModelRange, kTileDecisions> kTileModelRanges = [] {
  std::array<TileModelRange, kTileDecisions> ranges{};
  std::uint32_t model = 0, mixer = 0;
  for (std::size_t d = 0; d < kTileDecisions; ++d) {
    for (std::size_t i = 0; i < kTileInputs; ++i) {
      ranges[d].begin[i] = model;
      model += kTileDecisionKinds[d].contexts[i];
    }
    ranges[d].mixer = mixer;
    mixer += kTileDecisionKinds[d].mixers;
  }
  return ranges;
}();

inline constexpr std::uint32_t kTileModels = [] {
  std::uint32_t total = 0;
  for (const TileDecisionKind& kind : kTileDecisionKinds) {
    for (const std::uint32_t contexts : kind.contexts) total += contexts;
  }
  return total;
}();
inline constexpr std::uint32_t kTileMixers = [] {
  std::uint32_t total = 0;
  for (const TileDecisionKind& kind : kTileDecisionKinds) total += kind.mixers;
  return total;
}();

/// The models of one decision, given relative to their kind. Every one must lie below its count.
struct TileContexts {
  TileDecision decision = kOccupied;
  std::array<std::uint32_t, kTileInputs> at{};
  std::uint32_t mixer = 0;
};

/// What adapts while a tile is coded.
struct TileModels {
  std::vector<BitModel> models;
  std::vector<MixWeights<kTileInputs>> weights;

  /// As every tile starts: without any knowledge.
  TileModels() : models(kTileModels), weights(kTileMixers) {}
  /// As another pass starts: what is worth splitting has to be learnt anew.
  void begin_pass() {
    static_assert(kOccupied < kNewPlane && kSplitCube < kNewPlane && kNewPlane == 2);
    const TileModelRange& rest = kTileModelRanges[kNewPlane];
    std::fill_n(models.begin(), rest.begin[0], BitModel());
    std::fill_n(weights.begin(), rest.mixer, MixWeights<kTileInputs>());
  }
};

inline constexpr std::int32_t kTileMixRate = 10;
inline constexpr std::uint32_t kTileLimit = 127;

/// Codes decisions with a range coder, or counts them exactly.
template <class Coder>
class TileSink {
 public:
  static constexpr bool kDecodes = Coder::kDecodes;

  TileSink(Coder& coder, TileModels& models, std::int32_t rate = kTileMixRate)
      : coder_(coder), models_(models), rate_(rate) {}

  bool bit(const TileContexts& c, bool value) {
    const TileModelRange& range = kTileModelRanges[c.decision];
    std::array<BitModel*, kTileInputs> inputs;
    for (std::size_t i = 0; i < kTileInputs; ++i) {
      inputs[i] = &models_.models[range.begin[i] + c.at[i]];
    }
    return code_bit(coder_, inputs, models_.weights[range.mixer + c.mixer], rate_, kTileLimit,
                    value);
  }
  /// A bit that nothing tells about.
  bool plain(bool value) { return coder_.code(32768, value); }

 private:
  Coder& coder_;
  TileModels& models_;
  std::int32_t rate_;
};

}  // namespace curlidar::tile
