// SPDX-License-Identifier: BSD-3-Clause
#include "paper/patch_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace curlidar {

PatchField::PatchField(const PaperModel& model)
    : lattice_(model.lattice),
      grid_(model.lattice, model.settings.upsample_rows, model.settings.upsample_columns,
            model.settings.patch, model.settings.overlap),
      masks_(model.masks),
      range_begin_m_(model.settings.min_range_m - model.settings.reject_m),
      range_end_m_(model.settings.max_range.metres + model.settings.reject_m) {
  begin_.reserve(grid_.count() + 1);
  begin_.push_back(0);
  for (std::size_t patch_row = 0; patch_row < grid_.rows(); ++patch_row) {
    PatchBasis basis = grid_.make_basis(patch_row, 0);
    for (std::size_t patch_column = 0; patch_column < grid_.columns(); ++patch_column) {
      const PatchFit& fit = model.patches[begin_.size() - 1];
      if (!fit.coefficients.empty()) {
        if (grid_.window(patch_row, patch_column).cells() != basis.cells()) {
          basis = grid_.make_basis(patch_row, patch_column);
        }
        const std::size_t degree = basis.degree_with(fit.coefficients.size());
        const std::size_t usable = std::min(fit.coefficients.size(), basis.functions(degree));
        const std::vector<double> local =
            basis.to_local(std::span(fit.coefficients).first(usable), degree);
        coefficients_.insert(coefficients_.end(), local.begin(), local.end());
      }
      begin_.push_back(coefficients_.size());
    }
  }
}

void PatchField::evaluate_row(double row, std::span<const double> columns, bool masked,
                              std::span<double> ranges) const {
  const std::size_t patch_row = grid_.patch_row_at(is_index(row) ? row : 0);
  const LocalFrame frame = grid_.frame(patch_row);
  const AngleParts elevation = AngleParts::of(lattice_.elevation(row));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    ranges[i] = std::numeric_limits<double>::quiet_NaN();
    if (!is_index(row) || !is_index(columns[i])) continue;
    if (masked && !believed(masks_, CellPosition::of(row, columns[i]))) continue;
    const std::size_t patch_column = grid_.patch_column_at(columns[i]);
    const std::size_t patch = patch_row * grid_.columns() + patch_column;
    const std::span<const double> local(coefficients_.data() + begin_[patch],
                                        begin_[patch + 1] - begin_[patch]);
    if (local.empty()) continue;
    const double azimuth = std::remainder(
        lattice_.azimuth(columns[i]) - grid_.centre_azimuth(patch_column), 2 * std::numbers::pi);
    const double range = evaluate_local(local, frame.local(elevation, AngleParts::of(azimuth / 2)));
    if (range > 0 && range >= range_begin_m_ && range <= range_end_m_) ranges[i] = range;
  }
}

}  // namespace curlidar
