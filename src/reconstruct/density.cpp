// SPDX-License-Identifier: BSD-3-Clause
// As many points as wished on every square metre of surface.
//
// The sphere is divided into quads, whose planes tell how much surface each direction shows. A quad
// is divided into candidates so fine that each stands for less than a point; a candidate is
// taken if its share of a point is above its threshold, one of a sequence that is spread evenly
// over rows and columns (R2: multiples of the powers of the plastic number). What is taken is
// looked for in the field itself, so nothing lies where the field does not believe in a surface.
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "reconstruct/candidates.hpp"
#include "reconstruct/coded.hpp"
#include "reconstruct/finish.hpp"
#include "reconstruct/originals.hpp"
#include "reconstruct/quads.hpp"

namespace curlidar {
namespace {

/// A wish that is kept on every quad of the sphere.
struct Wish {
  const Sphere& sphere;
  const CornerPlanes& planes;
  double density;
};

Error too_many(double points, double density, std::uint64_t allowed) {
  return {ErrorCode::limit_exceeded,
          fmt::format("{} points on every square metre are about {:.3g} in all, more than the {} "
                      "allowed: wish for fewer, or for a part of the scan",
                      density, points, allowed)};
}

/// Limit_exceeded where the wish cannot be kept.
Status check_wish(const Wish& wish, std::size_t kept, const ReconstructSettings& settings) {
  const double points =
      wish.planes.square_metres(wish.sphere) * wish.density + static_cast<double>(kept);
  if (!(points <= static_cast<double>(settings.max_points))) {
    return too_many(points, wish.density, settings.max_points);
  }
  for (std::size_t row = 0; row < wish.sphere.rows; ++row) {
    for (std::size_t column = 0; column < wish.sphere.columns; ++column) {
      const Quad quad = wish.planes.quad(row, column);
      if (division_of(quad, wish.sphere, wish.density)) continue;
      return Error{ErrorCode::limit_exceeded,
                   fmt::format("surfaces are too far away for {} points on every square metre: "
                               "wish for fewer, or for a part of the scan",
                               wish.density)};
    }
  }
  return {};
}

/// Stops soon after there are more than `most`, which are too many.
Samples sample_surfaces(const ScanView& view, const Wish& wish, const TakenPlaces* taken,
                        std::uint64_t most, const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 8;
  Samples all;
  in_batches(wish.sphere.rows, kBatch, progress, [&](std::size_t begin, std::size_t end) {
    if (all.points.size() > most) return;
    std::vector<Samples> rows(end - begin);
    parallel_for(rows.size(), view.settings().threads, [&](std::size_t k) {
      for (std::size_t column = 0; column < wish.sphere.columns; ++column) {
        const Quad quad = wish.planes.quad(begin + k, column);
        const auto division = division_of(quad, wish.sphere, wish.density);
        if (division) sample_quad(view, wish.sphere, quad, *division, rows[k]);
      }
      for (Vec3& point : rows[k].points) {
        if (taken != nullptr && taken->near(point)) point = kNowherePoint;
      }
      rows[k].drop_empty();
    });
    for (const Samples& row : rows) all.append(row);
  });
  all.width = static_cast<std::uint32_t>(all.points.size());
  return all;
}

}  // namespace

Result<Cloud> reconstruct_density(const DecodedScan& scan, double points_per_m2,
                                  const ReconstructSettings& settings,
                                  const ProgressCallback& progress) {
  if (!(points_per_m2 >= kLeastDensity && points_per_m2 <= kMostDensity)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("a density of {} points on a square metre is not from {} to {}",
                             points_per_m2, kLeastDensity, kMostDensity)};
  }
  CURLIDAR_TRY(check_kept(settings));
  CURLIDAR_TRY_ASSIGN(view, ScanView::make(scan, settings));
  Cloud coded = coded_returns(scan, settings.threads);
  const Sphere sphere = sphere_of(coded.positions);
  const CornerPlanes planes(view, sphere, progress);
  const Wish wish{sphere, planes, points_per_m2};
  const std::size_t kept = settings.keep_originals ? coded.size() : 0;
  CURLIDAR_TRY(check_wish(wish, kept, settings));
  std::optional<TakenPlaces> taken;
  if (settings.keep_originals) taken.emplace(coded.positions, 0.5 / std::sqrt(points_per_m2));
  const std::uint64_t most = settings.max_points - kept;
  Samples samples = sample_surfaces(view, wish, taken ? &*taken : nullptr, most, progress);
  if (samples.points.size() > most) {
    return too_many(static_cast<double>(samples.points.size() + kept), points_per_m2,
                    settings.max_points);
  }
  if (!settings.keep_originals) return finish(view, std::move(samples));
  return finish_behind(view, std::move(coded), std::move(samples));
}

}  // namespace curlidar
