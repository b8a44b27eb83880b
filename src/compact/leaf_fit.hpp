// SPDX-License-Identifier: BSD-3-Clause
// Fits one layer of a leaf to returns. Encoder only: doubles, but only +, -, *, / and sqrt in a
// fixed order, which every compiler rounds alike; every decision is taken on the integer ranges
// that the decoder will see.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compact/field_syntax.hpp"

namespace curlidar::compact {

/// Returns, those of a block for one, with what every fit needs of them.
struct LeafSamples {
  std::vector<std::uint32_t> cells;
  std::vector<Sight> sights;
  std::vector<std::int64_t> ranges;                      ///< Q16
  std::vector<double> inverse;                           ///< 1 / r in 1/m
  std::vector<double> warped;                            ///< of predicted scans: 1 / guide's range
  std::vector<double> weights;                           ///< r^4 in metres
  std::vector<std::array<double, kMaxFunctions>> basis;  ///< B0..B5

  LeafSamples(const FieldState& state, const BlockContext& context, const PatchFrame& frame,
              const std::vector<std::int32_t>& truth, std::vector<std::uint32_t> of_cells);
  std::size_t size() const { return cells.size(); }
};

/// Least squares of some of a leaf's samples: sums once over the samples, then any parent and any
/// number of functions in constant time.
class LayerFit {
 public:
  /// `extra`: a further weight of each member; empty = all 1. The context, frame and samples must
  /// outlive the fit.
  LayerFit(const FieldState& state, const BlockContext& context, const PatchFrame& frame,
           const LeafSamples& samples, const std::vector<std::uint32_t>& members,
           const std::vector<double>& extra);

  /// The layer with `functions` (place in kFunctions) that fits the members best in the weighted
  /// square of range, its coefficients rounded one after the other to the lattice of steps (Babai's
  /// nearest plane). `parent` = 0: a new surface at the members' median range. nullopt where no
  /// such layer exists.
  std::optional<LayerCode> fit(std::uint32_t parent, std::uint32_t functions);

 private:
  using Vector = std::array<double, kMaxFunctions>;
  using Matrix = std::array<Vector, kMaxFunctions>;
  std::int64_t median_range();
  Vector in_basis(const Plane& plane) const;

  const FieldState& state_;
  const BlockContext& context_;
  const PatchFrame& frame_;
  const LeafSamples& samples_;
  const std::vector<std::uint32_t>& members_;
  Matrix gram_{};
  Vector moment_{};         ///< of the inverse range
  Vector warped_moment_{};  ///< of that of the guide
  std::optional<std::int64_t> median_;
};

}  // namespace curlidar::compact
