// SPDX-License-Identifier: BSD-3-Clause
#include "map/plane_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curlidar::tile {
namespace {

/// Keeps slopes that hardly anything tells near zero.
constexpr double kRidge = 1e-3;

/// Solves a symmetric positive system in place by elimination; false if it is not.
template <std::size_t N>
bool solve(std::array<std::array<double, N + 1>, N>& a) {
  for (std::size_t r = 0; r < N; ++r) {
    if (!(a[r][r] > 1e-12)) return false;
    for (std::size_t k = r + 1; k < N; ++k) {
      const double factor = a[k][r] / a[r][r];
      for (std::size_t c = r; c <= N; ++c) a[k][c] -= factor * a[r][c];
    }
  }
  for (std::size_t r = N; r-- > 0;) {
    for (std::size_t k = r + 1; k < N; ++k) a[r][N] -= a[r][k] * a[k][N];
    a[r][N] /= a[r][r];
  }
  return true;
}

}  // namespace

FittedPlane plane_of_moments(const FitMoments& m) {
  std::array<std::array<double, 4>, 3> a = {{{m.w, m.u, m.v, m.h},
                                             {m.u, m.uu + kRidge * m.w, m.uv, m.hu},
                                             {m.v, m.uv, m.vv + kRidge * m.w, m.hv}}};
  if (!solve<3>(a)) return {m.w > 0 ? m.h / m.w : 0, 0, 0};
  return {a[0][3], a[1][3], a[2][3]};
}

double height_of_moments(const FitMoments& m, double rise_u, double rise_v) {
  return m.w > 0 ? (m.h - rise_u * m.u - rise_v * m.v) / m.w : 0;
}

FitMoments robust_moments(const CubeSamples& cube, std::uint32_t axis, double near,
                          std::uint32_t passes) {
  const std::vector<double>& us = cube.samples->at[u_axis(axis)];
  const std::vector<double>& vs = cube.samples->at[v_axis(axis)];
  const std::vector<double>& hs = cube.samples->at[axis];
  const double u0 = cube.centre[u_axis(axis)], v0 = cube.centre[v_axis(axis)];
  const double h0 = cube.centre[axis], scale = 1.0 / cube.half;
  FitMoments m;
  for (std::uint32_t pass = 0; pass <= passes; ++pass) {
    const FittedPlane plane = plane_of_moments(m);
    m = {};
    for (std::size_t i = cube.begin; i < cube.end; ++i) {
      const double u = (us[i] - u0) * scale, v = (vs[i] - v0) * scale, h = hs[i] - h0;
      double w = cube.samples->left[i];
      if (pass > 0) {
        const double off = std::abs(h - plane.height - plane.rise_u * u - plane.rise_v * v);
        if (off > near) w *= near / off;
      }
      m.add(w, u, v, h);
    }
  }
  return m;
}

FittedCurve robust_curve(const CubeSamples& cube, std::uint32_t axis, double near,
                         std::uint32_t passes) {
  const std::vector<double>& us = cube.samples->at[u_axis(axis)];
  const std::vector<double>& vs = cube.samples->at[v_axis(axis)];
  const std::vector<double>& hs = cube.samples->at[axis];
  const double u0 = cube.centre[u_axis(axis)], v0 = cube.centre[v_axis(axis)];
  const double h0 = cube.centre[axis], scale = 1.0 / cube.half;
  std::array<double, 6> found{};
  for (std::uint32_t pass = 0; pass <= passes; ++pass) {
    std::array<std::array<double, 7>, 6> a{};
    for (std::size_t i = cube.begin; i < cube.end; ++i) {
      const double u = (us[i] - u0) * scale, v = (vs[i] - v0) * scale, h = hs[i] - h0;
      const std::array<double, 6> f = {1, u, v, u * u, u * v, v * v};
      double w = cube.samples->left[i];
      if (pass > 0) {
        double off = h;
        for (std::size_t k = 0; k < 6; ++k) off -= found[k] * f[k];
        if (std::abs(off) > near) w *= near / std::abs(off);
      }
      for (std::size_t r = 0; r < 6; ++r) {
        for (std::size_t k = 0; k < 6; ++k) a[r][k] += w * f[r] * f[k];
        a[r][6] += w * f[r] * h;
      }
    }
    for (std::size_t r = 1; r < 6; ++r) a[r][r] += kRidge * a[0][0];
    if (!solve<6>(a)) return {};
    for (std::size_t k = 0; k < 6; ++k) found[k] = a[k][6];
  }
  return {{found[0], found[1], found[2]}, {found[3], found[4], found[5]}, true};
}

std::array<std::uint32_t, 3> axes_by_spread(const CubeSamples& cube) {
  std::array<double, 3> spread{};
  for (std::size_t k = 0; k < 3; ++k) {
    double w = 0, sum = 0, squares = 0;
    for (std::size_t i = cube.begin; i < cube.end; ++i) {
      const double h = cube.samples->at[k][i] - cube.centre[k], weight = cube.samples->left[i];
      w += weight;
      sum += weight * h;
      squares += weight * h * h;
    }
    spread[k] = squares - sum * sum / w;
  }
  std::array<std::uint32_t, 3> axes = {2, 0, 1};
  std::stable_sort(axes.begin(), axes.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return spread[a] < spread[b]; });
  return axes;
}

}  // namespace curlidar::tile
