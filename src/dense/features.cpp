// SPDX-License-Identifier: BSD-3-Clause
#include "dense/features.hpp"

#include <algorithm>
#include <cmath>

#include "dense/confidence.hpp"
#include "sensor/angles.hpp"

namespace curlidar {
namespace {

constexpr float kAbsent = -3;  ///< instead of a logarithm where there is nothing
constexpr double kMostAway = 20;

/// Fills an array from its start.
template <std::size_t kSize>
class Filler {
 public:
  explicit Filler(std::array<float, kSize>& to) : to_(to) {}
  void add(double value) { to_[at_++] = static_cast<float>(value); }
  std::size_t filled() const { return at_; }

 private:
  std::array<float, kSize>& to_;
  std::size_t at_ = 0;
};

/// log(r / reference), kept to +-2.
double ratio(double r, double reference) {
  if (!(r > 0 && reference > 0)) return kAbsent;
  return std::clamp(std::log(r / reference), -2.0, 2.0);
}

/// Where the line meets the plane through two rings; 0: nowhere near.
double extended(const Look& look, const RingLook& far, const RingLook& near) {
  constexpr double kFarthest_m = 200;
  if (!far.known || !near.known) return 0;
  const double inverse = look.line.inverse_to(far.place, near.place);
  return inverse > 1 / kFarthest_m ? 1 / inverse : kFarthest_m;
}

/// How much a row of samples bends over 2 `reach` columns, metres; less than 0 if it is not known.
double bend(const Neighbours& row, double middle, int reach) {
  const double left = row.at(-reach), right = row.at(reach);
  if (!(left > 0 && right > 0 && middle > 0)) return -1;
  return std::min(std::abs(left + right - 2 * middle), 10.0);
}

/// How near the samples of a row come to a range, as the logarithm of the ratio.
double nearest_ratio(const Neighbours& row, double r) {
  constexpr int kReach = 6;
  constexpr double kMost = 7.389056098930650;  // e^2
  if (!(r > 0)) return 2;
  double nearest = kMost;
  for (int column = -kReach; column <= kReach; ++column) {
    const double there = row.at(column);
    if (there > 0) nearest = std::min(nearest, std::max(there, r) / std::min(there, r));
  }
  return std::log(nearest);
}

/// How far samples side by side lie from the straight line through their neighbours, the mean over
/// seven columns: the noise that is left, and steps of the coding. Less than 0: not known.
double roughness(const Neighbours& row) {
  constexpr int kReach = 3;
  double sum = 0;
  int count = 0;
  for (int column = -kReach; column <= kReach; ++column) {
    const double left = row.at(column - 1), here = row.at(column), right = row.at(column + 1);
    if (!(left > 0 && here > 0 && right > 0)) continue;
    sum += std::min(std::abs(left + right - 2 * here) / 2, 1.0);
    ++count;
  }
  return count > 0 ? sum / count : -1;
}

/// Logarithm of the size of the patch that a ring's nearest sample was coded with; -1: none.
double patch_size(const ScanErrors& errors, const RingLook& ring) {
  if (!ring.known || errors.patch_cells.empty()) return -1;
  const RingSample& nearest = ring.right.away < ring.left.away ? ring.right : ring.left;
  const std::uint32_t cells = errors.patch_cells[nearest.point->cell];
  return cells > 0 ? std::log2(cells) : -1;
}

template <std::size_t kSize>
void add_row(Filler<kSize>& to, const RingLook& ring, const Neighbours& row, double r) {
  to.add(std::min(ring.near, kMostAway));
  for (const int reach : {1, 3, 8}) to.add(row.count(reach));
  double least = 0, most = 0;
  for (int column = -3; column <= 3; ++column) {
    const double here = row.at(column);
    if (!(here > 0)) continue;
    least = least > 0 ? std::min(least, here) : here;
    most = std::max(most, here);
  }
  to.add(ratio(least, r));
  to.add(ratio(most, r));
  to.add(bend(row, ring.known ? ring.r : 0, 1));
  to.add(bend(row, ring.known ? ring.r : 0, 3));
  for (const int column : {-4, -2, -1, 1, 2, 4}) to.add(ratio(row.at(column), r));
}

/// For every cell how many have its patch.
std::vector<std::uint32_t> patch_cells(const std::vector<std::int32_t>& patches) {
  std::vector<std::uint32_t> sizes, cells(patches.size(), 0);
  for (const std::int32_t patch : patches) {
    if (patch < 0) continue;
    const auto at = static_cast<std::size_t>(patch);
    if (at >= sizes.size()) sizes.resize(at + 1, 0);
    ++sizes[at];
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches[i] >= 0) cells[i] = sizes[static_cast<std::size_t>(patches[i])];
  }
  return cells;
}

int kind(DenseMode mode) {
  switch (mode) {
    case DenseMode::none:
      return 0;
    case DenseMode::smooth:
      return 1;
    case DenseMode::planar:
      return 2;
    case DenseMode::jump_below:
    case DenseMode::jump_above:
      return 3;
    default:
      return 4;
  }
}

}  // namespace

