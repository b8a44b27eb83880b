// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/try.hpp"
#include "entropy/range_coder.hpp"
#include "map/surface_distance.hpp"
#include "map/tile_header.hpp"
#include "map/tile_points.hpp"
#include "map/tile_samples.hpp"
#include "map/tile_search.hpp"

namespace curlidar::tile {
namespace {

/// What lies farther from a plane than this counts less and less when planes are fitted.
constexpr double kNear_m = 0.05;

TileWeighing weighing_of(const SurfaceSettings& settings) {
  return {settings.metres_per_bit * kTicks, settings.drop_m * kTicks, kNear_m * kTicks,
          settings.bare_samples * settings.drop_m / kTicks, 0};
}

/// Of a pass after others. Surface is there already: much of what samples would buy is the noise
/// of one more look at it, and all that moves is new. At the same price a second lap of simulated
/// streets would cost a third of the first.
TileWeighing later(TileWeighing weighing) {
  constexpr double kPrice = 2, kLeastBits = 8;
  weighing.lambda *= kPrice;
  weighing.least = kLeastBits * weighing.lambda;
  return weighing;
}

/// Codes pass after pass.
class TileCoder {
 public:
  explicit TileCoder(const TileLayout& layout) : layout_(layout), state_(layout) {
    write_header(writer_, layout);
  }

  /// A pass as it was chosen before.
  void repeat(const TilePass& pass) {
    begin();
    std::size_t next = 0;
    for_each_root(layout_, [&](const TileCube& cube) {
      const RootTree& root = pass[next++];
      return code_root(sink_, state_, state_.context(cube), &root.nodes, root.node,
                       [] { return true; });
    });
  }

  /// A pass that tells samples as cheaply as it can; whether there is anything in it.
  bool search(const SortedSamples& sorted, const TileWeighing& weighing) {
    begin();
    TileSearch search(state_, models_, weighing, sorted.samples);
    std::size_t next = 0;
    bool any = false;
    for_each_root(layout_, [&](const TileCube& cube) {
      const CubeContext c = state_.context(cube);
      std::int32_t node = -1;
      if (next < sorted.roots.size() && sorted.roots[next].cube.at == cube.at) {
        const TileState::Mark mark = state_.mark();
        node = search.root(c, sorted.roots[next++]);
        state_.forget(cube, mark);
      }
      any = any || node >= 0;
      return code_root(sink_, state_, c, &search.nodes(), node, [] { return true; });
    });
    return any;
  }

  std::vector<std::byte> finish() && {
    sink_.plain(false);
    writer_.write_bytes(std::move(encoder_).finish());
    return std::move(writer_).bytes();
  }

 private:
  void begin() {
    if (passes_++ == 0) return;
    sink_.plain(true);
    state_.begin_pass();
    models_.begin_pass();
  }

  TileLayout layout_;
  TileState state_;
  TileModels models_;
  RangeEncoder encoder_;
  TileSink<RangeEncoder> sink_{encoder_, models_};
  ByteWriter writer_;
  std::size_t passes_ = 0;
};

/// Takes the last pass of a tile out of it; gives points of its surface.
std::vector<MapSample> take_last_pass(DecodedTile& old, double spacing_m) {
  const std::size_t first = old.first_leaf.back();
  MapTile last = old.tile;
  last.leaves.erase(last.leaves.begin(), last.leaves.begin() + static_cast<std::ptrdiff_t>(first));
  old.tile.leaves.resize(first);
  old.first_leaf.pop_back();
  old.passes.pop_back();
  std::vector<MapSample> points = tile_points(last, spacing_m);
  // Surface may leave its tile by a little; samples may not.
  const double most = std::nextafter(old.tile.side_m, 0.0);
  for (MapSample& point : points) {
    point.position.x = std::clamp(point.position.x, 0.0, most);
    point.position.y = std::clamp(point.position.y, 0.0, most);
  }
  return points;
}

/// A pass with rows of empty roots below and above.
TilePass with_rows(TilePass pass, const TileLayout& from, const TileLayout& to) {
  TilePass out(std::size_t{to.side_roots} * to.side_roots * to.rows);
  const auto below = static_cast<std::size_t>(from.first_row - to.first_row);
  for (std::size_t i = 0; i < pass.size(); ++i) {
    out[i / from.rows * to.rows + i % from.rows + below] = std::move(pass[i]);
  }
  return out;
}

}  // namespace

Result<std::vector<std::byte>> encode_tile(const std::vector<MapSample>& samples,
                                           const SurfaceSettings& settings, double side_m) {
  CURLIDAR_TRY(validate(settings, side_m));
  TileLayout layout = layout_of(settings, side_m);
  CURLIDAR_TRY_ASSIGN(sorted, sort_samples(samples, layout));
  const TileWeighing weighing = weighing_of(settings);
  limit_weights(sorted, settings.full_weight);
  sorted.samples.drop.assign(sorted.samples.size(), weighing.drop);
  weigh_left(sorted.samples);
  TileCoder coder(layout);
  coder.search(sorted, weighing);
  return std::move(coder).finish();
}

Result<LongerTile> encode_longer(DecodedTile old, const std::vector<MapSample>& added,
                                 const SurfaceSettings& settings) {
  CURLIDAR_TRY(validate(settings, old.tile.side_m));
  std::vector<MapSample> samples;
  if (old.passes.size() == kMostPasses) {
    samples = take_last_pass(old, std::min(0.1, settings.footprint_m / 2));
  }
  samples.insert(samples.end(), added.begin(), added.end());
  TileLayout layout = old.layout;
  CURLIDAR_TRY_ASSIGN(sorted, sort_samples(samples, layout));
  TileSamples& all = sorted.samples;
  const TileWeighing weighing = later(weighing_of(settings));
  limit_weights(sorted, settings.full_weight);
  const SurfaceDistance to_old(old.tile, settings.drop_m);
  LongerTile longer;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vec3 p{all.at[0][i] / kTicks, all.at[1][i] / kTicks, all.at[2][i] / kTicks};
    const double distance = to_old.of(p);
    all.drop.push_back(std::max(distance * kTicks, 1.0));
    longer.explained += distance < settings.drop_m ? 1 : 0;
  }
  weigh_left(all);
  TileCoder coder(layout);
  for (TilePass& pass : old.passes) {
    coder.repeat(with_rows(std::move(pass), old.layout, layout));
  }
  if (coder.search(sorted, weighing)) longer.bytes = std::move(coder).finish();
  return longer;
}

}  // namespace curlidar::tile
