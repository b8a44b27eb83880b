// SPDX-License-Identifier: BSD-3-Clause
#include "codec/pose_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "compact/cell_finder.hpp"
#include "compact/prediction.hpp"
#include "compact/ray_points.hpp"
#include "compact/row_offsets.hpp"

namespace curlidar {
namespace {

using Vector6 = std::array<double, 6>;
using Matrix6 = std::array<Vector6, 6>;

constexpr double kUnit = compact::kRangeUnit;
constexpr std::size_t kSamples = 24000;
/// Distances beyond this count alike when poses are compared, metres.
constexpr double kFar_m = 0.3;

/// A return of the reference with the normal of its surface.
struct Sample {
  Vec3 point, normal;
};

/// A rotation by a vector of small angles, with the format's own series.
RigidMotion turned_by(const Vec3& turn) {
  const auto q30 = [](double x) { return std::llround(std::clamp(x, -1.9, 1.9) * (1 << 30)); };
  const compact::Turn w{q30(turn.x), q30(turn.y), q30(turn.z)};
  constexpr std::int64_t one = 1 << 30;
  const auto column = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const compact::FixedPoint p = compact::turned(w, {x, y, z});
    return Vec3{static_cast<double>(p.x) / one, static_cast<double>(p.y) / one,
                static_cast<double>(p.z) / one};
  };
  const Vec3 x = column(one, 0, 0), y = column(0, one, 0), z = column(0, 0, one);
  RigidMotion out;
  out.rotation = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
  return out;
}

/// From the frame of a lattice's centre to that of the cloud: what the motion of the scan has done
/// to it at azimuth 0.
RigidMotion cloud_from_centre(const compact::RowTable& table) {
  RigidMotion out;
  if (!table.rays) return out;
  const compact::Motion& motion = table.rays->motion;
  const auto vector = [](const compact::Motion::Triple& t, double unit) {
    return Vec3{t[0] * unit, t[1] * unit, t[2] * unit};
  };
  out = turned_by(vector(motion.rigid_turn, 1.0 / (1 << 30)));
  out.move = vector(motion.rigid_move, 1 / kUnit) +
             out.turned({0, 0, compact::centre_height(*table.rays) / kUnit});
  return out;
}

/// The rotation vector of a motion: Newton on the format's own series.
Vec3 turn_of(const RigidMotion& motion) {
  Vec3 turn{};
  for (int pass = 0; pass < 12; ++pass) {
    const RigidMotion left = motion * turned_by(turn).inverse();
    const auto& r = left.rotation;
    turn = turn + Vec3{r[2].y - r[1].z, r[0].z - r[2].x, r[1].x - r[0].y} * 0.5;
  }
  return turn;
}

compact::RelativePose rounded(const RigidMotion& motion) {
  compact::RelativePose pose;
  const Vec3 turn = turn_of(motion);
  const auto unit = [](double x, unsigned bits, std::int32_t most) {
    const double scaled = std::clamp(x * std::ldexp(1.0, static_cast<int>(bits)),
                                     -static_cast<double>(most), static_cast<double>(most));
    return static_cast<std::int32_t>(std::llround(scaled));
  };
  const std::array<double, 3> turns{turn.x, turn.y, turn.z},
      moves{motion.move.x, motion.move.y, motion.move.z};
  for (std::size_t i = 0; i < 3; ++i) {
    pose.turn[i] =
        unit(turns[i], compact::RelativePose::kTurnBits, compact::RelativePose::kMostTurn);
    pose.move[i] =
        unit(moves[i], compact::RelativePose::kMoveBits, compact::RelativePose::kMostMove);
  }
  return pose;
}

class PoseSearch {
 public:
  PoseSearch(const compact::DecodedScan& reference, const CompactModel& model)
      : model_(model),
        finder_(model.table, model.image.rows, model.image.columns),
        sights_(model.table, model.image.rows, model.image.columns) {
    take_samples(reference);
  }

  /// Mean distance of the samples from the scan, those that find nothing counted as far.
  double cost(const RigidMotion& pose) const {
    double sum = 0;
    for (const Sample& sample : samples_) {
      Pair pair;
      sum += match(sample, pose, pair) ? std::min(std::abs(pair.distance), kFar_m) : kFar_m;
    }
    return samples_.empty() ? kFar_m : sum / static_cast<double>(samples_.size());
  }

  RigidMotion refine(RigidMotion pose) const {
    constexpr std::array<double, 14> kScales = {1.5,  1.0, 0.7,  0.5,  0.35, 0.25, 0.18,
                                                0.12, 0.1, 0.08, 0.06, 0.06, 0.05, 0.05};
    for (const double scale : kScales) {
      const std::optional<RigidMotion> step = step_at(pose, scale);
      if (!step) break;
      pose = *step * pose;
    }
    return pose;
  }

 private:
  struct Pair {
    Vec3 point, normal;
    double distance = 0;  ///< of the scan's return from the moved plane
  };

