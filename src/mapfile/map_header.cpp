// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/map_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/try.hpp"
#include "base/utf8.hpp"
#include "format/metadata_chunk.hpp"
#include "map/surface_tile.hpp"
#include "map/tile_points.hpp"

namespace curlidar {
namespace {

constexpr double kBoxStep_m = 0.25;    ///< of heights in summaries
constexpr double kRadiusStep_m = 0.1;  ///< of scans' radii in summaries
constexpr double kMostHeight_m = 1e6;  ///< of anything from the map's origin
constexpr double kMostPlace_m = 1e12;  ///< of the origin: beyond it doubles no longer tell 1 mm
constexpr double kQuaternionScale = 1 << 30;
constexpr std::uint8_t kCurves = 1, kIntensity = 2;

Error corrupt(const std::string& name, const std::string& what) {
  return {ErrorCode::corrupt, fmt::format("{}: {}; the map is damaged", name, what)};
}

std::uint64_t zigzag(std::int64_t value) {
  return value < 0 ? ~(static_cast<std::uint64_t>(value) << 1)
                   : static_cast<std::uint64_t>(value) << 1;
}
std::int64_t unzigzag(std::uint64_t value) {
  const auto half = static_cast<std::int64_t>(value >> 1);
  return (value & 1) != 0 ? ~half : half;
}

bool within(double value, double least, double most) {
  return value >= least && value <= most;
}

Vec3 read_vec(ByteReader& reader) {
  Vec3 v;
  v.x = reader.read<double>();
  v.y = reader.read<double>();
  v.z = reader.read<double>();
  return v;
}
void write_vec(ByteWriter& writer, const Vec3& v) {
  writer.write(v.x);
  writer.write(v.y);
  writer.write(v.z);
}

bool is_key(std::int64_t number) {
  return number >= -kMostTiles && number < kMostTiles;
}

Result<TileKey> read_key(ByteReader& reader, const std::string& name) {
  const std::int64_t x = unzigzag(reader.read_varint()), y = unzigzag(reader.read_varint());
  if (!reader.ok() || !is_key(x) || !is_key(y)) return corrupt(name, "a tile has no valid key");
  return TileKey{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
}

/// Around the surface of leaves, from the tile's origin.
MapBox box_of(const MapTile& tile) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const MapLeaf& leaf : tile.leaves) {
    const std::array<double, 3> centre{leaf.centre.x, leaf.centre.y, leaf.centre.z};
    const double half = leaf.size_m / 2;
    for (std::size_t k = 0; k < 3; ++k) {
      double below = centre[k] - half, above = centre[k] + half;
      if (k == leaf.axis) {
        const double tilt = half * (std::abs(leaf.slope[0]) + std::abs(leaf.slope[1]));
        const double bend =
            half * half *
            (std::abs(leaf.curve[0]) + std::abs(leaf.curve[1]) + std::abs(leaf.curve[2]));
        below = std::max(below - kLeafSlack_m, leaf.height_m - tilt - bend);
        above = std::min(above + kLeafSlack_m, leaf.height_m + tilt + bend);
      }
      low[k] = std::min(low[k], below);
      high[k] = std::max(high[k], above);
    }
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

/// Sides of a tile in 1/256 of its length, and back.
std::uint8_t part_of_side(double value, double side_m) {
  return static_cast<std::uint8_t>(std::clamp(std::floor(value / side_m * 256), 0.0, 255.0));
}

void write_metadata_entries(ByteWriter& writer, const Metadata& metadata) {
  writer.write_varint(metadata.size());
  for (const auto& [key, value] : metadata) {
    writer.write_string(key);
    writer.write_string(value);
  }
}

Result<Metadata> read_metadata_entries(ByteReader& reader, const std::string& name) {
  const std::uint64_t count = reader.read_varint();
  if (!reader.ok() || count > kMaxMetadataEntries || count > reader.remaining()) {
    return corrupt(name, "the header claims too many metadata");
  }
  Metadata metadata;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::string key = reader.read_string();
    std::string value = reader.read_string();
    if (!reader.ok() || key.empty() || !is_utf8(key) || !is_utf8(value)) {
      return corrupt(name, "the header's metadata end or are no text");
    }
    metadata.emplace(std::move(key), std::move(value));
  }
  return metadata;
}

}  // namespace

const char* to_string(MapKind kind) {
  return kind == MapKind::surface ? "surface" : "scans";
}

Status validate(const MapHeader& header) {
  const auto check = [](const char* what, double value, double low, double high) -> Status {
    if (within(value, low, high)) return {};
    return Error{
        ErrorCode::invalid_argument,
        fmt::format("{} is {:g} m; it must be from {:g} to {:g} m", what, value, low, high)};
  };
  for (const double place : {header.origin.x, header.origin.y, header.origin.z}) {
    CURLIDAR_TRY(check("the map's origin", place, -kMostPlace_m, kMostPlace_m));
  }
  CURLIDAR_TRY(check("the smallest range", header.min_range_m, 0, 1e6));
  CURLIDAR_TRY(check("the largest range", header.max_range_m, header.min_range_m, 1e6));
  CURLIDAR_TRY(check("the way", header.travelled_m, 0, 1e15));
  if (header.kind == MapKind::scans) return {};
  CURLIDAR_TRY(check("the edge of thinning", header.thinning_m, 0.001, 10));
  CURLIDAR_TRY(check("a tile's side", header.tile_side_m, 0.5, 1024));
  return validate(header.surface, header.tile_side_m);
}

Result<std::vector<std::byte>> write_map_header(const MapHeader& header) {
  CURLIDAR_TRY(validate(header));
  CURLIDAR_TRY(write_metadata(header.metadata));  // holds the same rules
  ByteWriter writer;
  write_vec(writer, header.origin);
  writer.write(header.min_range_m);
  writer.write(header.max_range_m);
  writer.write_varint(header.scans);
  writer.write(header.travelled_m);
  if (header.kind == MapKind::surface) {
    const SurfaceSettings& s = header.surface;
    for (const double value : {header.tile_side_m, header.thinning_m, s.step_m, s.metres_per_bit,
                               s.root_m, s.smallest_leaf_m, s.footprint_m, s.drop_m, s.bare_samples,
                               s.full_weight, s.intensity_step}) {
      writer.write(value);
    }
    writer.write(
        static_cast<std::uint8_t>((s.curves ? kCurves : 0) | (s.intensity ? kIntensity : 0)));
  }
  write_metadata_entries(writer, header.metadata);
  return std::move(writer).bytes();
}

Result<MapHeader> read_map_header(MapKind kind, ByteSpan bytes, const std::string& name) {
  ByteReader reader(bytes);
  MapHeader header;
  header.kind = kind;
  header.origin = read_vec(reader);
  header.min_range_m = reader.read<double>();
  header.max_range_m = reader.read<double>();
  header.scans = reader.read_varint();
  header.travelled_m = reader.read<double>();
  if (kind == MapKind::surface) {
    SurfaceSettings& s = header.surface;
    for (double* value : {&header.tile_side_m, &header.thinning_m, &s.step_m, &s.metres_per_bit,
                          &s.root_m, &s.smallest_leaf_m, &s.footprint_m, &s.drop_m, &s.bare_samples,
                          &s.full_weight, &s.intensity_step}) {
      *value = reader.read<double>();
    }
    const auto flags = reader.read<std::uint8_t>();
    if ((flags & ~(kCurves | kIntensity)) != 0)
      return corrupt(name, "the header has unknown flags");
    s.curves = (flags & kCurves) != 0;
    s.intensity = (flags & kIntensity) != 0;
  }
  CURLIDAR_TRY_ASSIGN(metadata, read_metadata_entries(reader, name));
  header.metadata = std::move(metadata);
  if (!reader.ok() || reader.remaining() != 0) return corrupt(name, "the header has another size");
  if (const Status valid = validate(header); !valid) return corrupt(name, valid.error().message);
  return header;
}

std::vector<std::byte> write_tile_part(TileKey key, ByteSpan tile) {
  ByteWriter writer;
  writer.write_varint(zigzag(key.x));
  writer.write_varint(zigzag(key.y));
  writer.write_bytes(tile);
  return std::move(writer).bytes();
}

Result<TilePart> read_tile_part(ByteSpan part, const std::string& name) {
  ByteReader reader(part);
  CURLIDAR_TRY_ASSIGN(key, read_key(reader, name));
  return TilePart{key, reader.take(reader.remaining())};
}

namespace {

/// A rotation as four whole numbers: a quaternion w x y z of length 2^30, w not negative. All four,
/// since w cannot be told from the others where it is small: on the way back along a street.
std::array<std::int32_t, 4> quaternion_of(const RigidMotion& pose) {
  const auto& [a, b, c] = pose.rotation;
  // The largest of four ways to begin keeps the root away from zero.
  const std::array<double, 4> square{1 + a.x + b.y + c.z, 1 + a.x - b.y - c.z, 1 - a.x + b.y - c.z,
                                     1 - a.x - b.y + c.z};
  const auto largest =
      static_cast<std::size_t>(std::max_element(square.begin(), square.end()) - square.begin());
  const double twice = std::sqrt(std::max(square[largest], 0.0));
  const double f = twice > 0 ? 0.5 / twice : 0;
  std::array<double, 4> q{};  // w x y z
  switch (largest) {
    case 0:
      q = {twice / 2, (c.y - b.z) * f, (a.z - c.x) * f, (b.x - a.y) * f};
      break;
    case 1:
      q = {(c.y - b.z) * f, twice / 2, (b.x + a.y) * f, (a.z + c.x) * f};
      break;
    case 2:
      q = {(a.z - c.x) * f, (b.x + a.y) * f, twice / 2, (c.y + b.z) * f};
      break;
    default:
      q = {(b.x - a.y) * f, (a.z + c.x) * f, (c.y + b.z) * f, twice / 2};
      break;
  }
  const double sign = q[0] < 0 ? -1 : 1;
  std::array<std::int32_t, 4> out{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double value = std::round(sign * q[k] * kQuaternionScale);
    out[k] = static_cast<std::int32_t>(std::clamp(value, -kQuaternionScale, kQuaternionScale));
  }
  return out;
}

/// The motion of whole numbers; false if they are not as long as a quaternion is.
bool rotation_of(const std::array<std::int32_t, 4>& numbers, RigidMotion& pose) {
  std::array<double, 4> q{};
  double square = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    q[k] = numbers[k] / kQuaternionScale;
    square += q[k] * q[k];
  }
  if (!within(square, 1 - 1e-6, 1 + 1e-6)) return false;
  const double length = std::sqrt(square);
  const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
  pose.rotation = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                    {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                    {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  return true;
}

}  // namespace

RigidMotion coded_pose(const RigidMotion& T_map_sensor) {
  RigidMotion pose = T_map_sensor;
  rotation_of(quaternion_of(T_map_sensor), pose);
  return pose;
}

std::vector<std::byte> write_scan_part(const RigidMotion& T_map_sensor,
                                       std::optional<double> time_s, ByteSpan file) {
  ByteWriter writer;
  write_vec(writer, T_map_sensor.move);
  for (const std::int32_t number : quaternion_of(T_map_sensor)) {
    writer.write(static_cast<std::uint32_t>(number));
  }
  writer.write(time_s.value_or(std::numeric_limits<double>::quiet_NaN()));
  writer.write_bytes(file);
  return std::move(writer).bytes();
}

Result<MapScan> read_scan_part(ByteSpan part, const std::string& name) {
  ByteReader reader(part);
  MapScan scan;
  scan.T_map_sensor.move = read_vec(reader);
  std::array<std::int32_t, 4> numbers{};
  for (std::int32_t& number : numbers)
    number = static_cast<std::int32_t>(reader.read<std::uint32_t>());
  const auto time_s = reader.read<double>();
  const Vec3& place = scan.T_map_sensor.move;
  const bool finite = within(std::abs(place.x), 0, kMostPlace_m) &&
                      within(std::abs(place.y), 0, kMostPlace_m) &&
                      within(std::abs(place.z), 0, kMostPlace_m);
  if (!reader.ok() || !finite || !rotation_of(numbers, scan.T_map_sensor)) {
    return corrupt(name, "a scan has no valid pose");
  }
  if (std::isfinite(time_s)) scan.time_s = time_s;
  const ByteSpan file = reader.take(reader.remaining());
  scan.file.assign(file.begin(), file.end());
  return scan;
}

std::vector<std::byte> write_tile_summary(const MapTile& tile, double side_m) {
  ByteWriter writer;
  writer.write_varint(zigzag(tile.key.x));
  writer.write_varint(zigzag(tile.key.y));
  writer.write_varint(tile.leaves.size());
  if (tile.leaves.empty()) return std::move(writer).bytes();
  const MapBox box = box_of(tile);
  writer.write(part_of_side(box.low.x, side_m));
  writer.write(part_of_side(std::nextafter(box.high.x, box.low.x), side_m));
  writer.write(part_of_side(box.low.y, side_m));
  writer.write(part_of_side(std::nextafter(box.high.y, box.low.y), side_m));
  writer.write_varint(zigzag(static_cast<std::int64_t>(std::floor(box.low.z / kBoxStep_m))));
  writer.write_varint(zigzag(static_cast<std::int64_t>(std::ceil(box.high.z / kBoxStep_m))));
  return std::move(writer).bytes();
}

Result<MapTileEntry> read_tile_summary(ByteSpan bytes, const MapHeader& header,
                                       const std::string& name) {
  ByteReader reader(bytes);
  MapTileEntry entry;
  CURLIDAR_TRY_ASSIGN(key, read_key(reader, name));
  entry.key = key;
  const Vec3 origin = tile_origin(key, header);
  const std::uint64_t leaves = reader.read_varint();
  entry.box = {origin, origin};
  if (leaves > 0) {
    const double unit = header.tile_side_m / 256;
    const double x0 = reader.read<std::uint8_t>(), x1 = reader.read<std::uint8_t>();
    const double y0 = reader.read<std::uint8_t>(), y1 = reader.read<std::uint8_t>();
    const auto z0 = static_cast<double>(unzigzag(reader.read_varint())) * kBoxStep_m;
    const auto z1 = static_cast<double>(unzigzag(reader.read_varint())) * kBoxStep_m;
    // A leaf over x or y may leave its cube, and so the tile, by the slack of surfaces.
    const Vec3 slack{kLeafSlack_m, kLeafSlack_m, 0};
    entry.box = {origin + Vec3{x0 * unit, y0 * unit, z0} - slack,
                 origin + Vec3{(x1 + 1) * unit, (y1 + 1) * unit, z1} + slack};
    if (x1 < x0 || y1 < y0 || !within(z0, -kMostHeight_m, kMostHeight_m) ||
        !within(z1, z0, kMostHeight_m)) {
      return corrupt(name, "the index tells an impossible box");
    }
  }
  if (!reader.ok() || reader.remaining() != 0 || leaves > UINT32_MAX) {
    return corrupt(name, "the index tells a tile in another size");
  }
  entry.leaves = static_cast<std::uint32_t>(leaves);
  return entry;
}

ScanExtent extent_of(std::span<const Vec3> points) {
  ScanExtent extent;
  for (const Vec3& p : points) {
    if (!is_return(p)) continue;
    ++extent.points;
    extent.radius_m = std::max(extent.radius_m, norm(p));
  }
  return extent;
}

std::vector<std::byte> write_scan_summary(const RigidMotion& T_map_sensor, const MapHeader& header,
                                          double radius_m, std::uint32_t points) {
  const Vec3 place = T_map_sensor.move - header.origin;
  ByteWriter writer;
  for (const double value : {place.x, place.y, place.z}) writer.write(static_cast<float>(value));
  // What is lost by the place as floats is below a step.
  writer.write_varint(static_cast<std::uint64_t>(std::ceil(radius_m / kRadiusStep_m)) + 1);
  writer.write_varint(points);
  return std::move(writer).bytes();
}

Result<MapScanEntry> read_scan_summary(ByteSpan bytes, const MapHeader& header,
                                       const std::string& name) {
  ByteReader reader(bytes);
  Vec3 place;
  for (double* value : {&place.x, &place.y, &place.z})
    *value = static_cast<double>(reader.read<float>());
  const std::uint64_t radius = reader.read_varint(), points = reader.read_varint();
  const bool finite = std::isfinite(place.x) && std::isfinite(place.y) && std::isfinite(place.z);
  if (!reader.ok() || reader.remaining() != 0 || !finite || radius > 1u << 24 ||
      points > UINT32_MAX) {
    return corrupt(name, "the index tells an impossible scan");
  }
  const double r = static_cast<double>(radius) * kRadiusStep_m;
  const Vec3 middle = header.origin + place;
  MapScanEntry entry;
  entry.box = {middle - Vec3{r, r, r}, middle + Vec3{r, r, r}};
  entry.points = static_cast<std::uint32_t>(points);
  return entry;
}

}  // namespace curlidar
