// SPDX-License-Identifier: BSD-3-Clause
#include "compact/leaf_fit.hpp"

#include <algorithm>
#include <cmath>

namespace curlidar::compact {
namespace {

constexpr double kQ20 = 1.0 / (1 << 20);
constexpr double kQ30 = 1.0 / (1 << 30);
constexpr double kQ40 = kQ20 * kQ20;

/// B0..B5 at a direction, as add_functions scales them.
std::array<double, kMaxFunctions> basis_at(const PatchFrame& frame, const Direction& d) {
  const auto dot = [&](const Axis& a) {
    return static_cast<double>((a.x * d.x + a.y * d.y + a.z * d.z) >> 22) * kQ30;
  };
  const double norm = static_cast<double>(frame.shape.norm) * kQ30;
  const std::array<std::int64_t, 3> curved = frame.quadratic(d);
  return {dot(frame.c) * norm,
          dot(frame.u) * norm * static_cast<double>(frame.shape.scale_u) / 16384,
          dot(frame.v) * norm * static_cast<double>(frame.shape.scale_v) / 16384,
          static_cast<double>(curved[0]) * kQ20,
          static_cast<double>(curved[1]) * kQ20,
          static_cast<double>(curved[2]) * kQ20};
}

using Matrix = std::array<std::array<double, kMaxFunctions>, kMaxFunctions>;
using Vector = std::array<double, kMaxFunctions>;

/// L of A = L L^T in the lower triangle, in place.
void factorise(Matrix& a, std::uint32_t n) {
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

std::int64_t median_range(const LeafSamples& samples, const std::vector<std::uint32_t>& members) {
  std::vector<std::int64_t> ranges;
  ranges.reserve(members.size());
  for (const std::uint32_t i : members) ranges.push_back(samples.ranges[i]);
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  return *middle;
}

struct Start {
  Plane plane;
  std::int64_t step_q40 = 0;
  LayerCode layer;
};

Start start_of(const FieldState& state, const BlockContext& context, const PatchFrame& frame,
               const LeafSamples& samples, const std::vector<std::uint32_t>& members,
               std::uint32_t parent, std::uint32_t functions) {
  Start start;
  start.layer.parent = parent;
  start.layer.functions = functions;
  std::int64_t range = 0;
  if (parent == 0) {
    const std::int64_t step =
        std::max<std::int64_t>(mul_shift(state.settings.step, frame.shape.norm, 30), 1);
    const std::int64_t steps =
        div_round(median_range(samples, members) - context.parents.range, step);
    start.layer.range_steps =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(steps, -(1 << 23), 1 << 23));
    range =
        std::clamp(context.parents.range + start.layer.range_steps * step, kMinRange, kMaxRange);
    start.plane = facing_plane(frame, range);
  } else {
    start.plane =
        state.surfaces[static_cast<std::size_t>(context.parents.surface[parent - 1])].surface.plane;
    const Direction& middle =
        state.geometry.directions()[state.cell(context.block.row + context.block.height / 2,
                                               context.block.column + context.block.width / 2)];
    range = range_of(start.plane.at(middle));
  }
  start.step_q40 = coefficient_step((std::int64_t{1} << 46) / range, state.settings.step);
  return start;
}

}  // namespace

LeafSamples::LeafSamples(const FieldState& state, const PatchFrame& frame,
                         const std::vector<std::int32_t>& truth, const Block& block) {
  state.cells_of(block, cells);
  for (const std::uint32_t cell : cells) {
    directions.push_back(state.geometry.directions()[cell]);
    ranges.push_back(truth[cell]);
    const double metres = static_cast<double>(truth[cell]) / kRangeUnit;
    weights.push_back(metres * metres * (metres * metres));
    basis.push_back(basis_at(frame, directions.back()));
  }
}

std::optional<LayerCode> fit_layer(const FieldState& state, const BlockContext& context,
                                   const PatchFrame& frame, const LeafSamples& samples,
                                   const std::vector<std::uint32_t>& members,
                                   const std::vector<double>& extra, std::uint32_t parent,
                                   std::uint32_t functions) {
  Start start = start_of(state, context, frame, samples, members, parent, functions);
  const std::uint32_t first = parent == 0 ? 1 : 0;
  if (kFunctions[functions] <= first) return start.layer;
  const std::uint32_t n = kFunctions[functions] - first;
  Matrix gram{};
  Vector moment{};
  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::uint32_t i = members[m];
    const double weight = extra.empty() ? samples.weights[i] : samples.weights[i] * extra[m];
    const double target = static_cast<double>(kRangeUnit) / static_cast<double>(samples.ranges[i]);
    const double error = target - static_cast<double>(start.plane.at(samples.directions[i])) * kQ30;
    const auto& basis = samples.basis[i];
    for (std::uint32_t a = 0; a < n; ++a) {
      const double weighted = weight * basis[a + first];
      moment[a] += weighted * error;
      for (std::uint32_t b = 0; b <= a; ++b) gram[a][b] += weighted * basis[b + first];
    }
  }
  double trace = 0;
  for (std::uint32_t a = 0; a < n; ++a) trace += gram[a][a];
  trace = trace / n + 1e-12;
  for (std::uint32_t a = 0; a < n; ++a) gram[a][a] += trace * (a + first >= 3 ? 3.1e-3 : 1e-4);
  factorise(gram, n);
  Vector y{}, c{};
  for (std::uint32_t a = 0; a < n; ++a) {
    double sum = moment[a];
    for (std::uint32_t k = 0; k < a; ++k) sum -= gram[a][k] * y[k];
    y[a] = sum / gram[a][a];
  }
  const double step = static_cast<double>(start.step_q40) * kQ40;
  for (std::uint32_t a = n; a-- > 0;) {
    double sum = y[a];
    for (std::uint32_t k = a + 1; k < n; ++k) sum -= gram[k][a] * c[k];
    const double steps = sum / gram[a][a] / step;
    if (!(std::fabs(steps) < kMaxQuantised)) return std::nullopt;
    const std::int32_t q = round_with_dead_zone(steps, a + first >= 3 ? 0.38 : 0.42);
    start.layer.q[a + first] = q;
    c[a] = q * step;
  }
  return start.layer;
}

}  // namespace curlidar::compact
