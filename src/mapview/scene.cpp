// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/bvh.hpp"
#include "base/parallel.hpp"
#include "base/try.hpp"
#include "curlidar/map_view.hpp"
#include "mapview/leaf_shape.hpp"

namespace curlidar {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kRaysPerTask = 1024;
/// Metres and slopes that no map reaches.
constexpr double kLargest = 1e7;

bool finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}
bool moderate(double value) {
  return std::abs(value) < kLargest;
}  // false for NaN

Status check_leaf(const MapTile& tile, std::size_t index) {
  const MapLeaf& leaf = tile.leaves[index];
  const std::size_t cells = std::size_t{leaf.cells} * leaf.cells;
  const bool numbers = moderate(leaf.centre.x) && moderate(leaf.centre.y) &&
                       moderate(leaf.centre.z) && moderate(leaf.height_m) &&
                       moderate(leaf.slope[0]) && moderate(leaf.slope[1]) &&
                       moderate(leaf.curve[0]) && moderate(leaf.curve[1]) &&
                       moderate(leaf.curve[2]) && leaf.size_m > 0 && moderate(leaf.size_m);
  const bool footprint = leaf.cells > 0 && leaf.first_cell <= tile.footprint.size() &&
                         cells <= tile.footprint.size() - leaf.first_cell;
  if (numbers && footprint && leaf.axis < 3 && finite(tile.origin)) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("leaf {} of the tile ({}, {}) makes no sense: its {} is out of range",
                           index, tile.key.x, tile.key.y, footprint ? "shape" : "footprint")};
}

}  // namespace

struct MapScene::Data {
  std::vector<MapTile> tiles;
  Vec3 origin{};  ///< of the shapes
  /// In the order of the tree.
  struct Place {
    std::uint32_t tile, leaf;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  std::vector<LeafShape> shapes;
  std::vector<Place> places;
  Bvh tree;
  bool has_intensity = false;
};

MapScene::MapScene(std::unique_ptr<Data> data) : data_(std::move(data)) {}
MapScene::~MapScene() = default;
MapScene::MapScene(MapScene&&) noexcept = default;
MapScene& MapScene::operator=(MapScene&&) noexcept = default;

const std::vector<MapTile>& MapScene::tiles() const {
  return data_->tiles;
}
std::size_t MapScene::leaves() const {
  return data_->shapes.size();
}
bool MapScene::has_intensity() const {
  return data_->has_intensity;
}

Result<MapScene> MapScene::make(std::vector<MapTile> tiles, const MapSceneSettings& settings) {
  if (!(settings.gap_cells >= 0 && settings.gap_cells <= 1)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("a gap of {} cells: give 0 to 1", settings.gap_cells)};
  }
  auto data = std::make_unique<Data>();
  data->tiles = std::move(tiles);
  if (!data->tiles.empty()) data->origin = data->tiles.front().origin;
  std::vector<LeafShape> shapes;
  std::vector<Data::Place> places;
  std::vector<Bounds> bounds;
  for (std::size_t t = 0; t < data->tiles.size(); ++t) {
    const MapTile& tile = data->tiles[t];
    for (std::size_t l = 0; l < tile.leaves.size(); ++l) {
      CURLIDAR_TRY(check_leaf(tile, l));
      const MapLeaf& leaf = tile.leaves[l];
      const LeafShape shape(tile, leaf, tile.origin - data->origin, settings.gap_cells);
      const auto around = shape.bounds();
      if (!around) continue;
      shapes.push_back(shape);
      bounds.push_back(*around);
      places.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(l)});
      data->has_intensity = data->has_intensity || std::isfinite(leaf.intensity);
    }
  }
  data->tree = Bvh(bounds);
  data->shapes.reserve(shapes.size());
  data->places.reserve(shapes.size());
  for (const std::uint32_t i : data->tree.order()) {
    data->shapes.push_back(shapes[i]);
    data->places.push_back(places[i]);
  }
  return MapScene(std::move(data));
}

MapHit MapScene::cast(const MapRay& ray, double max_range_m) const {
  const Vec3 origin = ray.origin - data_->origin;
  if (!finite(origin) || !finite(ray.direction)) return {};
  struct Nearest {
    double t = kInfinity;
    std::uint32_t shape = 0;
  } surface, margin;
  const auto offer = [&](Nearest& nearest, double t, std::uint32_t shape) {
    if (t < nearest.t ||
        (t == nearest.t && t < kInfinity && data_->places[shape] < data_->places[nearest.shape])) {
      nearest = {t, shape};
    }
  };
  const double limit = std::nextafter(max_range_m, kInfinity);
  data_->tree.traverse(origin, ray.direction, limit, [&](std::uint32_t i, double& t_max) {
    const LeafCrossing crossing = data_->shapes[i].cross(origin, ray.direction, t_max);
    offer(surface, crossing.surface, i);
    offer(margin, crossing.margin, i);
    // Equally near leaves must still be seen.
    t_max = std::min(limit, std::nextafter(surface.t, kInfinity));
  });
  const Nearest& nearest = surface.t < kInfinity ? surface : margin;
  MapHit hit;
  if (!(nearest.t < kInfinity)) return hit;
  const LeafShape& shape = data_->shapes[nearest.shape];
  hit.range_m = nearest.t;
  hit.normal = shape.normal(origin + ray.direction * nearest.t);
  if (dot(hit.normal, ray.direction) > 0) hit.normal = hit.normal * -1;
  hit.intensity = shape.intensity();
  hit.tile = data_->places[nearest.shape].tile;
  hit.leaf = data_->places[nearest.shape].leaf;
  return hit;
}

std::vector<MapHit> MapScene::cast(std::span<const MapRay> rays, double max_range_m,
                                   std::size_t threads) const {
  std::vector<MapHit> hits(rays.size());
  const std::size_t tasks = (rays.size() + kRaysPerTask - 1) / kRaysPerTask;
  parallel_for(tasks, threads, [&](std::size_t task) {
    const std::size_t end = std::min(rays.size(), (task + 1) * kRaysPerTask);
    for (std::size_t i = task * kRaysPerTask; i < end; ++i) hits[i] = cast(rays[i], max_range_m);
  });
  return hits;
}

double MapScene::distance(const Vec3& point, double max_m) const {
  const Vec3 from = point - data_->origin;
  double least = max_m;
  if (!finite(from)) return least;
  data_->tree.around(from, max_m, [&](std::uint32_t i, double& reach) {
    least = reach = data_->shapes[i].distance(from, reach);
  });
  return least;
}

}  // namespace curlidar
