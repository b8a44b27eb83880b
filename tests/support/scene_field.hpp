// SPDX-License-Identifier: BSD-3-Clause
// A field that knows the world exactly, for tests of what is made from fields.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "curlidar/reconstruct.hpp"
#include "curlidar/simulate.hpp"
#include "support/scans.hpp"

namespace curlidar::test {

/// Four walls, a floor and a ceiling around the sensor; on request a screen in front of the wall
/// ahead, 4 m away and 2 m wide, without thickness.
class BoxScene : public Scene {
 public:
  static constexpr double kHalfX = 8, kHalfY = 6, kFloor = -1.5, kCeiling = 2.5;
  static constexpr double kScreenX = 4, kScreenHalfY = 1;

  /// All lengths are `scale` times those above.
  explicit BoxScene(bool screen = false, double scale = 1) : screen_(screen), scale_(scale) {}

  bool cast(const Vec3& origin, const Vec3& direction, Hit& hit) const override {
    cast_unscaled(origin * (1 / scale_), direction, hit);
    hit.range_m *= scale_;
    return true;
  }

 private:
  void cast_unscaled(const Vec3& origin, const Vec3& direction, Hit& hit) const {
    hit = {1e300, 0.5, 0};
    wall(origin.x, direction.x, kHalfX, -kHalfX, hit);
    wall(origin.y, direction.y, kHalfY, -kHalfY, hit);
    wall(origin.z, direction.z, kCeiling, kFloor, hit);
    if (screen_ && direction.x > 0) {
      const double range = (kScreenX - origin.x) / direction.x;
      const double y = origin.y + range * direction.y;
      if (range > 0 && range < hit.range_m && std::abs(y) < kScreenHalfY) {
        hit.range_m = range;
        hit.cos_incidence = direction.x;
      }
    }
  }

  static void wall(double from, double along, double high, double low, Hit& hit) {
    if (along == 0) return;
    const double range = ((along > 0 ? high : low) - from) / along;
    if (range < hit.range_m) {
      hit.range_m = range;
      hit.cos_incidence = std::abs(along);
    }
  }

  bool screen_;
  double scale_;
};

/// A scene seen from the lattice of a sensor. Rows above or below the lattice are unknown.
class SceneField : public Field {
 public:
  SceneField(std::shared_ptr<const Scene> scene, const SensorProfile& sensor)
      : scene_(std::move(scene)),
        lattice_(Lattice::from_rings(sensor.elevations(), sensor.columns)) {}

  const Lattice& lattice() const override { return lattice_; }
  void evaluate_row(double row, std::span<const double> columns, bool,
                    std::span<double> ranges) const override {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      Hit hit;
      ranges[i] =
          scene_->cast({}, lattice_.direction(row, columns[i]), hit) ? hit.range_m : std::nan("");
    }
  }
  bool occupied(std::uint32_t, std::uint32_t) const override { return true; }
  void range_along(std::span<const Sightline> lines, std::span<RangeEstimate> estimates,
                   std::size_t) const override {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Vec3 d = lines[i].direction * (1 / norm(lines[i].direction));
      estimates[i] = {};
      const double row = lattice_.row_of(elevation_of(d));
      Hit hit;
      if (row < -0.5 || row > lattice_.rows() - 0.5) continue;
      if (!scene_->cast(lines[i].origin, d, hit)) continue;
      // Ahead is surer than behind.
      estimates[i] = {hit.range_m, d.x > 0 ? 0.9F : 0.3F, Seen::surface};
    }
  }

 private:
  std::shared_ptr<const Scene> scene_;
  Lattice lattice_;
};

/// A decoded scan with the field of a scene and the points of its cells.
inline DecodedScan exact_scan(std::shared_ptr<const Scene> scene, const SensorProfile& sensor) {
  DecodedScan scan;
  const auto field = std::make_shared<SceneField>(std::move(scene), sensor);
  scan.profile = Profile::paper;  // its own word is taken for what lies between the cells
  const Lattice& lattice = field->lattice();
  for (std::uint32_t row = 0; row < lattice.rows(); ++row) {
    for (double column = 0; column < lattice.columns(); ++column) {
      double range = 0;
      field->evaluate_row(row, std::span(&column, 1), true, std::span(&range, 1));
      scan.points.push_back(lattice.direction(row, column) * range);
    }
  }
  scan.coded_returns = scan.points.size();
  scan.field = field;
  return scan;
}

/// A compact file of a simulated scan, decoded.
inline DecodedScan compact_scan(const Scene& scene, const SensorProfile& sensor,
                                double range_noise_m = 0) {
  SimulateSettings how;
  how.range_noise_m = range_noise_m;
  how.dropout = 0;
  EncodeSettings settings;
  settings.sensor = sensor;
  settings.compact.effort = 1;
  return decode(encode(simulate(scene, sensor, how).value(), settings)->bytes).value();
}

}  // namespace curlidar::test
