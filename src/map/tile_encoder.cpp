// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_encoder.hpp"

#include <utility>

#include "base/try.hpp"
#include "entropy/range_coder.hpp"
#include "map/surface_tile.hpp"
#include "map/tile_header.hpp"
#include "map/tile_samples.hpp"
#include "map/tile_search.hpp"

namespace curlidar::tile {
namespace {

/// What lies farther from a plane than this counts less and less when planes are fitted.
constexpr double kNear_m = 0.05;

TileWeighing weighing_of(const SurfaceSettings& settings) {
  return {settings.metres_per_bit * kTicks, settings.drop_m * kTicks, kNear_m * kTicks,
          settings.bare_samples * settings.drop_m / kTicks};
}

}  // namespace

Result<EncodedTile> encode_tile(const std::vector<MapSample>& samples,
                                const SurfaceSettings& settings, double side_m, bool keep_roots) {
  CURLIDAR_TRY(validate(settings, side_m));
  EncodedTile out;
  out.layout = layout_of(settings, side_m);
  CURLIDAR_TRY_ASSIGN(sorted, sort_samples(samples, out.layout));
  limit_weights(sorted, settings.full_weight);
  ByteWriter writer;
  write_header(writer, out.layout);
  const TileWeighing weighing = weighing_of(settings);
  TileState state(out.layout);
  TileModels models;
  RangeEncoder encoder;
  TileSink<RangeEncoder> sink(encoder, models);
  TileSearch search(state, models, weighing, sorted.samples);
  std::size_t next = 0;
  for_each_root(out.layout, [&](const TileCube& cube) {
    const CubeContext c = state.context(cube);
    std::int32_t node = -1;
    if (next < sorted.roots.size() && sorted.roots[next].cube.at == cube.at) {
      const TileState::Mark mark = state.mark();
      node = search.root(c, sorted.roots[next++]);
      state.forget(cube, mark);
    }
    if (keep_roots)
      out.roots.push_back({node < 0 ? std::vector<TileNode>{} : search.nodes(), node});
    return code_root(sink, state, c, &search.nodes(), node, [] { return true; });
  });
  writer.write_bytes(std::move(encoder).finish());
  out.bytes = std::move(writer).bytes();
  return out;
}

}  // namespace curlidar::tile
