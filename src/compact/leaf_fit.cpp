// SPDX-License-Identifier: BSD-3-Clause
#include "compact/leaf_fit.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar::compact {
namespace {

constexpr double kQ20 = 1.0 / (1 << 20);
constexpr double kQ30 = 1.0 / (1 << 30);
constexpr double kQ40 = kQ20 * kQ20;

/// What a plane is linear in: it meets o + r d where n . (d + o / r) = 1 / r.
Direction apparent(const Sight& sight, std::int64_t range) {
  constexpr std::int64_t kMost = 1 << 24;
  const auto q22 = [&](std::int32_t along, std::int32_t beside) {
    return along + static_cast<std::int32_t>(
                       std::clamp((std::int64_t{beside} << 22) / range, -kMost, kMost));
  };
  const auto& [d, o] = sight;
  return {q22(d.x, o.x), q22(d.y, o.y), q22(d.z, o.z)};
}

/// B0..B2 at a direction as seen from the field's centre, B3..B5 at that of the cell, as
/// add_functions scales them.
std::array<double, kMaxFunctions> basis_at(const PatchFrame& frame, const Direction& d,
                                           const Direction& of_cell) {
  const auto dot = [&](const Axis& a) {
    return static_cast<double>((a.x * d.x + a.y * d.y + a.z * d.z) >> 22) * kQ30;
  };
  const double norm = static_cast<double>(frame.shape.norm) * kQ30;
  const std::array<std::int64_t, 3> curved = frame.quadratic(of_cell);
  return {dot(frame.c) * norm,
          dot(frame.u) * norm * static_cast<double>(frame.shape.scale_u) / 16384,
          dot(frame.v) * norm * static_cast<double>(frame.shape.scale_v) / 16384,
          static_cast<double>(curved[0]) * kQ20,
          static_cast<double>(curved[1]) * kQ20,
          static_cast<double>(curved[2]) * kQ20};
}

/// L of A = L L^T in the lower triangle, in place.
void factorise(std::array<std::array<double, kMaxFunctions>, kMaxFunctions>& a, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (std::uint32_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(std::max(sum, 1e-30)) : sum / a[j][j];
    }
  }
}

/// Rounds towards zero a little: a coefficient of .58 steps is not worth its bits.
std::int32_t round_with_dead_zone(double x, double bias) {
  const double magnitude = std::min(std::fabs(x) + bias, static_cast<double>(kMaxQuantised));
  const auto steps = static_cast<std::int32_t>(magnitude);
  return x < 0 ? -steps : steps;
}

}  // namespace

LeafSamples::LeafSamples(const FieldState& state, const BlockContext& context,
                         const PatchFrame& frame, const std::vector<std::int32_t>& truth,
                         std::vector<std::uint32_t> of_cells)
    : cells(std::move(of_cells)) {
  for (const std::uint32_t cell : cells) {
    sights.push_back(state.geometry.sight(cell));
    ranges.push_back(truth[cell]);
    const double metres = static_cast<double>(truth[cell]) / kRangeUnit;
    inverse.push_back(1.0 / metres);
    weights.push_back(metres * metres * (metres * metres));
    const Sight& sight = sights.back();
    basis.push_back(basis_at(frame, apparent(sight, truth[cell]), sight.direction));
    if (context.warp == 0) continue;
    Surface guide{context.parent_plane[0], {}, false, true, {}};
    warped.push_back(static_cast<double>(kRangeUnit) /
                     static_cast<double>(state.range_in(guide, frame, cell)));
  }
}

