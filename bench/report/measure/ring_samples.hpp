// SPDX-License-Identifier: BSD-3-Clause
// What there is without any codec: ranges interpolated between the raw samples of a scan's rings.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar::bench {

/// How samples around a direction become one range.
enum class Mixing {
  linear,      ///< linear in inverse range
  edge_aware,  ///< the same, but the nearer sample alone where ranges differ by more than 20 %
};

/// Where lines of sight pass the spin axis, in the frame of their azimuth.
struct Viewpoint {
  double left_m = 0, up_m = 0;
};

/// The raw samples of a scan on their rings, as they are seen from a viewpoint: one that turns with
/// the direction, as a laser does. In a direction the two samples on either side count on
/// the ring above and on the ring below: first along each ring by azimuth, then across by
/// elevation. Samples more than 1.5 columns away in azimuth do not count; of two rings one must
/// have a sample, and where only one has, it must be the nearer one. Nothing lies beyond the
/// outermost rings.
class RingSamples {
 public:
  /// `ring_of_point[i]` is the ring of positions[i], in 0 .. elevations.size() - 1 from the top;
  /// others and slots without a return do not count. `elevations` (radians, descending) stand in
  /// for rings without a sample nearby; `columns` are those of a turn.
  RingSamples(std::span<const Vec3> positions, std::span<const std::uint16_t> ring_of_point,
              std::vector<double> elevations, std::uint32_t columns, const Viewpoint& from = {});

  /// What samples around a direction come to.
  struct Mixed {
    double range_m = 0;    ///< NaN where there is none
    double agreement = 0;  ///< nearer over farther range of the two rings; 0 if one has no sample
  };
  /// O(log rings * log samples).
  Mixed mix(const Vec3& direction, Mixing mixing) const;
  /// The range alone, metres.
  double range(const Vec3& direction, Mixing mixing) const {
    return mix(direction, mixing).range_m;
  }

 private:
  struct Sample {
    double azimuth = 0, elevation = 0, range_m = 0;
  };
  /// A ring seen at an azimuth: NaN range where it has no sample nearby.
  struct Seen {
    double elevation = 0, range_m = 0;
  };

  static std::optional<Sample> seen_from(const Viewpoint& from, const Vec3& p);
  Seen see(std::size_t ring, double azimuth, Mixing mixing) const;

  std::vector<std::vector<Sample>> rings_;  ///< by azimuth
  std::vector<double> elevations_;
  std::uint32_t columns_;
};

/// The mix of two ranges of which `b` weighs `weight` in [0, 1]; NaN ones do not count, and a
/// lone one must weigh at least half.
double mix_ranges(double a, double b, double weight, Mixing mixing);

}  // namespace curlidar::bench
