// SPDX-License-Identifier: BSD-3-Clause
#include "map/leaf_trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curlidar::tile {
namespace {

/// Slopes beyond this belong to another axis.
constexpr std::int32_t kSteepest = 8 * 65536 / 5;
constexpr std::uint32_t kPasses = 2;

std::int32_t rounded(double value) {
  return static_cast<std::int32_t>(std::floor(std::clamp(value, -1e6, 1e6) + 0.5));
}

class LeafTrials {
 public:
  LeafTrials(const TileState& state, const TileModels& models, const TileWeighing& weighing,
             const CubeContext& c, const CubeSamples& cube)
      : state_(state), models_(models), weighing_(weighing), c_(c), cube_(cube) {
    const TileLayout& layout = state.layout();
    height_step_ = layout.height_step(c.cube.level);
    // A step of slope as a rise over half an edge.
    slope_step_ = static_cast<double>(layout.slope_step(c.cube.level)) / 65536 * c.half;
    cells_ = layout.cells(c.cube.level);
    intensity_ = mean_intensity();
  }

  TriedLeaf best() && {
    const auto axes = axes_by_spread(cube_);
    for (std::uint32_t k = 1; k <= c_.count; ++k) inherit(k);
    try_fresh(axes[0]);
    try_fresh(axes[1]);
    if (state_.layout().curves && cells_ > 2) try_curves();
    return std::move(best_);
  }

 private:
  const FitMoments& moments(std::uint32_t axis) {
    if (!known_[axis]) {
      known_[axis] = true;
      moments_[axis] = robust_moments(cube_, axis, weighing_.near, kPasses);
    }
    return moments_[axis];
  }

  /// Corrections of a base plane: `base` at the centre, rises over half an edge.
  void correct(TileLeafCode leaf, const FittedPlane& base, std::uint32_t axis) {
    const FitMoments& m = moments(axis);
    leaf.terms = 1;
    leaf.q = {
        rounded((height_of_moments(m, base.rise_u, base.rise_v) - base.height) / height_step_), 0,
        0};
    if (leaf.candidate == 0 || leaf.q[0] != 0) attempt(leaf);
    if (cube_.size() < 4) return;
    const FittedPlane fit = plane_of_moments(m);
    leaf.terms = 3;
    leaf.q[1] = rounded((fit.rise_u - base.rise_u) / slope_step_);
    leaf.q[2] = rounded((fit.rise_v - base.rise_v) / slope_step_);
    if (leaf.q[1] == 0 && leaf.q[2] == 0) return;
    leaf.q[0] = rounded((height_of_moments(m, base.rise_u + leaf.q[1] * slope_step_,
                                           base.rise_v + leaf.q[2] * slope_step_) -
                         base.height) /
                        height_step_);
    attempt(leaf);
  }

  FittedPlane base_of(const TilePlane& plane) const {
    const std::int32_t height =
        plane.at(c_.centre[u_axis(plane.axis)], c_.centre[v_axis(plane.axis)]);
    const double half = static_cast<double>(c_.half) / 65536;
    return {static_cast<double>(height) - c_.centre[plane.axis], plane.slope[0] * half,
            plane.slope[1] * half};
  }

  void inherit(std::uint32_t candidate) {
    const TilePlane& plane = state_.planes()[c_.plane[candidate - 1]];
    TileLeafCode leaf;
    leaf.candidate = candidate;
    leaf.axis = plane.axis;
    attempt(leaf);
    correct(leaf, base_of(plane), plane.axis);
  }

  void try_fresh(std::uint32_t axis) {
    TileLeafCode leaf;
    leaf.axis = axis;
    correct(leaf, {}, axis);
  }

  /// The best leaf so far, bent.
  void try_curves() {
    if (cube_.size() < 24 || !(best_.cost < std::numeric_limits<double>::infinity())) return;
    TileLeafCode leaf = best_.code;
    const TilePlane plane = state_.plane_of(c_, leaf);
    const FittedCurve fit = robust_curve(cube_, plane.axis, weighing_.near, kPasses);
    if (!fit.good) return;
    leaf.curved = true;
    for (std::size_t k = 0; k < 3; ++k) leaf.curve[k] = rounded(fit.rise[k] / height_step_);
    if (leaf.curve == std::array<std::int32_t, 3>{}) return;
    TileLeafCode base_leaf = leaf;
    base_leaf.terms = 0;
    base_leaf.q = {};
    FittedPlane base;
    if (leaf.candidate > 0) base = base_of(state_.planes()[c_.plane[leaf.candidate - 1]]);
    leaf.terms = 3;
    leaf.q = {rounded((fit.plane.height - base.height) / height_step_),
              rounded((fit.plane.rise_u - base.rise_u) / slope_step_),
              rounded((fit.plane.rise_v - base.rise_v) / slope_step_)};
    attempt(leaf);
  }

  std::int32_t mean_intensity() const {
    if (!state_.layout().intensity) return 0;
    double sum = 0, weight = 0;
    for (std::size_t i = cube_.begin; i < cube_.end; ++i) {
      const auto intensity = static_cast<double>(cube_.samples->intensity[i]);
      if (!std::isfinite(intensity)) continue;
      sum += cube_.samples->weight[i] * intensity;
      weight += cube_.samples->weight[i];
    }
    return weight > 0 ? rounded(sum / weight / static_cast<double>(state_.layout().intensity_step))
                      : c_.intensity;
  }

