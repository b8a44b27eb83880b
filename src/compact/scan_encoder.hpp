// SPDX-License-Identifier: BSD-3-Clause
// From an image to the chunks of a compact file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "compact/field_syntax.hpp"
#include "compact/prediction.hpp"
#include "compact/scan_effort.hpp"
#include "compact/scan_types.hpp"
#include "curlidar/result.hpp"

namespace curlidar::compact {

struct ScanSettings {
  Steps steps;
  std::uint32_t effort = kDefaultEffort;  ///< 1..9
  std::uint32_t lambda_per_mille = kLambdaPerMille;
  /// Largest error of a range, Q16 metres, where a level is that near; needs a residual layer, in
  /// steps of at most twice it or on a lattice. 0 = none.
  std::int32_t max_error = 0;
  /// Segments; 0 = as many as cost about 2 % of the file at most.
  std::uint32_t bands = 0, sectors = 0;
  bool index = true;        ///< false also means one segment where bands and sectors are 0
  std::size_t threads = 0;  ///< 0 = all cores; any number gives the same bytes
  /// What a scan before makes expect, and what the file says of it; null: nothing. The image's
  /// size.
  const Prediction* prediction = nullptr;
  const PredictionHeader* header = nullptr;
};

/// Bits of the file by what they are spent on. The sum is what the chunks take in a container,
/// their frames included.
struct Breakdown {
  double header = 0;  ///< parameters, sensor, index, the frames and ends of all chunks
  double mask = 0, partition = 0, modes = 0, coefficients = 0, labels = 0, residual = 0;
};

struct EncodeStatistics {
  std::uint64_t returns = 0;
  std::uint64_t leaves = 0, leaves_with_residual = 0;
  std::array<std::uint64_t, 11> leaves_by_size{};  ///< by floor(log2(cells))
  std::array<std::uint64_t, kMaxLayers> leaves_by_layers{};
  std::array<std::uint64_t, kFunctions.size()> layers_by_functions{};
  std::uint64_t inherited_layers = 0;
};

struct EncodedScan {
  std::vector<ScanChunk> chunks;  ///< in the order of the file
  Image decoded;                  ///< the image as a decoder will have it
  Breakdown breakdown;
  EncodeStatistics statistics;
};

/// Encodes an image. Ranges of 1 .. kMaxRange; the field alone reaches down to kMinRange only.
/// Errors: invalid_argument (sizes that do not match, numbers out of the ranges given in
/// scan_types.hpp, a table that is no multiple of its shifts). Memory O(cells), time as effort
/// says: 2..200 us a return.
Result<EncodedScan> encode_scan(const Image& image, const RowTable& table,
                                const ScanSettings& settings);

}  // namespace curlidar::compact
