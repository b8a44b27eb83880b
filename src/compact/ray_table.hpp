// SPDX-License-Identifier: BSD-3-Clause
// The lattice of a spinning sensor's own rays: which ray belongs to a cell, and which point to a
// range along it. All integers: what decoder and encoder must agree on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curlidar::compact {

/// One laser. At encoder angle t it looks along azimuth t + azimuth_offset from an origin beside
/// the spin axis. With a = t + azimuth_offset and e the elevation of the row, the point at range r
/// along the ray is
///   u = (r + range_phase) cos e,
///   (u cos a - lateral sin a, u sin a + lateral cos a, (r + range_phase) sin e + height).
struct Ray {
  std::int32_t azimuth_offset = 0;  ///< binary angle
  std::int32_t height = 0;          ///< Q16 metres
  std::int32_t lateral = 0;         ///< Q16 metres, to the left
  std::int32_t range_phase = 0;     ///< Q16 metres

  friend bool operator==(const Ray&, const Ray&) = default;
};

/// What the vehicle's motion did to the points of a scan. A point at azimuth z (binary angle,
/// signed; s = z / 2^32 of a turn) of the sensor's own frame was moved to
///   R(rigid_turn) (R(s turn + s^2 turn2) p + s move + s^2 move2) + rigid_move,
/// with R(w) the rotation by |w| about w. All zero: not compensated.
struct Motion {
  using Triple = std::array<std::int32_t, 3>;
  Triple turn{}, move{};    ///< Q30 radians, Q16 metres, a turn
  Triple turn2{}, move2{};  ///< the same, a turn squared
  Triple rigid_turn{}, rigid_move{};

  bool none() const { return *this == Motion{}; }
  friend bool operator==(const Motion&, const Motion&) = default;
};

/// Column j of row k holds firing (j - column_shift(k)) mod firings, so that columns lie side by
/// side in space although lasers look to different azimuths at one firing.
struct RayTable {
  std::uint32_t slots = 0;  ///< encoder positions of a turn
  /// Positions at which lasers fired, strictly ascending, below `slots`. Position n is encoder
  /// angle 2^31 + floor(n 2^32 / slots), counter-clockwise.
  std::vector<std::uint32_t> firings;
  std::vector<Ray> rays;  ///< of each row
  Motion motion;

  /// If not 0, ranges are rounded to multiples of so many 2^-48 m before they become points.
  std::uint64_t range_unit_q48 = 0;

  /// Which frozen table (ray_tables.hpp) slots, elevations, rays and, if any, range unit are; 0 =
  /// none: then they are written out, angles and lengths of rays in units of 2^(their shifts).
  std::uint32_t table = 0;
  std::uint32_t azimuth_shift = 0, height_shift = 0, lateral_shift = 0, phase_shift = 0;
  /// The numbers of the motion are multiples of 2^(these): turns and moves.
  std::uint32_t turn_shift = 0, move_shift = 0;

  /// round(azimuth_offset * firings / 2^32), halves upwards, in (-firings, firings).
  std::int32_t column_shift(std::size_t row) const {
    const std::int64_t product =
        std::int64_t{rays[row].azimuth_offset} * static_cast<std::int64_t>(firings.size());
    return static_cast<std::int32_t>((product + (std::int64_t{1} << 31)) >> 32);
  }
  /// The firing of a cell.
  std::uint32_t firing_of(std::size_t row, std::uint32_t column) const {
    const auto n = static_cast<std::int64_t>(firings.size());
    return static_cast<std::uint32_t>((std::int64_t{column} - column_shift(row) + n) % n);
  }
  /// The azimuth along which a cell's ray looks, a binary angle.
  std::uint32_t azimuth_of(std::size_t row, std::uint32_t column) const {
    return encoder_angle(firings[firing_of(row, column)]) +
           static_cast<std::uint32_t>(rays[row].azimuth_offset);
  }
  std::uint32_t encoder_angle(std::uint32_t position) const {
    return static_cast<std::uint32_t>(0x80000000u + ((std::uint64_t{position} << 32) / slots));
  }

  friend bool operator==(const RayTable&, const RayTable&) = default;
};

/// Most encoder positions of a turn, so that firings are numbered in 22 bits.
inline constexpr std::uint32_t kMaxSlots = 1u << 22;
/// Of range_unit_q48: 15 um .. 256 m.
inline constexpr std::uint64_t kLeastRangeUnit = std::uint64_t{1} << 32;
inline constexpr std::uint64_t kMostRangeUnit = std::uint64_t{1} << 56;

}  // namespace curlidar::compact
