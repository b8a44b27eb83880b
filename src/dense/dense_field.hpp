// SPDX-License-Identifier: BSD-3-Clause
// A field that knows what lies between its cells.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "curlidar/dense.hpp"
#include "dense/features.hpp"
#include "dense/look.hpp"
#include "dense/motion_table.hpp"
#include "dense/ring_points.hpp"
#include "dense/row_rules.hpp"
#include "dense/rules.hpp"

namespace curlidar {

class DenseField final : public Field {
 public:
  /// `field` is not null.
  DenseField(std::shared_ptr<const Field> field, const DenseSettings& settings);
  // The rules of rows refer to the points of this one.
  DenseField(const DenseField&) = delete;
  DenseField& operator=(const DenseField&) = delete;

  const Lattice& lattice() const override { return field_->lattice(); }
  void evaluate_row(double row, std::span<const double> columns, bool masked,
                    std::span<double> ranges) const override;
  void place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                 std::span<Vec3> points) const override {
    field_->place_row(row, columns, ranges, points);
  }
  bool occupied(std::uint32_t row, std::uint32_t column) const override {
    return field_->occupied(row, column);
  }
  void range_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                   std::size_t threads = 1) const override;
  void surfaces_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                      std::size_t threads = 1) const override;
  Sources sources_at(const Vec3& point) const override;
  std::size_t nearest_cell(double row, double column) const override {
    return field_->nearest_cell(row, column);
  }
  std::vector<Vec3> cell_points() const override { return field_->cell_points(); }
  std::vector<std::int32_t> cell_patches() const override { return field_->cell_patches(); }
  double ring_offset_m(std::uint32_t row) const override { return field_->ring_offset_m(row); }
  double step_m() const override { return field_->step_m(); }
  RowLine row_line(double row) const override { return field_->row_line(row); }
  bool moves() const override { return field_->moves(); }
  RigidMotion motion_at(double azimuth) const override { return field_->motion_at(azimuth); }

  /// What was found along a line of sight.
  struct Found {
    Look look;
    Guess guess;
  };
  /// What is made of it where a profile has a say.
  struct Verdict {
    Guess guess;
    double returns = 1;              ///< probability of a return, as far as the profile tells
    std::optional<std::size_t> row;  ///< the line is that of this row, which measured `guess`
  };

  // What an estimate comes from, for those who teach confidence.

  /// Along a line of the cloud's frame, of unit length.
  Found find(const Sightline& line) const;
  Verdict judge(const Found& found) const;
  /// What a given row measures where the rules say so, if the line at this elevation is its.
  Verdict as_given(Verdict rules, double elevation, const Found& found) const;
  PlainFeatures features(const Found& found) const;
  /// Those of a row of the profile, which has rows.
  RowFeatures features(const Found& found, std::size_t row) const;

 private:
  Found find_in_plane(const PlaneLine& line) const;
  /// A line of the cloud's frame as the sensor's own frame has it at an azimuth.
  Sightline own_line(const Sightline& line, double azimuth) const;
  /// Azimuth in the own frame of the place at a range of a line, from one that is near to it.
  double azimuth_at(const Sightline& line, double range_m, double azimuth) const;
  RangeEstimate estimate(const Sightline& line, bool confident) const;
  void estimate_all(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                    bool confident, std::size_t threads) const;
  float confidence_of(const Found& found, const Verdict& verdict) const;
  /// Where the line of a row, turned to a column, meets what is believed or, not `masked`, guessed;
  /// as a range of the row; else NaN.
  double along_row(const RowLine& row, PlaneLine line, double column, bool masked) const;

  std::shared_ptr<const Field> field_;
  RingPoints points_;
  MotionTable motion_;
  ScanErrors errors_;
  std::shared_ptr<const DensityProfile> profile_;  ///< null if it does not fit
  std::optional<RowRules> rows_;                   ///< where it has rows
  bool rows_of_profile_ = false;
};

}  // namespace curlidar
