// SPDX-License-Identifier: BSD-3-Clause
#include "records/loose.hpp"

#include <cmath>

#include "base/try.hpp"
#include "format/payload.hpp"

namespace curlidar {

Result<CodedPoints> encode_loose(std::span<const Vec3> points, ScalarType type,
                                 const LooseSettings&) {
  if (type != ScalarType::float32 && type != ScalarType::float64) {
    return Error{ErrorCode::invalid_argument, "coordinates must be float32 or float64"};
  }
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(type));
  writer.write_varint(points.size());
  for (const Vec3& p : points) {
    for (const double x : {p.x, p.y, p.z}) {
      if (!std::isfinite(x)) {
        return Error{ErrorCode::invalid_argument, "a coordinate is not finite"};
      }
      if (type == ScalarType::float32) {
        writer.write(static_cast<float>(x));
      } else {
        writer.write(x);
      }
    }
  }
  return CodedPoints{std::move(writer).bytes(), {points.begin(), points.end()}};
}

Result<std::vector<Vec3>> decode_loose(const Chunk& chunk, std::size_t max_points) {
  PayloadReader reader(chunk);
  const auto type = static_cast<ScalarType>(reader.read<std::uint8_t>());
  if (type != ScalarType::float32 && type != ScalarType::float64) {
    return reader.corrupt("unknown type of coordinates");
  }
  CURLIDAR_TRY_ASSIGN(count, reader.read_count("points", max_points));
  if (count > reader.remaining() / (3 * size_of(type))) return reader.corrupt("too few points");
  const auto next = [&] {
    const double x =
        type == ScalarType::float32 ? double{reader.read<float>()} : reader.read<double>();
    return std::isfinite(x) ? x : 0;
  };
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    p.x = next();
    p.y = next();
    p.z = next();
  }
  CURLIDAR_TRY(reader.finish());
  return points;
}

}  // namespace curlidar
