// SPDX-License-Identifier: BSD-3-Clause
#include "compact/surface.hpp"

#include <algorithm>

namespace curlidar::compact {
namespace {

constexpr std::int64_t kMaxPlane = std::int64_t{1} << 38;
constexpr std::int64_t kMaxCurve = std::int64_t{1} << 36;
constexpr std::int64_t kMaxFunction = std::int64_t{1} << 23;

std::int64_t clamp_to(std::int64_t x, std::int64_t limit) {
  return std::clamp(x, -limit, limit);
}

/// floor(2^(30 + bits / 2) / sqrt(x)) for x in Q(bits), bits even; 0 for x <= 0.
std::int64_t inverse_root(std::int64_t x, unsigned bits) {
  if (x <= 0) return 0;
  const auto root = static_cast<std::int64_t>(isqrt(static_cast<std::uint64_t>(x)));
  return (std::int64_t{1} << (30 + bits / 2)) / root;
}

std::int64_t dot(const Axis& a, const Direction& d) {
  return (a.x * d.x + a.y * d.y + a.z * d.z) >> 22;
}

void add_axis(Plane& plane, std::int64_t scale, const Axis& axis) {
  plane.x = clamp_to(plane.x + mul_shift(scale, axis.x, 30), kMaxPlane);
  plane.y = clamp_to(plane.y + mul_shift(scale, axis.y, 30), kMaxPlane);
  plane.z = clamp_to(plane.z + mul_shift(scale, axis.z, 30), kMaxPlane);
}

/// Scale of a coordinate: 1 / root of the mean square (Q56), in Q14.
std::int64_t scale_of(std::int64_t mean_square_q56) {
  if (mean_square_q56 <= 0) return 0;
  const auto root = static_cast<std::int64_t>(isqrt(static_cast<std::uint64_t>(mean_square_q56)));
  if (root == 0) return 0;
  return std::min((std::int64_t{1} << 42) / root, std::int64_t{1} << 32);
}

}  // namespace

PatchShape make_shape(const Geometry& geometry, const Block& block) {
  PatchShape shape;
  const std::int64_t h = block.height, w = block.width, n = h * w;
  const std::int32_t* elevations = geometry.elevations().data() + block.row;
  std::int64_t sum = 0;
  for (std::int64_t i = 0; i < h; ++i) sum += elevations[i];
  const std::int64_t middle = div_floor(sum, h);
  shape.elevation = sin_cos_q30(static_cast<std::uint32_t>(middle));
  shape.norm = inverse_root(n << 20, 20);

  // Along the row: u = cos(e) sin(a) at evenly spaced azimuths; its mean square in Q56.
  std::int64_t mean_uu = 0;
  for (std::int64_t j = 0; j < w; ++j) {
    const std::int64_t doubled = 2 * j - (w - 1);
    const auto angle = static_cast<std::uint32_t>(
        div_floor(doubled * (std::int64_t{1} << 31), geometry.turn_columns()));
    const std::int64_t u =
        (static_cast<std::int64_t>(shape.elevation.cos) * sin_cos_q30(angle).sin) >> 32;
    mean_uu += u * u;
  }
  mean_uu /= w;
  shape.scale_u = scale_of(mean_uu);

  // Up: v = sin(e - middle); mean square, and the moments of v / rms in Q20.
  std::int64_t mean_vv = 0;
  for (std::int64_t i = 0; i < h; ++i) {
    const std::int64_t v = sin_cos_q30(static_cast<std::uint32_t>(elevations[i] - middle)).sin >> 2;
    mean_vv += v * v / h;
  }
  shape.scale_v = scale_of(mean_vv);

  if (w > 2 && shape.scale_u > 0)
    shape.norm_uu = inverse_root(n * 4 * (w * w - 4) * (1 << 20) / (5 * (w * w - 1)), 20);
  if (h > 2 && shape.scale_v > 0) {
    std::int64_t cubes = 0, fourths = 0;
    for (std::int64_t i = 0; i < h; ++i) {
      const std::int64_t v = sin_cos_q30(static_cast<std::uint32_t>(elevations[i] - middle)).sin;
      const std::int64_t scaled = clamp_to((v * shape.scale_v) >> 24, kMaxFunction);
      const std::int64_t square = (scaled * scaled) >> 20;
      cubes += (square * scaled) >> 20;
      fourths += (square * square) >> 20;
    }
    shape.skew_v = div_floor(cubes, h);
    const std::int64_t variance =
        div_floor(fourths, h) - (1 << 20) - ((shape.skew_v * shape.skew_v) >> 20);
    if (variance > (1 << 14)) shape.norm_vv = inverse_root(n * variance, 20);
  }
  return shape;
}

PatchFrame::PatchFrame(const Geometry& geometry, const PatchShape& patch_shape, const Block& block)
    : shape(patch_shape) {
  const SinCos a = sin_cos_q30(geometry.azimuth_of_sum(2 * block.column + block.width - 1));
  const std::int64_t sin_e = shape.elevation.sin, cos_e = shape.elevation.cos;
  c = {(cos_e * a.cos) >> 30, (cos_e * a.sin) >> 30, sin_e};
  u = {-a.sin, a.cos, 0};
  v = {(-sin_e * a.cos) >> 30, (-sin_e * a.sin) >> 30, cos_e};
}

std::array<std::int64_t, 3> PatchFrame::quadratic(const Direction& d) const {
  constexpr std::int64_t one = 1 << 20;
  const std::int64_t x = clamp_to((dot(u, d) * shape.scale_u) >> 24, kMaxFunction);
  const std::int64_t y = clamp_to((dot(v, d) * shape.scale_v) >> 24, kMaxFunction);
  const std::int64_t xx = ((x * x) >> 20) - one;
  const std::int64_t xy = (x * y) >> 20;
  const std::int64_t yy = ((y * y) >> 20) - one - ((shape.skew_v * y) >> 20);
  const auto scaled = [](std::int64_t value, std::int64_t norm) {
    return clamp_to(mul_shift(value, norm, 30), kMaxFunction);
  };
  return {scaled(xx, shape.norm_uu), scaled(xy, shape.norm), scaled(yy, shape.norm_vv)};
}

Plane facing_plane(const PatchFrame& frame, std::int64_t range) {
  Plane plane;
  add_axis(plane, (std::int64_t{1} << 46) / std::clamp(range, kMinRange, kMaxRange), frame.c);
  return plane;
}

std::int64_t coefficient_step(std::int64_t inverse, std::int32_t step) {
  const std::int64_t square = mul_shift(inverse, inverse, 30);
  return std::max<std::int64_t>(mul_shift(square, step, 6), 1);
}

Surface on_plane_of(const Surface& warped, const Plane& plane) {
  Surface out = warped;
  const auto sum = [](std::int64_t a, std::int64_t b) { return clamp_to(a + b, kMaxPlane); };
  out.plane = {sum(plane.x, warped.added.x), sum(plane.y, warped.added.y),
               sum(plane.z, warped.added.z)};
  out.warped = false;
  return out;
}

Surface add_functions(const Plane& base, const PatchFrame& frame, std::int64_t step_q40,
                      const Quantised& q, std::uint32_t functions) {
  Surface surface{base, {}, false};
  const auto amount = [&](std::uint32_t k) { return mul_shift(q[k], step_q40, 0); };
  const std::int64_t norm = frame.shape.norm;
  if (functions > 0 && q[0] != 0) {
    add_axis(surface.plane, clamp_to(mul_shift(amount(0), norm, 40), kMaxPlane), frame.c);
  }
  // B1 = (u / rms u) / sqrt(cells): Q40 * Q30 -> Q40, then * Q14 -> Q30.
  if (functions > 1 && q[1] != 0) {
    const std::int64_t scaled = mul_shift(mul_shift(amount(1), norm, 30), frame.shape.scale_u, 24);
    add_axis(surface.plane, clamp_to(scaled, kMaxPlane), frame.u);
  }
  if (functions > 2 && q[2] != 0) {
    const std::int64_t scaled = mul_shift(mul_shift(amount(2), norm, 30), frame.shape.scale_v, 24);
    add_axis(surface.plane, clamp_to(scaled, kMaxPlane), frame.v);
  }
  for (std::uint32_t k = 3; k < functions; ++k) {
    surface.quadratic[k - 3] = clamp_to(mul_shift(amount(k), 1, 10), kMaxCurve);
    surface.curved |= surface.quadratic[k - 3] != 0;
  }
  return surface;
}

}  // namespace curlidar::compact
