// SPDX-License-Identifier: BSD-3-Clause
// As many points as wished on every square metre of surface.
//
// The sphere is divided into quads of some tenths of a degree. The planes of the surface at a
// quad's corners tell how much of it each direction shows: r^2 / |cos incidence| for a solid angle.
// A quad is divided into candidates so fine that each stands for less than a point; a candidate is
// taken if its share of a point is above its threshold, one of a sequence that is spread evenly
// over rows and columns (R2: multiples of the powers of the plastic number). What is taken is
// looked for in the field itself, so nothing lies where the field does not believe in a surface.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "reconstruct/coded.hpp"
#include "reconstruct/finish.hpp"
#include "reconstruct/normals.hpp"
#include "reconstruct/originals.hpp"

namespace curlidar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
/// Sides of the quads, radians: small enough that few surfaces are missed between their corners.
constexpr double kQuadAngle = 0.45 * std::numbers::pi / 180;
/// Candidates on a side of one point's share of surface.
constexpr double kFiner = 2;
constexpr double kMostDivisions = 4096;
/// Surfaces seen at a smaller cosine show more than can be told.
constexpr double kLeastCosine = 0.01;

/// The plane of a surface as seen from the origin; none where nothing is believed.
struct Plane {
  Vec3 normal{};
  double distance = 0;  ///< of the origin; 0: no plane

  bool exists() const { return distance > 0; }
  /// Range along a unit vector, and the square metres that a steradian around it shows.
  double range(const Vec3& direction) const { return distance / cosine(direction); }
  double area(const Vec3& direction) const {
    const double r = range(direction);
    return r * r / cosine(direction);
  }
  double cosine(const Vec3& direction) const {
    return std::max(-dot(normal, direction), kLeastCosine);
  }
};

/// The quads of the sphere that may show something.
struct Sphere {
  double top = 0, row_angle = 0, column_angle = 0;
  std::size_t rows = 0, columns = 0;

  double elevation(double row) const { return top - row * row_angle; }
  double azimuth(double column) const { return -std::numbers::pi + column * column_angle; }
  Vec3 direction(double row, double column) const {
    return direction_of(elevation(row), azimuth(column));
  }
};

Sphere sphere_of(const std::vector<Vec3>& returns) {
  // Beams may end a step of rows outside of the outermost returns.
  constexpr double kMargin = 3 * std::numbers::pi / 180;
  double low = std::numbers::pi / 2, high = -low;
  for (const Vec3& p : returns) {
    low = std::min(low, elevation_of(p));
    high = std::max(high, elevation_of(p));
  }
  Sphere sphere;
  if (low > high) return sphere;
  low = std::max(low - kMargin, -std::numbers::pi / 2);
  high = std::min(high + kMargin, std::numbers::pi / 2);
  sphere.top = high;
  sphere.rows = static_cast<std::size_t>(std::ceil((high - low) / kQuadAngle));
  sphere.columns = static_cast<std::size_t>(std::ceil(kTurn / kQuadAngle));
  sphere.row_angle = (high - low) / static_cast<double>(sphere.rows);
  sphere.column_angle = kTurn / static_cast<double>(sphere.columns);
  return sphere;
}

/// The planes at one row of corners.
std::vector<Plane> planes_of_row(const View& view, const Sphere& sphere, std::size_t row) {
  std::vector<Sightline> lines(sphere.columns);
  for (std::size_t j = 0; j < lines.size(); ++j) {
    lines[j].direction = sphere.direction(static_cast<double>(row), static_cast<double>(j));
  }
  std::vector<Vec3> points(lines.size());
  std::vector<float> confidence(lines.size());
  view.look(lines, points, confidence, 1);
  const std::vector<Vec3> normals = normals_at(view, points, 1);
  std::vector<Plane> planes(lines.size());
  for (std::size_t j = 0; j < lines.size(); ++j) {
    const double range = norm(points[j]);
    if (!(std::isfinite(range) && range > 0)) continue;
    // A surface that does not tell its slant is taken as seen straight.
    const Vec3 normal = std::isnan(normals[j].x) ? points[j] * (-1 / range) : normals[j];
    const double cosine = std::max(-dot(normal, points[j]) / range, kLeastCosine);
    planes[j] = {normal, range * cosine};
  }
  return planes;
}

