// SPDX-License-Identifier: BSD-3-Clause
// How far a scan saw in every direction, in few bytes: enough to tell whether its beams went
// through a place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

/// What a scan says of a place.
enum class Sight : std::uint8_t {
  unknown,  ///< hidden behind something, between the beams, or out of the sensor's sight
  there,    ///< its returns lie about as far
  passed,   ///< its beams went on behind the place
};

/// Ranges on a lattice of even steps in the sine of the elevation, between the lowest and the
/// highest returns, and of the azimuth as |x| + |y| = 1 sees it: numbers from + - * / and square
/// roots alone, the same on every machine. A cell keeps its nearest return.
class SightImage {
 public:
  static constexpr std::uint32_t kRows = 64, kColumns = 1024;
  /// Of an image as bytes: 196 kB.
  static constexpr std::size_t kBytes = std::size_t{kRows} * kColumns * 3 + 16;

  /// Points in the sensor's frame; those that are no returns or lie within 5 cm are left out. About
  /// 20 ns a point.
  explicit SightImage(std::span<const Vec3> points);
  /// Of kBytes that `bytes` gave: never of strangers' bytes.
  explicit SightImage(std::span<const std::byte, kBytes> bytes);
  std::vector<std::byte> bytes() const;

  /// Of a place in the sensor's frame. It is passed if, in its column and the two beside it, the
  /// returns next above and next below it lie more than 3 % + .5 m farther, all but one of at least
  /// four; there if at least half of them are neither farther nor that much nearer. The ground is
  /// kept by the beam below: wherever it falls, that beam meets the ground before it. About .1 us.
  Sight of(const Vec3& place) const;

 private:
  std::size_t column_of(const Vec3& point) const;

  double low_ = 0;                      ///< sine of the elevation of the first row's lower edge
  double step_ = 0;                     ///< of a row; 0: no returns
  std::vector<std::uint16_t> range_;    ///< kRows x kColumns, in units of 2 cm; 0: no return
  std::vector<std::uint8_t> fraction_;  ///< how far up in its row the return lies, in 1/256
};

}  // namespace curlidar
