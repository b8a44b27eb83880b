// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "support/scene_field.hpp"

namespace curlidar {
namespace {

using test::BoxScene;

DecodedScan box(bool screen) {
  return test::exact_scan(std::make_shared<BoxScene>(screen), test::small_sensor());
}

/// How many triangles share each edge, by its ends in order.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges_of(const SurfaceMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      ++edges[{low, high}];
    }
  }
  return edges;
}

double longest_edge(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, norm(mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]));
  }
  return longest;
}

/// A cylinder without a bottom: one surface all around.
class PipeScene : public Scene {
 public:
  bool cast(const Vec3&, const Vec3& direction, Hit& hit) const override {
    hit.range_m = 10 / std::hypot(direction.x, direction.y);
    return true;
  }
};

TEST(ReconstructMesh, OneSurfaceAllAroundIsClosedButForItsRims) {
  const DecodedScan scan = test::exact_scan(std::make_shared<PipeScene>(), test::small_sensor());
  for (const auto& [rows, columns] : {std::pair{1.0, 1.0}, {1.5, 0.3}, {0.4, 1.7}}) {
    const SurfaceMesh mesh = reconstruct_mesh(scan, {.rows = rows, .columns = columns}).value();
    const DenseGrid grid(scan.field->lattice(), rows, columns);
    EXPECT_EQ(mesh.vertices.size(), grid.rows * grid.columns);
    EXPECT_EQ(mesh.triangles.size(), 2 * (grid.rows - 1) * grid.columns);
    std::map<int, std::size_t> shared;
    for (const auto& [edge, count] : edges_of(mesh)) ++shared[count];
    EXPECT_EQ(shared[1], 2 * grid.columns);  // the rims
    EXPECT_EQ(shared.size(), 2u);            // all others belong to two triangles
  }
}

TEST(ReconstructMesh, FrontsAndNormalsLookAtTheSensor) {
  const SurfaceMesh mesh = reconstruct_mesh(box(true), {.normals = true}).value();
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    const Vec3 front = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    ASSERT_LT(dot(front, a), 0);
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    ASSERT_NEAR(norm(mesh.normals[i]), 1, 1e-9);
    ASSERT_LT(dot(mesh.normals[i], mesh.vertices[i]), 0);
  }
}

TEST(ReconstructMesh, CliffsAreCut) {
  const DecodedScan scan = box(true);
  const SurfaceMesh mesh = reconstruct_mesh(scan, {.rows = 2}).value();
  const auto on_screen = [](const Vec3& p) {
    return std::abs(p.x - BoxScene::kScreenX) < 1e-9 && std::abs(p.y) < BoxScene::kScreenHalfY;
  };
  std::size_t screen = 0;
  for (const auto& t : mesh.triangles) {
    // The screen stands on the floor, which is no cliff.
    const bool between = std::all_of(t.begin(), t.end(), [&](std::uint32_t corner) {
      const double z = mesh.vertices[corner].z;
      return z > BoxScene::kFloor + 1e-9 && z < BoxScene::kCeiling - 1e-9;
    });
    if (!between) continue;
    const auto count = std::count_if(
        t.begin(), t.end(), [&](std::uint32_t corner) { return on_screen(mesh.vertices[corner]); });
    ASSERT_TRUE(count == 0 || count == 3);
    screen += count == 3 ? 1 : 0;
    ASSERT_LT(longest_edge(mesh, t), 1.2);
  }
  EXPECT_GT(screen, 300u);
}

TEST(ReconstructMesh, OfACompactFileLosesLittleAndCutsCliffs) {
  const DecodedScan scan = test::compact_scan(BoxScene(true), test::small_sensor(32, 512), 0.01);
  const SurfaceMesh mesh = reconstruct_mesh(scan, {}).value();
  EXPECT_GT(mesh.vertices.size(), 31u * 512u);
  EXPECT_GT(mesh.triangles.size(), 2u * 31u * 512u * 95u / 100u);
  const auto far = std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                                 [&](const auto& t) { return longest_edge(mesh, t) > 1.5; });
  EXPECT_LT(far, 5);  // a cliff is 4 m
}

TEST(ReconstructMesh, SmallAndEmptyOnes) {
  const SurfaceMesh row = reconstruct_mesh(box(false), {.rows = 1.0 / 24}).value();
  EXPECT_TRUE(row.triangles.empty() && row.vertices.empty());
  EXPECT_TRUE(reconstruct_mesh(box(false), {.columns = 1.0 / 256})->triangles.empty());
  ReconstructSettings part;
  part.region = ScanRegion{.azimuth_begin = 0, .azimuth_end = 0.5};
  const SurfaceMesh sector = reconstruct_mesh(box(false), part).value();
  EXPECT_GT(sector.triangles.size(), 500u);
  for (const Vec3& p : sector.vertices) {
    ASSERT_GE(azimuth_of(p), -1e-12);
    ASSERT_LT(azimuth_of(p), 0.5);
  }
  EXPECT_EQ(reconstruct_mesh(box(false), {.max_points = 100}).error().code,
            ErrorCode::limit_exceeded);
  EXPECT_EQ(reconstruct_mesh(box(false), {.organised = true}).error().code,
            ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace curlidar