/// A quad of the sphere with the planes at its corners: top left, top right, bottom left, right.
struct Quad {
  std::array<Plane, 4> planes;
  std::size_t row = 0, column = 0;
};

/// The four weights of bilinear interpolation.
std::array<double, 4> weights_at(double down, double right) {
  return {(1 - down) * (1 - right), (1 - down) * right, down * (1 - right), down * right};
}

/// Square metres that a steradian shows in a direction, if its surface is at `range`: by the planes
/// that it may be on.
double area_at(const Quad& quad, const Vec3& direction, const std::array<double, 4>& weights,
               double range) {
  constexpr double kOff_m = 0.05, kOffShare = 0.05;    // from any plane: another surface
  constexpr double kSame_m = 0.01, kSameShare = 0.01;  // farther than from the nearest plane
  std::array<double, 4> off{};
  double nearest = kOff_m + kOffShare * range;
  for (std::size_t k = 0; k < off.size(); ++k) {
    const bool exists = quad.planes[k].exists();
    off[k] = exists ? std::abs(quad.planes[k].range(direction) - range) : 1e300;
    nearest = std::min(nearest, off[k]);
  }
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < off.size(); ++k) {
    if (off[k] > nearest + kSame_m + kSameShare * range) continue;
    const double w = weights[k] + 1e-3;
    sum += w * quad.planes[k].area(direction);
    weight += w;
  }
  return weight > 0 ? sum / weight : range * range;
}

double largest_area(const Quad& quad, const Vec3& direction) {
  double largest = 0;
  for (const Plane& plane : quad.planes) {
    if (plane.exists()) largest = std::max(largest, plane.area(direction));
  }
  return largest;
}

