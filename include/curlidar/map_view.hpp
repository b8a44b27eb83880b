// SPDX-License-Identifier: BSD-3-Clause
// A surface map looked at: along lines of sight, as a sensor, beside a reference.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/map_tile.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"

namespace curlidar {

/// A line of sight in the map's frame; `direction` is a unit vector.
struct MapRay {
  Vec3 origin{}, direction{1, 0, 0};
};

/// Where a line of sight met the map.
struct MapHit {
  double range_m = std::numeric_limits<double>::infinity();  ///< infinite: it met nothing
  Vec3 normal{};  ///< of the surface, a unit vector towards where the line came from
  float intensity = std::numeric_limits<float>::quiet_NaN();  ///< of the leaf; NaN: none
  std::uint32_t tile = 0, leaf = 0;  ///< tiles()[tile].leaves[leaf] of the scene

  bool found() const { return range_m < std::numeric_limits<double>::infinity(); }
};

struct MapSceneSettings {
  /// Leaves meet each other with small steps, through which a line would slip. So a line that meets
  /// no surface proper meets a leaf also this far beside its footprint and cube, in edges of a
  /// footprint's cell (0 .. 1).
  double gap_cells = 0.5;
};

/// The leaves of some tiles, ready to be looked at. Of a leaf's surface that counts which lies
/// under the footprint and does not leave the cube by more than 5 cm. About 250 bytes a leaf more
/// than the tiles.
class MapScene {
 public:
  /// Errors: invalid_argument (a leaf that makes no sense, a setting out of its range).
  /// O(n log n).
  static Result<MapScene> make(std::vector<MapTile> tiles, const MapSceneSettings& settings = {});
  ~MapScene();
  MapScene(MapScene&&) noexcept;
  MapScene& operator=(MapScene&&) noexcept;

  const std::vector<MapTile>& tiles() const;
  std::size_t leaves() const;  ///< with a surface that counts
  /// Of the mean over them all; false if no leaf holds one.
  bool has_intensity() const;

  /// The first surface along the ray and not beyond `max_range_m`; of equally near leaves the first
  /// in the order of tiles and leaves. May be called from several threads. About 1 us.
  MapHit cast(const MapRay& ray,
              double max_range_m = std::numeric_limits<double>::infinity()) const;
  /// One hit for each ray, whatever the number of threads (0 = all cores).
  std::vector<MapHit> cast(std::span<const MapRay> rays, double max_range_m,
                           std::size_t threads = 1) const;

  /// From a point to the nearest place of the continuous surface, at most `max_m`. Exact for
  /// planes; a cell of a curved leaf counts as 4 x 4 tangent planes.
  double distance(const Vec3& point, double max_m) const;

