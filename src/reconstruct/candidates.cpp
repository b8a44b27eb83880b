// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/candidates.hpp"

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace curlidar {
namespace {

/// Candidates on a side of one point's share of surface.
constexpr double kFiner = 2;
/// Finer parts of a quad are less than a micrometre wide a kilometre away.
constexpr double kMostDivisions = 1 << 24;

/// The four weights of bilinear interpolation.
std::array<double, 4> weights_at(double down, double right) {
  return {(1 - down) * (1 - right), (1 - down) * right, down * (1 - right), down * right};
}

/// A candidate that its planes ask for, before the field is asked.
struct Candidate {
  Sightline line;
  std::array<double, 4> weights{};
  double points_per_m2_sr = 0;  ///< points for each square metre a steradian
  double threshold = 0;
};

double threshold_of(std::uint64_t row, std::uint64_t column) {
  constexpr double kPlastic = 1.32471795724474602596;
  const double value = static_cast<double>(row) / kPlastic +
                       static_cast<double>(column) / (kPlastic * kPlastic) + 0.5;
  return value - std::floor(value);
}

/// Adds the candidates of one line of a quad.
void add_candidates(const Quad& quad, const Sphere& sphere, const Division& division,
                    std::uint32_t u, std::vector<Candidate>& candidates) {
  const auto [down, right, density] = division;
  const double below = (u + 0.5) / down, row = static_cast<double>(quad.row) + below;
  const double upper = sphere.elevation(row - 0.5 / down);
  const double lower = sphere.elevation(row + 0.5 / down);
  const double steradians = (std::sin(upper) - std::sin(lower)) * sphere.column_angle / right;
  for (std::uint32_t v = 0; v < right; ++v) {
    const double beside = (v + 0.5) / right, column = static_cast<double>(quad.column) + beside;
    Candidate candidate;
    candidate.line.direction = sphere.direction(row, column);
    candidate.points_per_m2_sr = density * steradians;
    candidate.threshold =
        threshold_of(std::uint64_t{quad.row} * down + u, std::uint64_t{quad.column} * right + v);
    const double most = candidate.points_per_m2_sr * largest_area(quad, candidate.line.direction);
    if (candidate.threshold >= most) continue;
    candidate.weights = weights_at(below, beside);
    candidates.push_back(candidate);
  }
}

/// Adds those candidates that the field confirms.
void add_points(const ScanView& view, const Quad& quad, std::span<const Candidate> candidates,
                Samples& samples) {
  std::vector<Sightline> lines;
  for (const Candidate& candidate : candidates) lines.push_back(candidate.line);
  std::vector<Vec3> points(lines.size());
  std::vector<float> confidence(lines.size());
  view.look(lines, points, confidence, 1);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (std::isnan(points[i].x)) continue;
    const Candidate& candidate = candidates[i];
    const double area = area_at(quad, candidate.line.direction, candidate.weights, norm(points[i]));
    if (candidate.threshold >= candidate.points_per_m2_sr * area) continue;
    samples.points.push_back(points[i]);
    samples.confidence.push_back(confidence[i]);
  }
}

}  // namespace

std::optional<Division> division_of(const Quad& quad, const Sphere& sphere, double density) {
  const auto [height, width] = lengths_of(quad, sphere);
  const auto parts = [&](double length) {
    return std::exp2(std::ceil(std::log2(std::max(kFiner * length * std::sqrt(density), 1.0))));
  };
  const double down = parts(height), right = parts(width);
  if (!(down <= kMostDivisions && right <= kMostDivisions)) return std::nullopt;
  return Division{static_cast<std::uint32_t>(down), static_cast<std::uint32_t>(right), density};
}

void sample_quad(const ScanView& view, const Sphere& sphere, const Quad& quad,
                 const Division& division, Samples& samples) {
  constexpr std::size_t kAtOnce = 4096;
  std::vector<Candidate> candidates;
  for (std::uint32_t u = 0; u < division.down; ++u) {
    add_candidates(quad, sphere, division, u, candidates);
    if (candidates.size() < kAtOnce && u + 1 < division.down) continue;
    add_points(view, quad, candidates, samples);
    candidates.clear();
  }
}

}  // namespace curlidar
