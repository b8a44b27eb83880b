// SPDX-License-Identifier: BSD-3-Clause
#include "paper/patches.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar {

PatchGrid::PatchGrid(const Lattice& lattice, std::uint32_t row_factor, std::uint32_t column_factor,
                     std::uint32_t patch, std::uint32_t overlap)
    : lattice_(lattice),
      row_factor_(row_factor),
      column_factor_(column_factor),
      patch_(patch),
      overlap_(overlap),
      dense_rows_(lattice.rows() * row_factor),
      dense_columns_(lattice.columns() * column_factor),
      patch_rows_((lattice.rows() + patch - 1) / patch),
      patch_columns_((lattice.columns() + patch - 1) / patch) {}

CellRect PatchGrid::core(std::size_t patch_row, std::size_t patch_column) const {
  const std::int64_t height = std::int64_t{patch_} * row_factor_;
  const std::int64_t width = std::int64_t{patch_} * column_factor_;
  CellRect rect;
  rect.row_begin = static_cast<std::int64_t>(patch_row) * height;
  rect.row_end = std::min<std::int64_t>(rect.row_begin + height, dense_rows_);
  rect.column_begin = static_cast<std::int64_t>(patch_column) * width;
  rect.column_end = std::min<std::int64_t>(rect.column_begin + width, dense_columns_);
  return rect;
}

CellRect PatchGrid::window(std::size_t patch_row, std::size_t patch_column) const {
  CellRect rect = core(patch_row, patch_column);
  rect.row_begin = std::max<std::int64_t>(rect.row_begin - overlap_, 0);
  rect.row_end = std::min<std::int64_t>(rect.row_end + overlap_, dense_rows_);
  const auto spare =
      static_cast<std::int64_t>(dense_columns_) - static_cast<std::int64_t>(rect.width());
  const std::int64_t side = std::min<std::int64_t>(overlap_, spare / 2);
  rect.column_begin -= side;
  rect.column_end += side;
  return rect;
}

std::uint64_t PatchGrid::basis_work() const {
  const std::uint64_t cells = window(patch_rows_ / 2, 0).cells();
  const std::uint64_t functions = std::min<std::uint64_t>(cells, kMaxPatchFunctions);
  return patch_rows_ * cells * functions * functions;
}

std::vector<CellRole> PatchGrid::roles(std::size_t patch_row, std::size_t patch_column) const {
  const CellRect own = core(patch_row, patch_column);
  const CellRect all = window(patch_row, patch_column);
  const auto last = static_cast<std::int64_t>(own.width()) - 1;
  std::vector<CellRole> roles;
  roles.reserve(all.cells());
  for (std::int64_t row = all.row_begin; row < all.row_end; ++row) {
    for (std::int64_t column = all.column_begin; column < all.column_end; ++column) {
      const std::int64_t r = row - own.row_begin, c = column - own.column_begin;
      const bool in_core = r >= 0 && row < own.row_end && c >= 0 && column < own.column_end;
      const bool on_diagonal = r % 2 == 0 && (c == r || c == last - r);
      roles.push_back(!in_core      ? CellRole::extended
                      : on_diagonal ? CellRole::testing
                                    : CellRole::training);
    }
  }
  return roles;
}

std::size_t PatchGrid::patch_row_at(double row) const {
  const double dense = std::round(row * row_factor_ + (row_factor_ - 1));
  const double patch = std::floor(dense / (static_cast<double>(patch_) * row_factor_));
  return static_cast<std::size_t>(std::clamp(patch, 0.0, static_cast<double>(patch_rows_ - 1)));
}

std::size_t PatchGrid::patch_column_at(double column) const {
  double dense = std::round(column * column_factor_);
  dense -= std::floor(dense / dense_columns_) * dense_columns_;
  const double patch = std::floor(dense / (static_cast<double>(patch_) * column_factor_));
  return static_cast<std::size_t>(std::clamp(patch, 0.0, static_cast<double>(patch_columns_ - 1)));
}

double PatchGrid::lattice_row(double dense_row) const {
  return (dense_row - (row_factor_ - 1)) / row_factor_;
}

double PatchGrid::centre_elevation(std::size_t patch_row) const {
  const CellRect rect = core(patch_row, 0);
  return lattice_.elevation(
      lattice_row(0.5 * static_cast<double>(rect.row_begin + rect.row_end - 1)));
}

double PatchGrid::centre_azimuth(std::size_t patch_column) const {
  const CellRect rect = core(0, patch_column);
  return lattice_.azimuth(0.5 * static_cast<double>(rect.column_begin + rect.column_end - 1) /
                          column_factor_);
}

PatchBasis PatchGrid::make_basis(std::size_t patch_row, std::size_t patch_column) const {
  const CellRect all = window(patch_row, patch_column);
  const CellRect own = core(patch_row, patch_column);
  const LocalFrame local_frame = frame(patch_row);
  const double middle = 0.5 * static_cast<double>(own.column_begin + own.column_end - 1);
  const double column_angle = lattice_.azimuth(1.0 / column_factor_) - lattice_.azimuth(0);
  std::vector<LocalDirection> cells;
  cells.reserve(all.cells());
  for (std::int64_t row = all.row_begin; row < all.row_end; ++row) {
    const AngleParts elevation =
        AngleParts::of(lattice_.elevation(lattice_row(static_cast<double>(row))));
    for (std::int64_t column = all.column_begin; column < all.column_end; ++column) {
      const double azimuth = (static_cast<double>(column) - middle) * column_angle;
      cells.push_back(local_frame.local(elevation, AngleParts::of(azimuth / 2)));
    }
  }
  return PatchBasis(std::move(cells));
}

}  // namespace curlidar
