// SPDX-License-Identifier: BSD-3-Clause
// Maps in files: built from scans with poses in bounded memory, read tile by tile, made longer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/map_settings.hpp"
#include "curlidar/map_tile.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

class RandomAccess;

/// What a map is made of.
enum class MapKind {
  surface,  ///< the surface of the world, fused from all scans, in independent tiles
  scans,    ///< the scans of keyframes with their poses, as the CURL paper has it
};
const char* to_string(MapKind kind);  ///< "surface", "scans"

/// What the start of a map file tells of it all.
struct MapHeader {
  MapKind kind = MapKind::surface;
  /// Tiles and poses are told from here, in the frame of the poses, metres. Near to what is mapped,
  /// however far from zero that is.
  Vec3 origin{};
  double tile_side_m = 32;    ///< surface maps
  double thinning_m = 0.05;   ///< surface maps: edge of the cubes that hold a sample each
  SurfaceSettings surface{};  ///< surface maps
  double min_range_m = 2.5, max_range_m = 80;  ///< of the returns that were taken
  std::uint64_t scans = 0;                     ///< that were taken
  double travelled_m = 0;  ///< along the positions of all scans that were offered
  std::map<std::string, std::string> metadata;
};

/// invalid_argument unless every value makes sense.
Status validate(const MapHeader& header);

/// A box with its sides along the axes of the map's frame; metres.
struct MapBox {
  Vec3 low{}, high{};
};

/// What the index of a surface map tells of a tile.
struct MapTileEntry {
  TileKey key;
  std::uint64_t bytes = 0;  ///< of its part, without frame and index
  MapBox box;               ///< around all of its leaves' surface, in the map's frame
  std::uint32_t leaves = 0;
};

/// What the index of a map of scans tells of one.
struct MapScanEntry {
  std::uint64_t bytes = 0;
  MapBox box;  ///< around its points
  std::uint32_t points = 0;
};

/// A keyframe of a map of scans.
struct MapScan {
  RigidMotion T_map_sensor;
  std::optional<double> time_s;
  std::vector<std::byte> file;  ///< a whole .curl file
};

struct MapReadOptions {
  TileLimits tile{};
  /// Takes a map without its end, or with a damaged index: what is whole of it.
  bool allow_truncated = false;
};

/// A map file, opened; tiles and scans are read when asked for. Many threads may read at once.
class MapFile {
 public:
  /// Errors: not_found, io; corrupt, unsupported, limit_exceeded; invalid_argument (a .curl file of
  /// one scan, or a sequence).
  static Result<MapFile> open(const std::string& path, const MapReadOptions& options = {});
  /// The same from bytes; `name` is used for messages.
  static Result<MapFile> read(std::vector<std::byte> bytes, const std::string& name,
                              const MapReadOptions& options = {});
  ~MapFile();
  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;

  const MapHeader& header() const;
  const std::vector<MapTileEntry>& tiles() const;  ///< sorted by key; empty for maps of scans
  const std::vector<MapScanEntry>& scans() const;  ///< in the order of the drive
  std::uint64_t file_bytes() const;
  std::uint64_t index_bytes() const;  ///< index, footer and end
  /// What should be there and is not, one sentence each.
  const std::vector<std::string>& missing() const;
  /// Around everything; nothing if the map is empty.
  std::optional<MapBox> extent() const;

  /// Indices of the tiles, or scans, whose box meets this one.
  std::vector<std::size_t> parts_in(const MapBox& box) const;
  /// Corrupt: this tile is damaged; others may not be. `max_level`: leaves below it are merged.
  Result<MapTile> read_tile(std::size_t tile, std::uint32_t max_level = 255) const;
  Result<MapScan> read_scan(std::size_t scan) const;
  /// A tile's or scan's bytes as they stand in the file.
  Result<std::vector<std::byte>> read_part(std::size_t part) const;

