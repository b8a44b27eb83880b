// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/parallel.hpp"
#include "cloud/neighbours.hpp"
#include "curlidar/metrics.hpp"

namespace curlidar {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Vec3 kUndefined{kNan, kNan, kNan};
constexpr std::array<const char*, 3> kNames{"normal_x", "normal_y", "normal_z"};

/// NaN for what has no direction.
Vec3 unit(const Vec3& v) {
  const double length = norm(v);
  return length > 0 && std::isfinite(length) ? v * (1 / length) : kUndefined;
}

std::vector<Vec3> given_normals(const Cloud& cloud) {
  const Attribute& x = *cloud.find(kNames[0]);
  const Attribute& y = *cloud.find(kNames[1]);
  const Attribute& z = *cloud.find(kNames[2]);
  std::vector<Vec3> normals(cloud.size(), kUndefined);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_return(cloud.positions[i])) continue;
    normals[i] = unit({x.as_double(i), y.as_double(i), z.as_double(i)});
  }
  return normals;
}

/// Signs of principal components mean nothing; seen surfaces face the sensor.
Vec3 towards_origin(const Vec3& normal, const Vec3& point) {
  const double facing = dot(normal, point);
  if (facing != 0) return facing > 0 ? normal * -1 : normal;
  const double first = normal.x != 0 ? normal.x : normal.y != 0 ? normal.y : normal.z;
  return first < 0 ? normal * -1 : normal;
}

/// Normal of the plane through the points `near` and `at` one of them, nearest first.
Vec3 plane_normal(const Cloud& cloud, std::span<const Neighbour> near, const Vec3& at) {
  const double reach = near.back().distance;
  if (near.size() < 3 || !(reach > 0)) return kUndefined;
  // Offsets in units of the reach: their squares neither vanish nor overflow.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : near) {
    const Vec3 d = (cloud.positions[n.slot] - at) * (1 / reach);
    const Eigen::Vector3d offset(d.x, d.y, d.z);
    mean += offset;
    moments += offset * offset.transpose();
  }
  const auto count = static_cast<double>(near.size());
  mean /= count;
  const Eigen::Matrix3d covariance = moments / count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  // A line or a point: rounding alone would choose the plane.
  constexpr double kLine = 1e-12;
  const Eigen::Vector3d& spread = solver.eigenvalues();
  if (solver.info() != Eigen::Success || !(spread[1] > kLine * spread[2])) return kUndefined;
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return towards_origin(unit({normal[0], normal[1], normal[2]}), at);
}

}  // namespace

bool has_normals(const Cloud& cloud) {
  return std::all_of(kNames.begin(), kNames.end(),
                     [&](const char* name) { return cloud.find(name) != nullptr; });
}

std::vector<Vec3> surface_normals(const Cloud& cloud, std::size_t neighbours, std::size_t threads) {
  if (has_normals(cloud)) return given_normals(cloud);
  const ReturnTree tree(cloud, cloud);
  std::vector<Vec3> normals(cloud.size(), kUndefined);
  const std::size_t tasks = (cloud.size() + kQueriesPerTask - 1) / kQueriesPerTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    std::vector<Neighbour> near(std::min(neighbours, tree.size()));
    if (near.empty()) return;
    const std::size_t end = std::min(cloud.size(), (task + 1) * kQueriesPerTask);
    for (std::size_t i = task * kQueriesPerTask; i < end; ++i) {
      const Vec3& at = cloud.positions[i];
      if (!is_return(at)) continue;
      tree.nearest(at, near);
      normals[i] = plane_normal(cloud, near, at);
    }
  });
  return normals;
}

}  // namespace curlidar
