// SPDX-License-Identifier: BSD-3-Clause
// The compact profile's field between the cells: what the surfaces of the nearest cells agree on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/ray_columns.hpp"
#include "compact/scan_decoder.hpp"
#include "curlidar/field.hpp"

namespace curlidar {

/// A direction takes the surfaces of the four cells around it, each moved by its cell's residual,
/// weighted by nearness. It needs no masks of its own: a direction is believed where coded cells
/// hold at least half of the weight and their surfaces agree to 0.3 m + 10 %. On a cell it has the
/// coded range less the range offset of the ring: that is an error of the sensor, drawn into a
/// surface it would be a rib.
///
/// Cells that are the sensor's own rays make no difference to who asks: rows are theirs, columns as
/// many as firings but evenly around the turn. Lines of sight start on the spin axis, at the height
/// of their row; ranges are lengths along them. Points go where the motion of the scan takes them.
class CompactField : public Field {
 public:
  explicit CompactField(compact::DecodedScan scan);

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double row, std::span<const double> columns, bool masked,
                    std::span<double> ranges) const override;
  void place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                 std::span<Vec3> points) const override;
  bool occupied(std::uint32_t row, std::uint32_t column) const override {
    return scan_.range[cell(row, column)] > 0;
  }
  std::size_t nearest_cell(double row, double column) const override;
  std::vector<Vec3> cell_points() const override;
  std::vector<std::int32_t> cell_patches() const override { return scan_.surface; }
  double ring_offset_m(std::uint32_t row) const override;
  double step_m() const override;
  RowLine row_line(double row) const override;
  const compact::DecodedScan& scan() const { return scan_; }
  bool moves() const override { return rays_ && !scan_.table.rays->motion.none(); }
  RigidMotion motion_at(double azimuth) const override;

 private:
  /// A cell and its weight.
  struct Corner {
    std::size_t cell = 0;
    double weight = 0;
  };

  using Corners = std::array<Corner, 4>;

  /// A fractional row between two of the lattice's.
  struct Between {
    std::uint32_t top = 0, bottom = 0;
    double down = 0;
  };

  std::size_t cell(std::uint32_t row, std::uint32_t column) const {
    return static_cast<std::size_t>(row) * lattice_.columns() + column;
  }
  Between between(double row) const;
  Corners corners_of(const Between& rows, double column) const;
  /// Height over the sensor's origin at which beams of a row cross the spin axis, metres.
  double height_at(const Between& rows) const;
  /// Where a line of sight of a row starts, beside the field's centre.
  compact::Origin origin_of(const Between& rows) const;
  double range_at(const Corners& corners, const compact::Sight& sight, bool masked) const;
  /// What the coded ranges of a row have added to the field's.
  std::int32_t offset(std::uint32_t row) const;
  /// Coded range without the offset of its ring, from the spin axis, metres.
  double calibrated(std::size_t cell) const;
  /// Range of a coded cell's surface along another line of sight, metres.
  double extend(std::size_t cell, const compact::Sight& sight) const;
  /// The nearest coded cell where no corner is one.
  std::uint32_t replacement(const Corners& corners) const;
  void find_corrections();
  void find_rays();

  compact::DecodedScan scan_;
  Lattice lattice_;
  std::vector<double> height_m_;          ///< of the rows; empty = all 0
  std::vector<double> level_;             ///< of rays: cosines of the rows' elevations
  std::vector<std::int32_t> correction_;  ///< coded range - its surface's, Q16, of each cell
  std::vector<std::uint32_t> nearest_;    ///< coded cell nearest to each cell
  std::optional<RayColumns> rays_;
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
