// SPDX-License-Identifier: BSD-3-Clause
// A field of the samples that rings take of a world given by a formula.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "curlidar/field.hpp"

namespace curlidar::test {

/// Beams meet the spin axis at their heights; their origins lie `lateral_m` to the left of it.
struct TestRing {
  double elevation = 0, height_m = 0, lateral_m = 0;
};

/// Length of a ray to the first surface; NaN where there is none.
using World = std::function<double(const Vec3& origin, const Vec3& direction)>;

inline World plane(const Vec3& normal, double distance_m) {
  return [=](const Vec3& origin, const Vec3& direction) {
    const double across = dot(normal, direction);
    const double length = (distance_m - dot(normal, origin)) / across;
    return length > 0 ? length : std::numeric_limits<double>::quiet_NaN();
  };
}

class RingField final : public Field {
 public:
  RingField(std::vector<TestRing> rings, std::uint32_t columns, const World& world,
            double offset_m = 0)
      : rings_(std::move(rings)), lattice_(lattice_of(rings_, columns)), offset_m_(offset_m) {
    for (const TestRing& ring : rings_) {
      for (std::uint32_t column = 0; column < columns; ++column) {
        const double azimuth = lattice_.azimuth(column);
        const Vec3 origin{-ring.lateral_m * std::sin(azimuth), ring.lateral_m * std::cos(azimuth),
                          ring.height_m};
        const Vec3 direction = direction_of(ring.elevation, azimuth);
        points_.push_back(origin + direction * world(origin, direction));
      }
    }
  }

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double row, std::span<const double> columns, bool,
                    std::span<double> ranges) const override {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Vec3& p = points_[nearest_cell(row, columns[i])];
      ranges[i] = row_line(row).range_of(std::hypot(p.x, p.y), p.z);
    }
  }
  void place_row(double row, std::span<const double> columns, std::span<const double> ranges,
                 std::span<Vec3> points) const override {
    const RowLine line = row_line(row);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Vec3 along = direction_of(line.elevation, lattice_.azimuth(columns[i])) * ranges[i];
      points[i] = motion_(along + Vec3{0, 0, line.height_m});
    }
  }
  bool occupied(std::uint32_t row, std::uint32_t column) const override {
    return !std::isnan(points_[cell(row, column)].x);
  }
  std::vector<Vec3> cell_points() const override { return points_; }
  double ring_offset_m(std::uint32_t) const override { return offset_m_; }
  RowLine row_line(double row) const override {
    const double at = std::clamp(row, 0.0, static_cast<double>(rings_.size() - 1));
    const auto upper = static_cast<std::size_t>(at);
    const std::size_t lower = std::min(upper + 1, rings_.size() - 1);
    const double down = at - static_cast<double>(upper);
    return {lattice_.elevation(row),
            rings_[upper].height_m + (rings_[lower].height_m - rings_[upper].height_m) * down};
  }
  bool moves() const override { return moves_; }
  RigidMotion motion_at(double) const override { return motion_; }

  void clear(std::uint32_t row, std::uint32_t column) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    points_[cell(row, column)] = {kNan, kNan, kNan};
  }
  void move(const RigidMotion& motion) {
    motion_ = motion;
    moves_ = true;
  }
  const Vec3& point(std::uint32_t row, std::uint32_t column) const {
    return points_[cell(row, column)];
  }

 private:
  static Lattice lattice_of(const std::vector<TestRing>& rings, std::uint32_t columns) {
    std::vector<double> elevations;
    for (const TestRing& ring : rings) elevations.push_back(ring.elevation);
    return Lattice::from_rings(std::move(elevations), columns);
  }
  std::size_t cell(std::uint32_t row, std::uint32_t column) const {
    return std::size_t{row} * lattice_.columns() + column;
  }

  std::vector<TestRing> rings_;
  Lattice lattice_;
  double offset_m_ = 0;
  std::vector<Vec3> points_;
  RigidMotion motion_;
  bool moves_ = false;
};

}  // namespace curlidar::test