 private:
  struct Data;
  explicit MapScene(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

struct SampleMapSettings {
  bool beam_origins = true;  ///< beams start where the profile says; else all at its origin
  bool normals = false;      ///< attributes normal_x, normal_y, normal_z, in the sensor's frame
  std::size_t threads = 1;   ///< never changes the result; 0 = all cores
};

/// The scan that a spinning sensor standing still at T_map_sensor would take of the map, in the
/// sensor's frame. Organised: rings from the top, columns from azimuth -pi on; NaN where nothing
/// lies within the sensor's limits of range. Attributes ring (uint16) and, if the scene has it,
/// intensity (float32; NaN where there is none).
/// Errors: invalid_argument (a bad profile or pose), unsupported (not a spinning sensor).
Result<Cloud> sample_map(const MapScene& scene, const SensorProfile& sensor,
                         const RigidMotion& T_map_sensor, const SampleMapSettings& settings = {});

/// What a virtual sensor at T_map_sensor finds along the lines of sight of a scan's returns, in the
/// sensor's frame: one point for each slot of the scan, NaN where there was no return or the map
/// has nothing up to max_range_m. All lines start at the sensor's origin.
/// Errors: invalid_argument (a bad pose).
Result<Cloud> sample_map_along(const MapScene& scene, const Cloud& scan,
                               const RigidMotion& T_map_sensor, double max_range_m,
                               const SampleMapSettings& settings = {});

/// A point on the surface of a map, or of anything.
struct SurfacePoint {
  Vec3 position{};
  std::array<float, 3> normal{};                              ///< a unit vector either way, or 0
  float intensity = std::numeric_limits<float>::quiet_NaN();  ///< NaN: unknown

  friend bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

/// A random subset of points that come one by one: each is in it with the same probability, and
/// the same points give the same subset. Holds at most `capacity` of them, or, once there were
/// more, about half of that or more.
class PointSubset {
 public:
  explicit PointSubset(std::size_t capacity, std::uint64_t seed = 1)
      : capacity_(capacity), seed_(seed) {}

  /// Points that are no returns are passed over.
  void add(const SurfacePoint& point);
  std::size_t seen() const { return seen_; }
  const std::vector<SurfacePoint>& points() const { return points_; }
  /// All that were seen are in it.
  bool complete() const { return seen_ == points_.size(); }
  /// As an unorganised cloud, float32 if that tells less than a millimetre apart, else float64.
  /// Attributes: intensity if any point has one; with `normals` normal_x, normal_y, normal_z.
  Cloud cloud(bool normals = false) const;

 private:
  std::size_t capacity_, seen_ = 0;
  std::uint64_t seed_;
  std::uint64_t limit_ = std::numeric_limits<std::uint64_t>::max();  ///< of the points' lots
  std::vector<SurfacePoint> points_;
  std::vector<std::uint64_t> lots_;
};

/// Points on the surface of a map, not farther than `spacing_m` from each other along u and v of
/// every leaf: a random subset of at most `max_points`. Normals point up, or along their axis.
/// Errors: invalid_argument (a spacing below 1 mm, no points at all).
Result<PointSubset> map_points(const std::vector<MapTile>& tiles, double spacing_m,
                               std::size_t max_points, std::uint64_t seed = 1);

struct MapCompareSettings {
  double spacing_m = 0.05;    ///< of the points that stand for the map's surface
  double max_distance_m = 1;  ///< larger distances count as this one
  std::vector<double> thresholds = {0.05, 0.1, 0.2};  ///< m, of the shares and F
  /// Points of the map outside of the bounding box of the reference do not count.
  bool crop = false;
  std::size_t max_points = 4'000'000;  ///< of the map; a random subset beyond
  std::uint64_t seed = 1;              ///< of that subset
  std::size_t threads = 1;             ///< never changes the result; 0 = all cores
};

/// Statistics of capped distances, metres; all zero if there is none.
struct MapDistances {
  std::size_t count = 0;
  double mean = 0, rms = 0, p50 = 0, p95 = 0, max = 0;
  double capped = 0;           ///< share that is as large as the cap
  std::vector<double> within;  ///< shares within the thresholds
};

struct MapComparison {
  std::size_t map_points = 0;  ///< on the surface at that spacing; accuracy.count were measured
  MapDistances accuracy;       ///< from points of the map to the nearest point of the reference
  /// From points of the reference to the map: to its continuous surface, and to the nearest of the
  /// points that stand for it, what figures of other maps mostly are.
  MapDistances completeness, completeness_points;
  std::vector<double> f_scores;  ///< of accuracy and completeness, one for each threshold
  /// Points of the map, in its frame: PointSubset::cloud with "error" (float32, metres).
  Cloud samples;
  std::vector<float> reference_errors;  ///< to the surface, one a slot of the reference; NaN
};

/// How far a map and a reference in the same frame are from each other. Nearest neighbours are
/// exact. What the reference has not seen counts as wrong in the map, unless cropped.
/// Errors: invalid_argument (a setting out of its range, a map or reference without a point).
Result<MapComparison> compare_map(const MapScene& scene, const Cloud& reference,
                                  const MapCompareSettings& settings = {});

}  // namespace curlidar
