// SPDX-License-Identifier: BSD-3-Clause
#include "register/target_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <nanoflann.hpp>
#include <utility>

#include "base/parallel.hpp"
#include "cloud/kd_points.hpp"

namespace curlidar::registration {
namespace {

constexpr std::size_t kNeighbours = 12;  ///< that a plane is laid through
/// Of the smallest to the middle variance: what is rounder is no plane.
constexpr double kMostRound = 0.1;
constexpr std::size_t kPointsPerLeaf = 10;
constexpr std::size_t kPlanesPerTask = 512;

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, KdPoints>,
                                                 KdPoints, 3, std::uint32_t>;

/// The nearest point within a distance: the bound cuts most of the tree away at once.
class NearestWithin {
 public:
  explicit NearestWithin(double squared) : squared_(squared) {}

  // nanoflann prescribes these names and types.
  using DistanceType = double;
  using IndexType = std::uint32_t;
  using CountType = std::size_t;
  std::size_t size() const { return point != kNoTarget; }
  bool empty() const { return point == kNoTarget; }
  bool full() const { return true; }
  double worstDist() const { return squared_; }
  bool addPoint(double squared, std::uint32_t index) {
    if (squared < squared_) squared_ = squared, point = index;
    return true;
  }
  void sort() {}

  std::uint32_t point = kNoTarget;

 private:
  double squared_;
};

/// The normal of the plane through points; zero if they are none.
Vec3 plane_normal(std::span<const Vec3> points) {
  Vec3 mean{};
  for (const Vec3& p : points) mean = mean + p;
  mean = mean * (1.0 / static_cast<double>(points.size()));
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    const Vec3 d = p - mean;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    spread += v * v.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(spread);
  const auto& variances = solver.eigenvalues();
  if (!(variances[0] < kMostRound * variances[1])) return {};
  const Eigen::Vector3d normal = solver.eigenvectors().col(0).normalized();
  return {normal.x(), normal.y(), normal.z()};
}

}  // namespace

struct TargetSurface::Index {
  KdPoints set;
  std::unique_ptr<Tree> tree;  // refers to set
  std::vector<Vec3> normals;
  std::vector<std::uint8_t> known;  // whether a normal was looked for

  Vec3 normal_at(std::uint32_t point) const {
    const Vec3& p = set.points[point];
    const double query[3] = {p.x, p.y, p.z};
    std::array<std::uint32_t, kNeighbours> found{};
    std::array<double, kNeighbours> squared{};
    const std::size_t count = tree->knnSearch(query, kNeighbours, found.data(), squared.data());
    std::array<Vec3, kNeighbours> near{};
    for (std::size_t i = 0; i < count; ++i) near[i] = set.points[found[i]];
    return plane_normal({near.data(), count});
  }
};

TargetSurface::TargetSurface(std::vector<Vec3> points) : index_(std::make_unique<Index>()) {
  index_->set.points = std::move(points);
  index_->normals.resize(index_->set.points.size());
  index_->known.resize(index_->set.points.size());
  if (index_->set.points.empty()) return;
  index_->tree = std::make_unique<Tree>(3, index_->set,
                                        nanoflann::KDTreeSingleIndexAdaptorParams(kPointsPerLeaf));
}

TargetSurface::~TargetSurface() = default;

const std::vector<Vec3>& TargetSurface::points() const {
  return index_->set.points;
}

std::uint32_t TargetSurface::nearest(const Vec3& query, double within_m) const {
  if (!index_->tree) return kNoTarget;
  const double coordinates[3] = {query.x, query.y, query.z};
  NearestWithin result(within_m * within_m);
  index_->tree->findNeighbors(result, coordinates, {});
  return result.point;
}

void TargetSurface::make_planes(std::span<const std::uint32_t> wanted, std::size_t threads) {
  std::vector<std::uint32_t> missing;
  for (const std::uint32_t point : wanted) {
    if (point == kNoTarget || index_->known[point] != 0) continue;
    index_->known[point] = 1;
    missing.push_back(point);
  }
  const std::size_t tasks = (missing.size() + kPlanesPerTask - 1) / kPlanesPerTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(missing.size(), (task + 1) * kPlanesPerTask);
    for (std::size_t i = task * kPlanesPerTask; i < end; ++i) {
      index_->normals[missing[i]] = index_->normal_at(missing[i]);
    }
  });
}

const Vec3& TargetSurface::normal(std::uint32_t point) const {
  return index_->normals[point];
}

}  // namespace curlidar::registration