  void take_samples(const compact::DecodedScan& reference) {
    const std::uint32_t columns = reference.parameters.columns;
    const compact::Sights sights(reference.table, reference.parameters.rows, columns);
    const auto returns = static_cast<std::size_t>(std::count_if(
        reference.range.begin(), reference.range.end(), [](auto range) { return range > 0; }));
    const std::size_t every = std::max<std::size_t>(1, returns / kSamples);
    std::size_t number = 0;
    for (std::size_t cell = 0; cell < reference.range.size(); ++cell) {
      if (reference.range[cell] <= 0 || reference.surface[cell] < 0) continue;
      if (number++ % every != 0) continue;
      const compact::Sight sight = sights.at(cell);
      const compact::Plane n = surface_in(reference, cell).plane;
      const Vec3 normal{static_cast<double>(n.x), static_cast<double>(n.y),
                        static_cast<double>(n.z)};
      const double length = norm(normal);
      if (!(length > 0)) continue;
      const auto row = static_cast<std::uint32_t>(cell / columns);
      samples_.push_back({along(sight, reference.range[cell] - offset_of(reference.table, row)),
                          normal * (1 / length)});
    }
  }

  static Vec3 along(const compact::Sight& sight, double range) {
    const double r = range / kUnit / (1 << 22);
    return {sight.origin.x / kUnit + sight.direction.x * r,
            sight.origin.y / kUnit + sight.direction.y * r,
            sight.origin.z / kUnit + sight.direction.z * r};
  }

  bool match(const Sample& sample, const RigidMotion& pose, Pair& out) const {
    out.point = pose(sample.point);
    const auto unit = [](double x) { return std::llround(std::clamp(x, -4000.0, 4000.0) * kUnit); };
    const std::int64_t at =
        finder_.cell_of({unit(out.point.x), unit(out.point.y), unit(out.point.z)});
    if (at < 0) return false;
    const auto cell = static_cast<std::size_t>(at);
    const std::int32_t range = model_.image.range[cell];
    if (range <= 0) return false;
    const auto row = static_cast<std::uint32_t>(cell / model_.image.columns);
    out.normal = pose.turned(sample.normal);
    out.distance =
        dot(out.normal, along(sights_.at(cell), range - offset_of(model_.table, row)) - out.point);
    return true;
  }

  /// One step of least squares under weights that forget what is far.
  std::optional<RigidMotion> step_at(const RigidMotion& pose, double scale) const {
    Matrix6 a{};
    Vector6 b{};
    std::size_t used = 0;
    for (const Sample& sample : samples_) {
      Pair pair;
      if (!match(sample, pose, pair) || std::abs(pair.distance) > 4 * scale) continue;
      const double u = pair.distance / scale, w = 1 / ((1 + u * u) * (1 + u * u));
      const Vec3 turn{pair.point.y * pair.normal.z - pair.point.z * pair.normal.y,
                      pair.point.z * pair.normal.x - pair.point.x * pair.normal.z,
                      pair.point.x * pair.normal.y - pair.point.y * pair.normal.x};
      const Vector6 j{turn.x, turn.y, turn.z, pair.normal.x, pair.normal.y, pair.normal.z};
      for (std::size_t i = 0; i < 6; ++i) {
        b[i] += w * j[i] * pair.distance;
        for (std::size_t k = 0; k <= i; ++k) a[i][k] += w * j[i] * j[k];
      }
      ++used;
    }
    if (used < 50) return std::nullopt;
    const Vector6 x = solved(a, b);
    RigidMotion step = turned_by({x[0], x[1], x[2]});
    step.move = {x[3], x[4], x[5]};
    return step;
  }

  /// Cholesky, with a little added where nothing is known.
  static Vector6 solved(Matrix6& a, Vector6 b) {
    for (std::size_t i = 0; i < 6; ++i) a[i][i] += 1e-6 + 1e-9 * a[i][i];
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k <= i; ++k) {
        double sum = a[i][k];
        for (std::size_t m = 0; m < k; ++m) sum -= a[i][m] * a[k][m];
        a[i][k] = i == k ? std::sqrt(std::max(sum, 1e-12)) : sum / a[k][k];
      }
    }
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
      b[i] /= a[i][i];
    }
    for (std::size_t i = 6; i-- > 0;) {
      for (std::size_t k = i + 1; k < 6; ++k) b[i] -= a[k][i] * b[k];
      b[i] /= a[i][i];
    }
    return b;
  }

  const CompactModel& model_;
  compact::CellFinder finder_;
  compact::Sights sights_;
  std::vector<Sample> samples_;
};

}  // namespace

compact::RelativePose find_pose(const compact::DecodedScan& reference, const CompactModel& model,
                                const std::vector<RigidMotion>& guesses) {
  const PoseSearch search(reference, model);
  const RigidMotion before = cloud_from_centre(reference.table),
                    now = cloud_from_centre(model.table);
  RigidMotion best;
  double least = search.cost(best);
  for (const RigidMotion& T_reference_scan : guesses) {
    const RigidMotion guess = now.inverse() * T_reference_scan.inverse() * before;
    for (const RigidMotion& pose : {guess, search.refine(guess)}) {
      const double cost = search.cost(pose);
      if (cost >= least) continue;
      least = cost;
      best = pose;
    }
  }
  return rounded(best);
}

}  // namespace curlidar
