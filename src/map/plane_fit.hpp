// SPDX-License-Identifier: BSD-3-Clause
// Robust least squares of one coordinate by polynomials of the other two. Encoder only: + - * / and
// sqrt alone, the same on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "map/tile_samples.hpp"

namespace curlidar::tile {

/// Weighted moments of the samples of a cube about its centre, u and v in half edges, h in ticks.
struct FitMoments {
  double w = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, h = 0, hu = 0, hv = 0;

  void add(double weight, double at_u, double at_v, double height) {
    w += weight;
    u += weight * at_u;
    v += weight * at_v;
    uu += weight * at_u * at_u;
    uv += weight * at_u * at_v;
    vv += weight * at_v * at_v;
    h += weight * height;
    hu += weight * height * at_u;
    hv += weight * height * at_v;
  }
};

/// A height and its rises over half an edge, ticks.
struct FittedPlane {
  double height = 0, rise_u = 0, rise_v = 0;
};

/// The plane of least squares; slopes without evidence stay near zero.
FittedPlane plane_of_moments(const FitMoments& m);
/// Its height where the rises are given.
double height_of_moments(const FitMoments& m, double rise_u, double rise_v);

/// Samples [begin, end) about a centre.
struct CubeSamples {
  const TileSamples* samples = nullptr;
  std::size_t begin = 0, end = 0;
  Ticks3 centre{};
  std::int32_t half = 0;

  std::size_t size() const { return end - begin; }
};

/// Moments over `axis`, weighted as those who lie near the plane that they give: what lies farther
/// than `near` ticks counts inversely to its distance.
FitMoments robust_moments(const CubeSamples& cube, std::uint32_t axis, double near,
                          std::uint32_t passes);

/// Second-order terms (u^2, u v, v^2; ticks at half an edge) of what a plane leaves, and what they
/// add to it.
struct FittedCurve {
  FittedPlane plane;
  std::array<double, 3> rise{};
  bool good = false;
};
FittedCurve robust_curve(const CubeSamples& cube, std::uint32_t axis, double near,
                         std::uint32_t passes);

/// The axis along which the samples spread least, then the next.
std::array<std::uint32_t, 3> axes_by_spread(const CubeSamples& cube);

}  // namespace curlidar::tile
