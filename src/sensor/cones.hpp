// SPDX-License-Identifier: BSD-3-Clause
// A beam that turns about the spin axis sweeps a cone. These helpers tell whether groups of returns
// are such cones, and order them.
#pragma once

#include <cstdint>
#include <vector>

#include "sensor/returns.hpp"

namespace curlidar {

inline constexpr std::uint16_t kNoLabel = 0xffff;

/// A guess at which returns belong together: a label below `count`, or kNoLabel, for each return.
struct Labels {
  std::vector<std::uint16_t> of_return;
  std::size_t count = 0;
};

/// The returns with one label.
struct Cone {
  std::size_t label = 0;
  std::size_t returns = 0;            ///< 0: nothing below is set
  std::vector<std::uint32_t> sample;  ///< at most 256 of the returns, far ones if there are any
  double elevation = 0;               ///< median of the sample, seen from the sensor's origin
  double spread = 0;                  ///< median angle between the sample and the cone fitted to it
  double tail = 0;                    ///< 90th percentile of the same angle
};

/// One cone for every label. O(n).
std::vector<Cone> fit_cones(const Returns& returns, const Labels& labels);

/// Whether the labels are rings: each holds one cone, thin against the gaps between them.
bool are_rings(const std::vector<Cone>& cones);

/// The cones from top to bottom. Where labels run up or down the rings, their order is kept and
/// cones without returns keep their place; otherwise those are left out.
std::vector<Cone> top_to_bottom(std::vector<Cone> cones);

/// Elevations of cones in order: places of empty ones filled in, strictly descending.
std::vector<double> elevations_of(const std::vector<Cone>& cones);

/// The nearest (least squares) strictly descending sequence, inside +-90 degrees.
void make_strictly_descending(std::vector<double>& values);

}  // namespace curlidar