  /// Distances of the samples, in all or cell by cell; infinity if that is no better than `bound`.
  double measure(const TilePlane& plane, const std::array<std::int32_t, 3>& curve) {
    const std::uint32_t ua = u_axis(plane.axis), va = v_axis(plane.axis);
    const std::vector<double>& us = cube_.samples->at[ua];
    const std::vector<double>& vs = cube_.samples->at[va];
    const std::vector<double>& hs = cube_.samples->at[plane.axis];
    const double a = plane.slope[0] / 65536.0, b = plane.slope[1] / 65536.0;
    const double upright = 1 / std::sqrt(1 + a * a + b * b);
    const double u0 = c_.centre[ua], v0 = c_.centre[va];
    const double h0 = plane.height + a * (u0 - plane.u) + b * (v0 - plane.v);
    const bool bent = curve != std::array<std::int32_t, 3>{};
    const double bend = 1.0 / 65536 / kTicks;
    const double to_cell = static_cast<double>(cells_) / (2.0 * c_.half);
    const double half = c_.half;
    near_.assign(std::size_t{cells_} * cells_, 0.0);
    left_.assign(near_.size(), 0.0);
    weight_.assign(near_.size(), 0.0);
    double total = 0;
    for (std::size_t i = cube_.begin; i < cube_.end; ++i) {
      const double du = us[i] - u0, dv = vs[i] - v0;
      double height = h0 + a * du + b * dv;
      if (bent) height += bend * (curve[0] * du * du + curve[1] * du * dv + curve[2] * dv * dv);
      const double off = std::min(std::abs(hs[i] - height) * upright, cube_.samples->drop[i]);
      const double w = cube_.samples->weight[i];
      total += w * off;
      if (cells_ > 1) {
        const auto cell = static_cast<std::size_t>((du + half) * to_cell) * cells_ +
                          static_cast<std::size_t>((dv + half) * to_cell);
        near_[cell] += w * off;
        left_[cell] += cube_.samples->left[i];
        weight_[cell] += w;
      }
    }
    return total;
  }

  void attempt(TileLeafCode leaf) {
    leaf.intensity = intensity_;
    const TilePlane plane = state_.plane_of(c_, leaf);
    if (std::abs(plane.slope[0]) > kSteepest || std::abs(plane.slope[1]) > kSteepest) return;
    const double distance = measure(plane, state_.curve_of(c_, leaf));
    TileCost cost(models_);
    code_candidate(cost, c_, leaf);
    code_numbers(cost, c_, state_.layout(), leaf);
    const double base = distance + weighing_.lambda * cost.bits();
    if (base >= best_.cost) return;
    if (cells_ == 1) {
      leaf.footprint = {1};
      best_ = {std::move(leaf), base};
      return;
    }
    leaf.footprint = state_.open_cells(c_, plane);
    keep(leaf, lambda_bits(cost));
    choose_cells(leaf, plane);
    keep(leaf, lambda_bits(cost));
  }

  double lambda_bits(const TileCost& cost) const { return weighing_.lambda * cost.bits(); }

  /// What the footprint leaves: near samples where it is set, the rest as left out.
  double footprint_distance(const std::vector<std::uint8_t>& footprint) const {
    const double bare = bare_cell();
    double total = 0;
    for (std::size_t k = 0; k < footprint.size(); ++k) {
      if (footprint[k] == 0) {
        total += left_[k];
      } else {
        total += near_[k] + (weight_[k] > 0 ? 0 : bare);
      }
    }
    return total;
  }
  double bare_cell() const {
    const double edge = 2.0 * c_.half / cells_;
    return weighing_.bare * edge * edge;
  }

  void keep(const TileLeafCode& leaf, double before) {
    const double distance = footprint_distance(leaf.footprint) + before;
    if (distance >= best_.cost) return;
    TileCost cost(models_);
    TileLeafCode copy = leaf;
    code_footprint(cost, state_, c_, copy);
    const double all = distance + lambda_bits(cost);
    if (all < best_.cost) best_ = {leaf, all};
  }

  /// Cell by cell what pays, given those before.
  void choose_cells(TileLeafCode& leaf, const TilePlane& plane) const {
    const double bare = bare_cell();
    TileCost cost(models_);
    CellWalk walk(state_, c_, leaf, plane);
    for (std::size_t k = 0; k < leaf.footprint.size(); ++k) {
      if (!walk.open(k)) {
        leaf.footprint[k] = 0;
        continue;
      }
      const TileContexts contexts = walk.contexts(k);
      const double gain = weight_[k] > 0 ? left_[k] - near_[k] : -bare;
      const double price = weighing_.lambda / 256 *
                           (static_cast<double>(cost.of(contexts, true)) -
                            static_cast<double>(cost.of(contexts, false)));
      leaf.footprint[k] = gain > price ? 1 : 0;
      walk.set(k, leaf.footprint[k] != 0);
    }
  }

  const TileState& state_;
  const TileModels& models_;
  const TileWeighing& weighing_;
  const CubeContext& c_;
  const CubeSamples& cube_;
  double height_step_ = 1, slope_step_ = 1;
  std::uint32_t cells_ = 1;
  std::int32_t intensity_ = 0;
  std::array<bool, 3> known_{};
  std::array<FitMoments, 3> moments_;
  std::vector<double> near_, left_, weight_;  ///< of the samples of each cell
  TriedLeaf best_;
};

}  // namespace

TriedLeaf best_leaf(const TileState& state, const TileModels& models, const TileWeighing& weighing,
                    const CubeContext& c, const CubeSamples& cube) {
  return LeafTrials(state, models, weighing, c, cube).best();
}

}  // namespace curlidar::tile
