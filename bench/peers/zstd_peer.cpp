// SPDX-License-Identifier: BSD-3-Clause
// What a careful engineer writes in an afternoon: integers, differences, zstd at level 19.
#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>

#include "base/try.hpp"
#include "peers.hpp"

namespace curlidar::bench {
namespace {

constexpr int kLevel = 19;

Result<Bytes> compress(const Bytes& raw) {
  Bytes packed(ZSTD_compressBound(raw.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kLevel);
  if (ZSTD_isError(size)) return Error{ErrorCode::corrupt, ZSTD_getErrorName(size)};
  packed.resize(size);
  return packed;
}

Result<Bytes> decompress(const Bytes& packed, std::size_t raw_size) {
  Bytes raw(raw_size);
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), packed.data(), packed.size());
  if (ZSTD_isError(size)) return Error{ErrorCode::corrupt, ZSTD_getErrorName(size)};
  if (size != raw_size) return Error{ErrorCode::corrupt, "zstd gave back another size"};
  return raw;
}

std::uint32_t zigzag(std::int32_t v) {
  return static_cast<std::uint32_t>(v) << 1 ^ static_cast<std::uint32_t>(v >> 31);
}
std::int32_t unzigzag(std::uint32_t v) {
  return static_cast<std::int32_t>(v >> 1 ^ (0u - (v & 1)));
}

/// Differences of neighbouring values, small ones near 0, as byte planes: all lowest bytes first.
/// zstd codes bytes, and the high ones are nearly all zero.
class Planes {
 public:
  Planes(std::size_t count, std::size_t width) : count_(count), width_(width) {}

  Bytes split(const std::vector<std::int32_t>& values) const {
    Bytes raw(count_ * width_);
    std::int32_t last = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint32_t v = zigzag(values[i] - last);
      last = values[i];
      for (std::size_t b = 0; b < width_; ++b) {
        raw[b * count_ + i] = static_cast<std::byte>(v >> (8 * b) & 0xff);
      }
    }
    return raw;
  }
  std::vector<std::int32_t> join(const Bytes& raw) const {
    std::vector<std::int32_t> values(count_);
    std::int32_t last = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      std::uint32_t v = 0;
      for (std::size_t b = 0; b < width_; ++b) {
        v |= std::to_integer<std::uint32_t>(raw[b * count_ + i]) << (8 * b);
      }
      last += unzigzag(v);
      values[i] = last;
    }
    return values;
  }

 private:
  std::size_t count_, width_;
};

// Three bytes hold every difference: coordinates stay within 2^22 steps.
constexpr std::size_t kWidth = 3;

/// One axis after the other, each a stream of its own planes.
Result<Decoded> run_deltas(const Grid& grid, double step_m) {
  const std::vector<Vec3>& points = grid.returns.positions;
  Decoded result;
  CpuTimer timer;
  const Planes planes(3 * points.size(), kWidth);
  std::vector<std::int32_t> values;
  for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    for (const Vec3& p : points) {
      const double level = std::round(p.*axis / step_m);
      if (!(std::abs(level) < (1 << 22))) {
        return Error{ErrorCode::invalid_argument,
                     fmt::format("coordinates in steps of {} m do not fit into 23 bits", step_m)};
      }
      values.push_back(static_cast<std::int32_t>(level));
    }
  }
  const Bytes raw = planes.split(values);
  CURLIDAR_TRY_ASSIGN(packed, compress(raw));
  result.encode_ms = timer.lap_ms();
  CURLIDAR_TRY_ASSIGN(unpacked, decompress(packed, raw.size()));
  const std::vector<std::int32_t> decoded = planes.join(unpacked);

  result.bytes = packed.size();
  result.order = Order::points;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    result.cloud.positions.push_back(
        Vec3{double(decoded[i]), double(decoded[n + i]), double(decoded[2 * n + i])} * step_m);
  }
  result.decode_ms = timer.lap_ms();
  return result;
}

using Samples = ImageCoder::Samples;

Result<Bytes> pack(const Samples& image, const Mask& mask) {
  std::vector<std::int32_t> levels;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask.occupied[i]) levels.push_back(image[i]);
  }
  return compress(Planes(levels.size(), kWidth).split(levels));
}

Result<Samples> unpack(const Bytes& bytes, const Mask& mask) {
  const auto count =
      static_cast<std::size_t>(std::count(mask.occupied.begin(), mask.occupied.end(), 1));
  const Planes planes(count, kWidth);
  CURLIDAR_TRY_ASSIGN(raw, decompress(bytes, count * kWidth));
  const std::vector<std::int32_t> levels = planes.join(raw);
  Samples image(mask.occupied.size(), 0);
  std::size_t next = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask.occupied[i]) image[i] = static_cast<std::uint16_t>(levels[next++]);
  }
  return image;
}

}  // namespace

ImageCoder zstd_coder() {
  return {"range-zstd19", pack, unpack};
}

Peer zstd_delta_peer() {
  return {"xyz-zstd19",
          "step_m",
          {.002, .004, .008, .012, .02, .028, .04, .056, .08, .112, .16, .2, .28},
          run_deltas};
}

}  // namespace curlidar::bench