ScanErrors errors_of(const RingPoints& points) {
  return {.noise_m = ring_noise_m(points)};
}

ScanErrors errors_of(const RingPoints& points, const Field& field) {
  double squares = 0;
  const std::uint32_t rows = field.lattice().rows();
  for (std::uint32_t row = 0; row < rows; ++row) {
    squares += field.ring_offset_m(row) * field.ring_offset_m(row);
  }
  return {ring_noise_m(points), field.step_m(), std::sqrt(squares / rows),
          patch_cells(field.cell_patches())};
}

PlainFeatures plain_features(const RingPoints& points, const Look& look, const Guess& guess,
                             const ScanErrors& errors) {
  PlainFeatures features{};
  Filler to(features);
  const RingLook &above = look.above, &below = look.below;
  const Neighbours row_above = neighbours_of(points, look.line, above.ring);
  const Neighbours row_below = neighbours_of(points, look.line, below.ring);
  const double r = guess.r;
  const double r_above = above.known ? above.r : 0, r_below = below.known ? below.r : 0;
  to.add(kind(guess.mode));
  to.add(look.share);
  to.add(guess.above_share);
  to.add(degrees_of(look.gap));
  to.add(look.gap * r);
  to.add(r);
  to.add(points.column_step() * r);
  to.add(errors.noise_m);
  to.add(errors.step_m);
  to.add(errors.offset_m);
  to.add(plain_confidence(look, guess, errors.noise_m));
  to.add(guess.doubt);
  to.add(look.line.from.z + r * look.line.along.z);
  to.add(above.place.z);
  to.add(below.place.z);
  to.add(ratio(r_above, r));
  to.add(ratio(r_below, r));
  to.add(r_above > 0 && r_below > 0 ? std::min(std::abs(r_above - r_below), 50.0) : -1);
  to.add(ratio(look.above2.known ? look.above2.r : 0, r));
  to.add(ratio(look.below2.known ? look.below2.r : 0, r));
  to.add(std::min(look.above2.near, kMostAway));
  to.add(std::min(look.below2.near, kMostAway));
  for (const double meets :
       {extended(look, look.above2, above), extended(look, look.below2, below)}) {
    to.add(ratio(meets, r));
    to.add(meets > 0 ? std::clamp(meets - r, -20.0, 20.0) : -30);
  }
  to.add(nearest_ratio(row_above, r_below));
  to.add(nearest_ratio(row_below, r_above));
  to.add(nearest_ratio(row_above, r));
  to.add(nearest_ratio(row_below, r));
  add_row(to, above, row_above, r);
  add_row(to, below, row_below, r);
  static_assert(kPlainFeatures == 22 + 4 + 4 + 2 * 14 + 2 + 4);
  to.add(std::min(above.near, below.near));
  to.add(row_above.count(1) + row_below.count(1));
  to.add(roughness(row_above));
  to.add(roughness(row_below));
  to.add(patch_size(errors, above));
  to.add(patch_size(errors, below));
  return features;
}

RowFeatures row_features(const PlainFeatures& plain, const DensityProfile& profile, std::size_t row,
                         const Look& look, const Guess& guess) {
  RowFeatures features{};
  Filler to(features);
  for (const float feature : plain) to.add(feature);
  const auto share = [&](double r) { return r > 0 ? profile.return_share(row, r) : -1; };
  const auto given = [&](const RingLook& ring) {
    if (ring.ring < 0) return -1.0;
    const std::size_t its =
        profile.given_first + static_cast<std::size_t>(ring.ring) * profile.given_every;
    return its < profile.rows ? profile.given_return_share(its, ring.known ? ring.r : guess.r)
                              : -1.0;
  };
  const double r = guess.r;
  const double bin = static_cast<double>(RangeTable::bin(r));
  to.add(static_cast<double>(row));
  to.add(share(r));
  to.add(share(RangeTable::kBinScale_m / std::max(bin - 0.5, 0.1)));
  to.add(share(RangeTable::kBinScale_m / (bin + 1.5)));
  to.add(share(look.above.known ? look.above.r : 0));
  to.add(share(look.below.known ? look.below.r : 0));
  to.add(given(look.above));
  to.add(given(look.below));
  to.add(degrees_of(std::atan2(look.line.along.z, look.line.along.rho)));
  return features;
}

}  // namespace curlidar
