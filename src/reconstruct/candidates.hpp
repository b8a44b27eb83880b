// SPDX-License-Identifier: BSD-3-Clause
// Places within a quad of the sphere that may get a point, spread evenly over its surface.
#pragma once

#include <cstddef>
#include <optional>

#include "reconstruct/quads.hpp"
#include "reconstruct/view.hpp"

namespace curlidar {

/// Into how many candidates a quad is divided, and for how many points on a square metre.
struct Division {
  std::uint32_t down = 1, right = 1;
  double density = 0;
};

/// Candidates that each stand for less than a point: powers of two, so that those of neighbouring
/// quads fit together. None if directions cannot be told apart so finely.
std::optional<Division> division_of(const Quad& quad, const Sphere& sphere, double density);

/// Adds the points of a quad that the field confirms.
void sample_quad(const ScanView& view, const Sphere& sphere, const Quad& quad,
                 const Division& division, Samples& samples);

}  // namespace curlidar