 private:
  static Result<MapFile> open_source(std::shared_ptr<const RandomAccess> source,
                                     const MapReadOptions& options);
  struct State;
  explicit MapFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Whether the bytes start as a map file does; its first 64 suffice.
bool is_map(std::span<const std::byte> bytes);

/// How a map is made.
struct MapBuildSettings {
  MapHeader header{};  ///< kind, sizes, ranges, metadata; scans and travelled_m are counted
  bool origin_of_first_scan = true;  ///< header.origin becomes the first scan's place, whole metres
  std::uint32_t every_scans = 1;     ///< takes every n-th scan, the first one included
  double every_m = 0;                ///< and none nearer than this to the last one taken
  /// Maps of scans: how each is encoded. Its limits of range are those of the header.
  EncodeSettings scan{};
  std::size_t max_samples = 3'000'000;  ///< held at once, 100 bytes or so each; others wait on disk
  /// Surface maps: leaves out samples that the beams of more scans went through than saw them.
  bool still = false;
  std::size_t threads = 1;  ///< never changes the bytes; 0 = all cores
};

/// What building came to.
struct MapReport {
  std::uint64_t bytes = 0;
  std::size_t offered = 0, taken = 0;     ///< scans
  std::size_t points = 0;                 ///< returns within the limits of range
  std::size_t samples = 0;                ///< that the tiles were made from
  std::size_t explained = 0;              ///< of them already on the surface that is appended to
  std::size_t tiles = 0, tiles_kept = 0;  ///< written; of them copied as they were
  std::size_t moved = 0;                  ///< samples left out as of things that moved
  std::size_t most_samples = 0;           ///< held at once
  std::vector<std::string> notes;         ///< what a user should know, one sentence each
};

/// Makes a map, scan by scan. Samples of a surface map are thinned as they come; beyond
/// max_samples the tiles that were not hit for longest go to a file without a name in the folder
/// of temporary files, so that memory depends on the tiles around the sensor and not on the length
/// of the drive. A map of scans keeps what it has encoded in that file.
class MapBuilder {
 public:
  /// invalid_argument; io (no temporary file).
  static Result<MapBuilder> create(const MapBuildSettings& settings);
  /// A builder that makes a map longer: kind, origin and sizes are its own, `settings` tells the
  /// rest. The map is read when finish() needs it, so it may be replaced only by that.
  static Result<MapBuilder> append(std::shared_ptr<const MapFile> map,
                                   const MapBuildSettings& settings);
  ~MapBuilder();
  MapBuilder(MapBuilder&&) noexcept;
  MapBuilder& operator=(MapBuilder&&) noexcept;

  /// Whether the next scan, at this place, will be taken: those that will not need not be read.
  bool takes(const RigidMotion& T_map_sensor) const;
  /// Offers a scan, in the sensor's frame; true if it was taken. Errors: invalid_argument (a pose
  /// that is none, a scan that cannot be encoded), limit_exceeded (farther than 2^20 tiles), io.
  Result<bool> add_scan(const Cloud& cloud, const RigidMotion& T_map_sensor,
                        std::optional<double> time_s = {});
  /// Counts a scan that takes() refuses.
  void skip(const RigidMotion& T_map_sensor);
  /// Writes the map; the file appears whole or not at all. Errors: those of encoding, io. The
  /// builder is empty after it.
  Result<MapReport> finish(const std::string& path, const ProgressCallback& progress = {});

 private:
  struct State;
  explicit MapBuilder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Points on a surface map's surface.
struct MapExtractSettings {
  double spacing_m = 0.1;  ///< not farther from each other along the surface's axes
  std::optional<MapBox> box{};
  std::optional<Vec3> centre{};  ///< only within radius_m of it
  double radius_m = 0;
  std::optional<TileKey> tile{};
  std::uint32_t max_level = 255;  ///< see MapFile::read_tile
  bool normals = false;  ///< normal_x, normal_y, normal_z (float32); upwards or along the axis:
                         ///< maps do not tell from which side a surface was seen
  std::size_t max_points = 200'000'000;  ///< limit_exceeded beyond
};
/// Unorganised, float64, in the map's frame; "intensity" (float32) if the map holds it. Reads only
/// the tiles that are needed. With `damaged`, tiles that cannot be read are left out and told
/// there, one sentence each; without, the first of them is the error.
Result<Cloud> extract_points(const MapFile& map, const MapExtractSettings& settings = {},
                             const ProgressCallback& progress = {},
                             std::vector<std::string>* damaged = nullptr);

}  // namespace curlidar
