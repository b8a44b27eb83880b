// SPDX-License-Identifier: BSD-3-Clause
#include "dense/patch_joints.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

namespace curlidar {
namespace {

constexpr std::size_t kFade = 4;  ///< cells on either side
constexpr double kMostSteps = 0.5;
/// Columns so much farther apart than those beside them have a gap between them.
constexpr double kGap = 1.9;

/// One row around the turn.
class Row {
 public:
  Row(std::span<const Vec3> points, std::span<const std::int32_t> patches, double height_m)
      : patches_(patches), moves_(points.size(), 0) {
    for (const Vec3& p : points) {
      ranges_.push_back(norm({p.x, p.y, p.z - height_m}));
      azimuths_.push_back(azimuth_of(p));
    }
  }

  /// What each cell moves by.
  const std::vector<double>& join(double most_m) {
    for (std::size_t cell = 0; cell < ranges_.size(); ++cell) join_behind(cell, most_m);
    for (double& move : moves_) move = std::clamp(move, -most_m, most_m);
    return moves_;
  }

 private:
  /// `steps` cells on from a cell, or back.
  std::size_t on(std::size_t cell, std::size_t steps) const {
    return (cell + steps) % ranges_.size();
  }
  std::size_t back(std::size_t cell, std::size_t steps) const {
    return (cell + ranges_.size() - steps) % ranges_.size();
  }
  bool of(std::size_t cell, std::int32_t patch) const {
    return patches_[cell] == patch && patch >= 0 && ranges_[cell] > 0;
  }

  double turn(std::size_t from, std::size_t to) const {
    return std::abs(std::remainder(azimuths_[to] - azimuths_[from], 2 * std::numbers::pi));
  }

  /// The border behind a cell, if there is one.
  void join_behind(std::size_t left, double most_m) {
    const std::size_t right = on(left, 1);
    const std::int32_t patch = patches_[left], next = patches_[right];
    if (patch == next || !of(left, patch) || !of(right, next)) return;
    const std::size_t left2 = back(left, 1), right2 = on(right, 1);
    if (!of(left2, patch) || !of(right2, next)) return;
    if (turn(left, right) > kGap * std::max(turn(left2, left), turn(right, right2))) return;
    const double before = ranges_[left] - ranges_[left2];
    const double behind = ranges_[right2] - ranges_[right];
    const double step = ranges_[right] - ranges_[left] - (before + behind) / 2;
    if (std::abs(step) > most_m || std::abs(before - behind) > most_m) return;
    for (std::size_t away = 0; away < kFade && of(back(left, away), patch); ++away) {
      moves_[back(left, away)] += step * share(away);
    }
    for (std::size_t away = 0; away < kFade && of(on(right, away), next); ++away) {
      moves_[on(right, away)] -= step * share(away);
    }
  }

  static double share(std::size_t away) {
    return 0.5 * (1 - (static_cast<double>(away) + 0.5) / kFade);
  }

  std::span<const std::int32_t> patches_;
  std::vector<double> ranges_, azimuths_, moves_;
};

}  // namespace

std::vector<float> patch_joints(const Field& field, std::span<const Vec3> points) {
  const std::vector<std::int32_t> patches = field.cell_patches();
  const std::size_t columns = field.lattice().columns();
  if (patches.empty() || columns < 2 * kFade) return {};
  std::vector<float> moves;
  moves.reserve(points.size());
  for (std::uint32_t row = 0; row < field.lattice().rows(); ++row) {
    Row cells(points.subspan(row * columns, columns), {patches.data() + row * columns, columns},
              field.row_line(row).height_m);
    for (const double move : cells.join(kMostSteps * field.step_m())) {
      moves.push_back(static_cast<float>(move));
    }
  }
  return moves;
}

}  // namespace curlidar
