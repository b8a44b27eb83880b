// SPDX-License-Identifier: BSD-3-Clause
#include "records/loose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/try.hpp"
#include "format/payload.hpp"
#include "records/point_coder.hpp"
#include "records/points.hpp"

namespace curlidar {
namespace {

using records::Numbers;
using records::PointsHeader;
using records::Triple;

/// Encoder: what a decoded point may be.
struct Goal {
  double max_error_m = 0;  ///< 0: any
  bool exact = false;

  bool allows(const Vec3& decoded, const Vec3& p) const {
    if (exact) return records::same_bits(decoded, p);
    // A return at the origin would not be one.
    if (decoded == Vec3{} && p != Vec3{}) return false;
    return max_error_m == 0 || norm(decoded - p) <= max_error_m;
  }
};

/// The numbers next to a point if they stand for one that is allowed.
std::optional<Triple> nearest_allowed(const Numbers& numbers, const Goal& goal, const Vec3& p) {
  const Triple triple = records::numbers_of(numbers, p);
  const auto decoded = records::point_of(numbers, triple);
  if (!decoded || !goal.allows(*decoded, p)) return std::nullopt;
  return triple;
}

/// Of the grid points around the nearest one that are allowed, the one that costs least.
Triple cheapest(const Numbers& numbers, const Goal& goal, const records::PointCoder& coder,
                const Vec3& p, const Triple& nearest) {
  if (goal.max_error_m == 0) return nearest;
  Triple best = nearest;
  std::uint64_t least = UINT64_MAX;
  for (int i = 0; i < 27; ++i) {
    const Triple triple = {nearest[0] + i % 3 - 1, nearest[1] + i / 3 % 3 - 1,
                           nearest[2] + i / 9 - 1};
    const auto decoded = records::point_of(numbers, triple);
    if (!decoded || !goal.allows(*decoded, p)) continue;
    const std::uint64_t cost = coder.cost(triple);
    if (cost >= least) continue;
    least = cost;
    best = triple;
  }
  return best;
}

CodedPoints encode_points(std::span<const Vec3> points, const Numbers& numbers, const Goal& goal) {
  const bool some_raw = std::any_of(points.begin(), points.end(), [&](const Vec3& p) {
    return !nearest_allowed(numbers, goal, p);
  });
  const PointsHeader header{numbers, some_raw, points.size()};
  CodedPoints result;
  result.decoded.assign(points.begin(), points.end());
  RangeEncoder encoder;
  records::RawCoder raw(header);
  records::PointCoder coder(numbers);
  for (Vec3& p : result.decoded) {
    const auto nearest = nearest_allowed(numbers, goal, p);
    coder.begin();
    if (raw.code_flag(encoder, !nearest)) {
      raw.code_point(encoder, p);
      coder.raw(records::position_of(numbers, p));
      continue;
    }
    Triple triple = cheapest(numbers, goal, coder, p, *nearest);
    coder.code(encoder, triple);
    p = *records::point_of(numbers, triple);
  }
  ByteWriter writer;
  write_header(writer, header);
  writer.write_bytes(std::move(encoder).finish());
  result.bytes = std::move(writer).bytes();
  return result;
}

/// Decodes the next point; none if it is not finite.
std::optional<Vec3> decode_point(RangeDecoder& decoder, const Numbers& numbers,
                                 records::RawCoder& raw, records::PointCoder& coder) {
  coder.begin();
  if (raw.code_flag(decoder, false)) {
    Vec3 p;
    if (!raw.code_point(decoder, p)) return std::nullopt;
    coder.raw(records::position_of(numbers, p));
    return p;
  }
  Triple triple{};
  coder.code(decoder, triple);
  return records::point_of(numbers, triple);
}

}  // namespace

Result<CodedPoints> encode_loose(std::span<const Vec3> points, ScalarType type,
                                 const LooseSettings& settings) {
  CURLIDAR_TRY(records::check_setting(settings.max_error_m, "largest error in metres"));
  CURLIDAR_TRY(records::check_setting(settings.step_m, "step in metres"));
  CURLIDAR_TRY(records::check_points(points, type));
  if (settings.max_error_m == 0 && settings.step_m == 0) {
    return encode_points(points, records::exact_numbers(points, type), {0, true});
  }
  // No point of a cube lies farther from its middle than half its diagonal.
  const double step =
      settings.max_error_m > 0 ? 2 * settings.max_error_m / std::sqrt(3.0) : settings.step_m;
  return encode_points(points, Numbers::of_steps(type, step), {settings.max_error_m, false});
}

Result<std::vector<Vec3>> decode_loose(const Chunk& chunk, std::size_t max_points) {
  PayloadReader reader(chunk);
  CURLIDAR_TRY_ASSIGN(header, records::read_header(reader, max_points));
  RangeDecoder decoder(reader.take(reader.remaining()));
  records::RawCoder raw(header);
  records::PointCoder coder(header.numbers);
  std::vector<Vec3> points;
  points.reserve(std::min<std::size_t>(header.count, chunk.payload.size()));
  while (points.size() < header.count) {
    const auto p = decode_point(decoder, header.numbers, raw, coder);
    if (!p) return reader.corrupt(fmt::format("point {} is not finite", points.size()));
    if (decoder.exhausted()) {
      return reader.corrupt(
          fmt::format("the points end after {} of {}", points.size(), header.count));
    }
    points.push_back(*p);
  }
  return points;
}

}  // namespace curlidar
