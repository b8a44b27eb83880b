// SPDX-License-Identifier: BSD-3-Clause
// From what rings say around a line of sight to one surface on it.
#pragma once

#include <cstdint>

#include "curlidar/field.hpp"
#include "dense/look.hpp"

namespace curlidar {

enum class DenseMode : std::uint8_t {
  none,        ///< neither ring saw anything near
  smooth,      ///< both rings saw one surface
  planar,      ///< far apart, but on one plane with a ring beyond
  jump_below,  ///< two surfaces: that of the ring below
  jump_above,  ///< that of the ring above
  only_below,  ///< one ring alone saw something
  only_above,
};

/// What the rules make of a look.
struct Guess {
  DenseMode mode = DenseMode::none;
  double r = 0;            ///< along the line of sight, metres; 0: nothing to guess from
  double above_share = 0;  ///< how much of it the ring above says, 0 .. 1
  Seen seen = Seen::unknown;
  double doubt = 1;  ///< probability that it is grossly wrong, or nothing is there

  bool jump() const { return mode == DenseMode::jump_below || mode == DenseMode::jump_above; }
};

/// The surface along the line of `look`.
Guess decide(const RingPoints& points, const Look& look);

}  // namespace curlidar
