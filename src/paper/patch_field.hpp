// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-D: continuous reconstruction from patches and masks.
#pragma once

#include <vector>

#include "curlidar/field.hpp"
#include "paper/pipeline.hpp"

namespace curlidar {

class PatchField final : public Field {
 public:
  /// The model's settings and sizes must have been validated.
  explicit PatchField(const PaperModel& model);

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double row, std::span<const double> columns, bool masked,
                    std::span<double> ranges) const override;
  bool occupied(std::uint32_t row, std::uint32_t column) const override {
    return masks_.point[masks_.index(row, column)] != 0;
  }

 private:
  Lattice lattice_;
  PatchGrid grid_;
  CellMasks masks_;
  double range_begin_m_, range_end_m_;  ///< fits that leave these limits represent nothing
  std::vector<std::size_t> begin_;      ///< of each patch in coefficients_, and the end
  std::vector<double> coefficients_;    ///< of local polynomials, patch after patch
};

}  // namespace curlidar
