// SPDX-License-Identifier: BSD-3-Clause
#include "map/surface_tile.hpp"

#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include "base/try.hpp"

namespace curlidar {
namespace {

constexpr double kUnit = 4096;

}  // namespace

Result<std::vector<std::byte>> encode_surface_tile(std::vector<MapSample> samples,
                                                   const SurfaceSettings& settings, double side_m) {
  CURLIDAR_TRY(validate(settings, side_m));
  using Cube = std::tuple<std::uint32_t, std::uint32_t, std::int64_t>;
  std::map<Cube, std::pair<double, double>> heights;
  for (const MapSample& sample : samples) {
    const Vec3& p = sample.position;
    if (!(p.x >= 0 && p.x < side_m && p.y >= 0 && p.y < side_m && std::abs(p.z) < 1e5)) {
      return Error{ErrorCode::invalid_argument, "a sample outside of its tile"};
    }
    auto& [sum, count] = heights[{static_cast<std::uint32_t>(p.x / settings.smallest_leaf_m),
                                  static_cast<std::uint32_t>(p.y / settings.smallest_leaf_m),
                                  std::llround(std::floor(p.z / settings.smallest_leaf_m))}];
    sum += p.z;
    count += 1;
  }
  ByteWriter out;
  out.write_varint(static_cast<std::uint64_t>(side_m * 16));
  out.write_varint(static_cast<std::uint64_t>(settings.smallest_leaf_m * 16));
  for (const auto& [cube, sum] : heights) {
    out.write_varint(std::get<0>(cube));
    out.write_varint(std::get<1>(cube));
    out.write(static_cast<std::int32_t>(std::get<2>(cube)));
    out.write(static_cast<std::int32_t>(sum.first / sum.second * kUnit));
  }
  return std::move(out).bytes();
}

Result<MapTile> decode_surface_tile(ByteSpan bytes, const TileLimits& limits, std::uint32_t) {
  ByteReader in(bytes);
  MapTile tile;
  tile.side_m = static_cast<double>(in.read_varint()) / 16;
  const double size = static_cast<double>(in.read_varint()) / 16;
  while (in.remaining() > 0) {
    const auto x = static_cast<double>(in.read_varint()), y = static_cast<double>(in.read_varint());
    const double z = in.read<std::int32_t>();
    const double height = in.read<std::int32_t>();
    if (!in.ok()) return Error{ErrorCode::corrupt, "a tile ends within a leaf"};
    if (tile.leaves.size() >= limits.max_leaves) {
      return Error{ErrorCode::limit_exceeded, "a tile with more leaves than allowed"};
    }
    MapLeaf leaf;
    leaf.size_m = size;
    leaf.centre = {(x + 0.5) * size, (y + 0.5) * size, (z + 0.5) * size};
    leaf.height_m = height / kUnit;
    leaf.first_cell = tile.footprint.size();
    tile.footprint.push_back(1);
    tile.leaves.push_back(leaf);
  }
  return tile;
}

}  // namespace curlidar
