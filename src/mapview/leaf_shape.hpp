// SPDX-License-Identifier: BSD-3-Clause
// The surface of one leaf as rays and points meet it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/bvh.hpp"
#include "curlidar/map_tile.hpp"

namespace curlidar {

/// Coordinates as a leaf sees them: along u, v and its axis.
using LeafFrame = std::array<double, 3>;

inline LeafFrame in_leaf_frame(std::uint8_t axis, const Vec3& p) {
  if (axis == 0) return {p.y, p.z, p.x};
  if (axis == 1) return {p.z, p.x, p.y};
  return {p.x, p.y, p.z};
}
inline Vec3 out_of_leaf_frame(std::uint8_t axis, const LeafFrame& p) {
  if (axis == 0) return {p[2], p[0], p[1]};
  if (axis == 1) return {p[1], p[2], p[0]};
  return {p[0], p[1], p[2]};
}

/// Where a ray first meets a leaf; infinite where it does not.
struct LeafCrossing {
  double surface;  ///< under the footprint
  double margin;   ///< beside it, within the gap
};

/// A leaf of a tile moved by `shift`; refers to the tile's footprint.
class LeafShape {
 public:
  /// The footprint must lie within the tile's.
  LeafShape(const MapTile& tile, const MapLeaf& leaf, const Vec3& shift, double gap_cells);

  /// Around all that counts of the surface and its margin; nothing if there is none.
  std::optional<Bounds> bounds() const;
  LeafCrossing cross(const Vec3& origin, const Vec3& direction, double t_max) const;
  /// A unit vector; either way.
  Vec3 normal(const Vec3& point) const;
  /// From the point to what counts of the surface, if that is less than `reach`; else `reach`.
  double distance(const Vec3& point, double reach) const;

  double cell_m() const { return cell_m_; }
  float intensity() const { return intensity_; }

 private:
  /// One cell of the footprint, as a rectangle of u and v.
  struct Cell {
    double u0, u1, v0, v1;
  };
  /// Of a coordinate along u or v; the first or last one outside of the cube.
  std::int64_t cell_of(double x) const;
  bool seen(std::int64_t i, std::int64_t j) const;
  bool near_footprint(double u, double v) const;
  double height(double u, double v) const;
  std::array<double, 2> slope(double u, double v) const;
  double cell_distance(const Cell& cell, const LeafFrame& point) const;

  LeafFrame centre_;  ///< of the cube
  double half_m_, cell_m_, gap_m_;
  double height_m_;  ///< from the centre
  std::array<double, 2> slope_;
  std::array<double, 3> curve_;
  const std::uint8_t* footprint_;
  std::int64_t cells_;
  float intensity_;
  std::uint8_t axis_;
  bool curved_;
};

}  // namespace curlidar
