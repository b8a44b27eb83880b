// SPDX-License-Identifier: BSD-3-Clause
// The steps at which a compact file reaches its target.
#pragma once

#include <cstdint>
#include <optional>

#include "codec/compact_grid.hpp"
#include "codec/compact_model.hpp"
#include "codec/predicted_image.hpp"
#include "compact/scan_encoder.hpp"
#include "curlidar/codec.hpp"

namespace curlidar {

/// The effort of encodings that only compare one thing with another.
inline constexpr std::uint32_t kQuickEffort = 2;

/// What is being coded; everything outlives the search.
struct CompactJob {
  const Cloud& cloud;
  const GriddedScan& scan;
  const CompactModel& model;
  const CompactSettings& settings;
  std::size_t threads = 1;
  ProgressCallback progress{};
  double start = 0;  ///< logarithm of the scale of the usual steps at which the search begins
  compact::FieldKind kind = compact::FieldKind::by_error;
  /// Files with every return: the points without a cell, as decoded. Without it, what lies out of
  /// the scan's range does not count.
  std::optional<std::vector<Vec3>> loose{};
  double beside_bits = 0;      ///< what a file takes besides its image and offsets of directions
  std::int32_t max_error = 0;  ///< of a range, Q16 metres; 0 = none
  const PredictedModel* predicted = nullptr;  ///< of the model's image, if there is a scan before
};

/// One encoding and what it gave.
struct CompactTrial {
  compact::Steps steps;
  compact::EncodedScan encoded;
  std::vector<std::byte> directions;  ///< payload of that chunk; empty: none
  OwnErrors errors;
  double error_nn_m = 0;        ///< measured only if it is the target
  double bits_per_point = 0;    ///< of a file without attributes and metadata
  std::uint32_t encodings = 1;  ///< tried until this one was found
};

/// Encodes once.
Result<CompactTrial> try_steps(const CompactJob& job, const compact::Steps& steps,
                               std::uint32_t effort);

/// The steps that the search starts from.
compact::Steps usual_steps(const CompactJob& job);

/// Chooses the kind of field where both kinds may be best, by encoding with either.
Status choose_kind(CompactJob& job);

/// Whether `a` needs fewer bits than `b` would at the same error: by what a little less error is
/// usually worth at such a rate.
bool is_cheaper(const CompactTrial& a, const CompactTrial& b);

/// Where to begin, as CompactJob::start, after a quick encoding at the usual steps.
double start_after(const CompactTrial& quick, const CompactSettings& settings,
                   std::uint32_t effort);

/// The mean range error at which to look for the target first.
double first_error_guess(const CompactSettings& settings);

/// Encodes at the target: what is reached is at most the target's value, and more than 95 % of it
/// (97 % of bits). The search is a secant on logarithms, the same on every machine. Errors:
/// invalid_argument (the target is out of reach; says what would help).
Result<CompactTrial> search_target(const CompactJob& job);

}  // namespace curlidar
