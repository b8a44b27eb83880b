// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-C2 and 3: least-squares harmonics of adaptive degree on one patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "field/patch_basis.hpp"
#include "paper/patches.hpp"

namespace curlidar {

/// The field of one patch. Without coefficients nothing is represented.
struct PatchFit {
  std::uint32_t degree = 0;          ///< the lowest degree that has this many functions
  std::vector<double> coefficients;  ///< of the patch's basis functions, each exact in float32
};

struct FitSettings {
  std::uint32_t max_degree = 100;
  double accept_m = 0.5;
  double k = 9;
  bool stop_on_total_error = true;  ///< without it no cell is held out for testing
};

/// Weight of the training error against the testing error at a degree (Eq. 5).
double training_weight(std::size_t degree, double k);

/// Fits the samples of a patch's window (0 = none), one per nominal cell of `basis`.
/// The degree rises from 1 until the mean training error is at most accept_m, or the total error
/// (Eq. 6) rises, which takes one step back; then all samples are fitted. There are never more
/// coefficients than samples (half as many where cells are held out), nor than the cells can tell
/// apart. A patch without samples of its own stays empty. Extends `basis` as needed.
PatchFit fit_patch(PatchBasis& basis, std::span<const double> ranges,
                   std::span<const CellRole> roles, const FitSettings& settings);

/// The fitted range at every nominal cell.
std::vector<double> fitted_ranges(const PatchBasis& basis, const PatchFit& fit);

}  // namespace curlidar