/// Into how many candidates a quad is divided from top to bottom and from left to right: powers of
/// two, so that those of neighbouring quads fit together.
std::array<std::uint32_t, 2> divisions_of(const Quad& quad, const Sphere& sphere, double spacing) {
  const auto row = static_cast<double>(quad.row), column = static_cast<double>(quad.column);
  double height = 0, width = 0;
  for (const Plane& plane : quad.planes) {
    if (!plane.exists()) continue;
    const auto at = [&](double down, double right) {
      const Vec3 direction = sphere.direction(row + down, column + right);
      return direction * plane.range(direction);
    };
    height = std::max(height, norm(at(0, 0.5) - at(1, 0.5)));
    width = std::max(width, norm(at(0.5, 0) - at(0.5, 1)));
  }
  const auto divisions = [&](double length) {
    const double wanted = std::clamp(kFiner * length / spacing, 1.0, kMostDivisions);
    return static_cast<std::uint32_t>(std::exp2(std::ceil(std::log2(wanted))));
  };
  return {divisions(height), divisions(width)};
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

/// How the candidates of a quad lie.
struct Division {
  std::uint32_t down, right;
  double density;
};

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
void add_points(const View& view, const Quad& quad, std::span<const Candidate> candidates,
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

/// Adds the points of a quad.
void sample_quad(const View& view, const Sphere& sphere, const Quad& quad, double density,
                 Samples& samples) {
  constexpr std::size_t kAtOnce = 4096;
  const auto [down, right] = divisions_of(quad, sphere, 1 / std::sqrt(density));
  std::vector<Candidate> candidates;
  for (std::uint32_t u = 0; u < down; ++u) {
    add_candidates(quad, sphere, {down, right, density}, u, candidates);
    if (candidates.size() < kAtOnce && u + 1 < down) continue;
    add_points(view, quad, candidates, samples);
    candidates.clear();
  }
}

Quad quad_of(const std::vector<std::vector<Plane>>& planes, std::size_t row, std::size_t column) {
  const std::size_t right = (column + 1) % planes[row].size();
  return {
      {planes[row][column], planes[row][right], planes[row + 1][column], planes[row + 1][right]},
      row,
      column};
}

/// About how many points the surfaces of all quads need.
double expected_points(const std::vector<std::vector<Plane>>& planes, const Sphere& sphere,
                       double density) {
  double square_metres = 0;
  for (std::size_t row = 0; row < planes.size(); ++row) {
    const auto at = static_cast<double>(row);
    const double steradians =
        std::cos(sphere.elevation(at)) * sphere.row_angle * sphere.column_angle;
    for (std::size_t column = 0; column < sphere.columns; ++column) {
      const Plane& plane = planes[row][column];
      if (plane.exists()) {
        square_metres += steradians * plane.area(sphere.direction(at, static_cast<double>(column)));
      }
    }
  }
  return square_metres * density;
}

Error too_many(double points, double density, const ReconstructSettings& settings) {
  return {ErrorCode::limit_exceeded,
          fmt::format("{} points on every square metre are about {:.2g} in all, more than the {} "
                      "allowed: wish for fewer, or for a part of the scan",
                      density, points, settings.max_points)};
}

Result<Samples> sample_surfaces(const View& view, const Sphere& sphere, double density,
                                const TakenPlaces* taken, const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 8;
  const std::size_t threads = view.settings().threads;
  std::vector<std::vector<Plane>> planes(sphere.rows == 0 ? 0 : sphere.rows + 1);
  in_batches(planes.size(), kBatch, progress, [&](std::size_t begin, std::size_t end) {
    parallel_for(end - begin, threads, [&](std::size_t k) {
      planes[begin + k] = planes_of_row(view, sphere, begin + k);
    });
  });
  const auto allowed = static_cast<double>(view.settings().max_points);
  const double expected = expected_points(planes, sphere, density);
  if (expected > 2 * allowed) return too_many(expected, density, view.settings());
  Samples all;
  bool full = false;
  in_batches(sphere.rows, kBatch, progress, [&](std::size_t begin, std::size_t end) {
    if (full) return;
    std::vector<Samples> rows(end - begin);
    parallel_for(rows.size(), threads, [&](std::size_t k) {
      for (std::size_t column = 0; column < sphere.columns; ++column) {
        sample_quad(view, sphere, quad_of(planes, begin + k, column), density, rows[k]);
      }
      for (Vec3& point : rows[k].points) {
        if (taken != nullptr && taken->near(point)) point = kNoPoint;
      }
      rows[k].drop_empty();
    });
    for (const Samples& row : rows) all.append(row);
    full = all.points.size() > view.settings().max_points;
  });
  if (full) return too_many(std::max(expected, allowed), density, view.settings());
  all.width = static_cast<std::uint32_t>(all.points.size());
  return all;
}

}  // namespace

Result<Cloud> reconstruct_density(const DecodedScan& scan, double points_per_m2,
                                  const ReconstructSettings& settings,
                                  const ProgressCallback& progress) {
  if (!(points_per_m2 >= 1e-3 && points_per_m2 <= 1e8)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("a density of {} points on a square metre is not from 0.001 to 1e8",
                             points_per_m2)};
  }
  CURLIDAR_TRY(check_kept(settings));
  CURLIDAR_TRY_ASSIGN(view, View::make(scan, settings));
  Cloud coded = coded_returns(scan, settings.threads);
  const Sphere sphere = sphere_of(coded.positions);
  std::optional<TakenPlaces> taken;
  if (settings.keep_originals) {
    taken.emplace(coded.positions, 0.5 / std::sqrt(points_per_m2));
  }
  CURLIDAR_TRY_ASSIGN(
      samples, sample_surfaces(view, sphere, points_per_m2, taken ? &*taken : nullptr, progress));
  if (!settings.keep_originals) return finish(view, std::move(samples));
  return finish_behind(view, std::move(coded), std::move(samples));
}

}  // namespace curlidar