LayerFit::LayerFit(const FieldState& state, const BlockContext& context, const PatchFrame& frame,
                   const LeafSamples& samples, const std::vector<std::uint32_t>& members,
                   const std::vector<double>& extra)
    : state_(state), context_(context), frame_(frame), samples_(samples), members_(members) {
  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::uint32_t i = members[m];
    const double weight = extra.empty() ? samples.weights[i] : samples.weights[i] * extra[m];
    const double target = samples.inverse[i];
    const auto& basis = samples.basis[i];
    for (std::uint32_t a = 0; a < kMaxFunctions; ++a) {
      const double weighted = weight * basis[a];
      moment_[a] += weighted * target;
      if (!samples.warped.empty()) warped_moment_[a] += weighted * samples.warped[i];
      for (std::uint32_t b = 0; b <= a; ++b) gram_[a][b] += weighted * basis[b];
    }
  }
  for (std::uint32_t a = 0; a < kMaxFunctions; ++a) {
    for (std::uint32_t b = a + 1; b < kMaxFunctions; ++b) gram_[a][b] = gram_[b][a];
  }
}

std::int64_t LayerFit::median_range() {
  if (median_) return *median_;
  std::vector<std::int64_t> ranges;
  ranges.reserve(members_.size());
  for (const std::uint32_t i : members_) ranges.push_back(samples_.ranges[i]);
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  median_ = *middle;
  return *median_;
}

/// Coefficients of B0..B2 that make n . d.
LayerFit::Vector LayerFit::in_basis(const Plane& plane) const {
  const auto along = [&](const Axis& axis) {
    return (static_cast<double>(plane.x) * static_cast<double>(axis.x) +
            static_cast<double>(plane.y) * static_cast<double>(axis.y) +
            static_cast<double>(plane.z) * static_cast<double>(axis.z)) *
           (kQ30 * kQ30);
  };
  const auto& shape = frame_.shape;
  const double norm = static_cast<double>(shape.norm) * kQ30;
  const auto over = [&](double value, std::int64_t scale) {
    return scale == 0 ? 0.0 : value / (norm * static_cast<double>(scale) / 16384);
  };
  return {along(frame_.c) / norm,
          over(along(frame_.u), shape.scale_u),
          over(along(frame_.v), shape.scale_v),
          0,
          0,
          0};
}

std::optional<LayerCode> LayerFit::fit(std::uint32_t parent, std::uint32_t functions) {
  LayerCode layer;
  layer.parent = parent;
  layer.functions = functions;
  if (parent == 0) {
    const std::int64_t steps =
        div_round(median_range() - context_.parents.range, range_step(state_, frame_));
    layer.range_steps =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(steps, -(1 << 23), 1 << 23));
  }
  const std::uint32_t first = parent == 0 ? 1 : 0;
  if (kFunctions[functions] <= first) return layer;
  const LayerBase start = base_of(state_, context_, frame_, layer);
  const std::uint32_t n = kFunctions[functions] - first;
  const bool warped = context_.kind_of(parent) == 2;
  const Vector base = warped ? Vector{} : in_basis(start.plane);
  Matrix gram{};
  Vector y{}, c{};
  double trace = 0;
  for (std::uint32_t a = 0; a < n; ++a) {
    y[a] = moment_[a + first];
    if (warped) y[a] -= warped_moment_[a + first];
    for (std::uint32_t b = 0; b < 3; ++b) y[a] -= gram_[a + first][b] * base[b];
    for (std::uint32_t b = 0; b <= a; ++b) gram[a][b] = gram_[a + first][b + first];
    trace += gram[a][a];
  }
  trace = trace / n + 1e-12;
  for (std::uint32_t a = 0; a < n; ++a) gram[a][a] += trace * (a + first >= 3 ? 3.1e-3 : 1e-4);
  factorise(gram, n);
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t k = 0; k < a; ++k) y[a] -= gram[a][k] * y[k];
    y[a] /= gram[a][a];
  }
  const double step = static_cast<double>(start.step_q40) * kQ40;
  for (std::uint32_t a = n; a-- > 0;) {
    double sum = y[a];
    for (std::uint32_t k = a + 1; k < n; ++k) sum -= gram[k][a] * c[k];
    const double steps = sum / gram[a][a] / step;
    if (!(std::fabs(steps) < kMaxQuantised)) return std::nullopt;
    const std::int32_t q = round_with_dead_zone(steps, a + first >= 3 ? 0.38 : 0.42);
    layer.q[a + first] = q;
    c[a] = q * step;
  }
  return layer;
}

}  // namespace curlidar::compact
