// SPDX-License-Identifier: BSD-3-Clause
// The compact profile's field between the cells: what the surfaces of the nearest cells agree on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "curlidar/field.hpp"

namespace curlidar {

/// A direction takes the surfaces of the four cells around it, each moved by its cell's residual,
/// weighted by nearness. It needs no masks of its own: a direction is believed where coded cells
/// hold at least half of the weight and their surfaces agree to 0.3 m + 10 %. On the lattice's rows
/// the range offset of the ring is added, so that every cell has exactly its coded range; between
/// them it would be an error of the sensor drawn into the surface.
class CompactField : public Field {
 public:
  explicit CompactField(compact::DecodedScan scan);

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double row, std::span<const double> columns, bool masked,
                    std::span<double> ranges) const override;
  double elevation(double row, double range) const override;
  bool one_elevation_a_row() const override { return height_m_.empty(); }
  bool occupied(std::uint32_t row, std::uint32_t column) const override {
    return scan_.range[cell(row, column)] > 0;
  }

 private:
  /// A cell and its weight.
  struct Corner {
    std::size_t cell = 0;
    double weight = 0;
  };

  std::size_t cell(std::uint32_t row, std::uint32_t column) const {
    return static_cast<std::size_t>(row) * lattice_.columns() + column;
  }
  double range_at(const std::array<Corner, 4>& corners, const compact::Direction& direction,
                  bool masked) const;
  std::int32_t offset(std::uint32_t row) const {
    return scan_.table.range_offset.empty() ? 0 : scan_.table.range_offset[row];
  }
  /// Coded range without the ring's offset, metres.
  double calibrated(std::size_t cell) const;
  /// Range of a coded cell's surface in another direction, metres.
  double extend(std::size_t cell, const compact::Direction& direction) const;

  compact::DecodedScan scan_;
  Lattice lattice_;
  std::vector<double> height_m_;          ///< of the rows; empty = all 0
  std::vector<std::int32_t> correction_;  ///< coded range - its surface's, Q16, of each cell
  std::vector<std::uint32_t> nearest_;    ///< coded cell nearest to each cell
};

/// The field of a file without one: nothing anywhere.
class EmptyField : public Field {
 public:
  EmptyField() : lattice_(Lattice::from_rings({0}, 4)) {}

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double row, std::span<const double> columns, bool masked,
                    std::span<double> ranges) const override;
  bool occupied(std::uint32_t, std::uint32_t) const override { return false; }

 private:
  Lattice lattice_;
};

}  // namespace curlidar
