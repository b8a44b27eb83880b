// SPDX-License-Identifier: BSD-3-Clause
// The paper's baseline (IV-B): one spherical-harmonics expansion of the whole scan.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "curlidar/field.hpp"
#include "paper/masks.hpp"
#include "paper/pipeline.hpp"

namespace curlidar {

struct GlobalModel {
  Lattice lattice;
  PaperSettings settings;  ///< max_range is the largest kept range, in metres
  CellMasks masks;
  std::vector<double> coefficients;  ///< (degree + 1)^2, in real_harmonics' order
};

/// Least squares over all samples. Cells of the lattice whose value is off by global_reject_m or
/// more lose their return. A scan covers a band of the sphere only, so that harmonics are dependent
/// on it; the slightest ridge (a share of 1e-12 of the mean square) makes the solution unique.
/// The grid makes the normal equations cheap: per row they are products of Legendre values and of
/// sums of cosines. O(rows * degree^4 + degree^6 / 3): 6 s for degree 64.
GlobalModel fit_global(const PaperStages& stages, const PaperSettings& settings,
                       std::size_t threads, const ProgressCallback& progress);

class GlobalField final : public Field {
 public:
  explicit GlobalField(GlobalModel model);

  const Lattice& lattice() const override { return model_.lattice; }
  void evaluate_row(double row, std::span<const double> columns, bool masked,
                    std::span<double> ranges) const override;
  bool occupied(std::uint32_t row, std::uint32_t column) const override {
    return model_.masks.point[model_.masks.index(row, column)] != 0;
  }

 private:
  GlobalModel model_;
  std::size_t degree_;
};

}  // namespace curlidar
