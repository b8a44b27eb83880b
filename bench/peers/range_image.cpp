// SPDX-License-Identifier: BSD-3-Clause
// A range image and a mask, whatever codes the image.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/try.hpp"
#include "peers.hpp"

namespace curlidar::bench {
namespace {

using Samples = ImageCoder::Samples;

Result<Samples> quantise(const Grid& grid, double step_m) {
  Samples image(grid.mask.occupied.size(), 0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (!grid.mask.occupied[i]) continue;
    const double level = std::round(grid.ranges_m[next++] / step_m);
    if (level > 65535)
      return Error{ErrorCode::invalid_argument,
                   fmt::format("ranges in steps of {} m do not fit into 16 bits", step_m)};
    image[i] = static_cast<std::uint16_t>(level);
  }
  return image;
}

/// Gives every hole the sample on its left; those before a row's first return take that return's,
/// and rows without a return copy the row above.
void fill_holes(const Mask& mask, Samples& image) {
  for (std::size_t i = 0; i < mask.rows; ++i) {
    std::uint16_t* row = image.data() + i * mask.columns;
    const std::uint8_t* occupied = mask.occupied.data() + i * mask.columns;
    const std::uint8_t* first = std::find(occupied, occupied + mask.columns, 1);
    if (first == occupied + mask.columns) {
      if (i > 0) std::copy_n(row - mask.columns, mask.columns, row);
      continue;
    }
    std::uint16_t last = row[first - occupied];
    for (std::size_t j = 0; j < mask.columns; ++j) {
      if (occupied[j]) last = row[j];
      row[j] = last;
    }
  }
}

Result<Decoded> run(const ImageCoder& coder, const Grid& grid, double step_m) {
  Decoded result;
  CpuTimer timer;
  CURLIDAR_TRY_ASSIGN(image, quantise(grid, step_m));
  fill_holes(grid.mask, image);
  CURLIDAR_TRY_ASSIGN(packed, coder.pack(image, grid.mask));
  const Bytes packed_mask = pack_mask(grid.mask);
  result.encode_ms = timer.lap_ms();

  const Mask mask = unpack_mask(packed_mask, grid.mask.rows, grid.mask.columns);
  CURLIDAR_TRY_ASSIGN(decoded, coder.unpack(packed, mask));
  if (mask.occupied != grid.mask.occupied) {
    return Error{ErrorCode::corrupt, "the mask coder changed the mask"};
  }
  result.bytes = packed.size() + packed_mask.size();
  result.order = Order::ranges;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    if (!mask.occupied[i]) continue;
    if (decoded[i] != image[i]) {
      return Error{ErrorCode::corrupt, coder.name + " changed the image"};
    }
    const std::size_t k = result.cloud.positions.size();
    const Vec3 direction = grid.returns.positions[k] * (1 / grid.ranges_m[k]);
    result.cloud.positions.push_back(direction * (decoded[i] * step_m));
  }
  result.decode_ms = timer.lap_ms();
  return result;
}

}  // namespace

Peer range_image_peer(ImageCoder coder) {
  Peer peer{coder.name,
            "step_m",
            {.002, .004, .008, .012, .02, .028, .04, .056, .08, .112, .16, .2, .28, .4},
            {}};
  peer.run = [coder](const Grid& grid, double step_m) { return run(coder, grid, step_m); };
  return peer;
}

}  // namespace curlidar::bench
