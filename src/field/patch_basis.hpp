// SPDX-License-Identifier: BSD-3-Clause
// Spherical harmonics on a small patch of the sphere, well conditioned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace curlidar {

/// Sine and cosine of an angle, kept because every use needs both.
struct AngleParts {
  double sin = 0, cos = 1;
  static AngleParts of(double angle);
};

/// A direction seen from the centre of a patch: components along east and north, and one minus
/// the component along the centre, computed without cancellation. On the sphere
/// east^2 + north^2 = 2 down - down^2.
struct LocalDirection {
  double east = 0, north = 0, down = 0;
};

/// Tangent frame at (elevation, azimuth 0); directions are given relative to it in azimuth.
class LocalFrame {
 public:
  explicit LocalFrame(double centre_elevation) : centre_(AngleParts::of(centre_elevation)) {}

  /// `half` is of half the azimuth difference, `elevation` of the direction's elevation.
  LocalDirection local(const AngleParts& elevation, const AngleParts& half) const;

 private:
  AngleParts centre_;
};

/// Bounds on a patch: they keep the cost of a patch finite on both sides of a file. Degree 24 on a
/// patch of a few degrees resolves waves far finer than its cells.
inline constexpr std::size_t kMaxPatchFunctions = 256;
inline constexpr std::size_t kMaxPatchDegree = 24;

/// Number of real spherical harmonics up to a degree.
constexpr std::size_t harmonics_up_to(std::size_t degree) {
  return (degree + 1) * (degree + 1);
}

/// An orthonormal basis of the span of all spherical harmonics up to a degree, restricted to the
/// nominal cells of a patch. Spherical harmonics rotate into themselves degree by degree, so that
/// the span is that of down^i Re (east + i north)^m and down^i Im (..)^m with i + m <= degree:
/// polynomials whose scaled values are of order one, where the harmonics themselves have condition
/// numbers of 3e4 (degree 1) to 2e13 (degree 3). Functions are orthonormalised in that order over
/// the cells (mean of squares 1), those dependent on earlier ones are left out; hence there are at
/// most as many functions as cells.
class PatchBasis {
 public:
  /// `cells` are the nominal cells, at least one.
  explicit PatchBasis(std::vector<LocalDirection> cells);

  std::size_t cells() const { return cells_.size(); }
  /// Makes the functions of all degrees up to `degree` available, as far as the bounds allow.
  /// O(cells * functions^2).
  void extend(std::size_t degree);
  /// The lowest degree with at least `count` functions, made available; the highest possible one
  /// if there is none.
  std::size_t degree_with(std::size_t count);
  /// Highest degree available.
  std::size_t degree() const { return ends_.size() - 1; }
  /// Functions up to a degree (at most harmonics_up_to(degree)).
  std::size_t functions(std::size_t degree) const { return ends_[degree]; }
  /// Whether degrees above the available ones add nothing.
  bool complete() const { return full() || degree() >= kMaxPatchDegree; }

  /// Values of function k at all nominal cells.
  const std::vector<double>& values(std::size_t k) const { return columns_[k]; }

  /// Coefficients of the first basis functions (at most functions(degree) of them) as coefficients
  /// of the local polynomials of degree `degree`, in evaluate_local's order and units.
  std::vector<double> to_local(std::span<const double> coefficients, std::size_t degree) const;

 private:
  bool full() const {
    return columns_.size() >= cells_.size() || columns_.size() >= kMaxPatchFunctions;
  }
  void add_degree();

  std::vector<LocalDirection> cells_;
  double tangent_scale_ = 1, down_scale_ = 1;
  std::vector<std::vector<double>> columns_;   ///< orthonormal functions
  std::vector<std::vector<double>> triangle_;  ///< of function k: weights of functions 0..k
  std::vector<std::size_t> polynomial_;        ///< index of the polynomial behind function k
  std::vector<std::size_t> ends_;              ///< functions up to each degree
};

/// Value at a direction of a sum of local polynomials, (degree + 1)^2 of them and at least one: for
/// every degree l and i = 0..l with m = l - i: down^i Re zeta^m and, for m > 0, down^i Im zeta^m;
/// zeta = east + i north.
double evaluate_local(std::span<const double> local_coefficients, const LocalDirection& direction);

}  // namespace curlidar
