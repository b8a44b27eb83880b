// SPDX-License-Identifier: BSD-3-Clause
#include "records/corrections.hpp"

#include <bit>
#include <cmath>

#include "base/try.hpp"
#include "format/payload.hpp"

namespace curlidar {
namespace {

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::bit_cast<std::uint64_t>(a.x) == std::bit_cast<std::uint64_t>(b.x) &&
         std::bit_cast<std::uint64_t>(a.y) == std::bit_cast<std::uint64_t>(b.y) &&
         std::bit_cast<std::uint64_t>(a.z) == std::bit_cast<std::uint64_t>(b.z);
}

}  // namespace

Result<CodedCorrections> encode_corrections(std::span<const Vec3> predicted,
                                            std::span<const Vec3> original, ScalarType type,
                                            const CorrectionSettings& settings) {
  if (predicted.size() != original.size()) {
    return Error{ErrorCode::invalid_argument, "as many predicted as original points are needed"};
  }
  CodedCorrections result;
  result.decoded.assign(predicted.begin(), predicted.end());
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(type));
  writer.write_varint(predicted.size());
  std::size_t last = 0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const bool kept = settings.max_error_m > 0
                          ? norm(predicted[i] - original[i]) <= settings.max_error_m
                          : same_bits(predicted[i], original[i]);
    if (kept) continue;
    writer.write_varint(i - last);
    writer.write(original[i].x);
    writer.write(original[i].y);
    writer.write(original[i].z);
    result.decoded[i] = original[i];
    last = i + 1;
    ++result.corrected;
  }
  result.bytes = std::move(writer).bytes();
  return result;
}

Status apply_corrections(const Chunk& chunk, ScalarType type, std::span<Vec3> points) {
  PayloadReader reader(chunk);
  if (reader.read<std::uint8_t>() != static_cast<std::uint8_t>(type)) {
    return reader.corrupt("the corrections are for coordinates of another type");
  }
  CURLIDAR_TRY_ASSIGN(count, reader.read_count("points", points.size()));
  if (count != points.size()) return reader.corrupt("the corrections are for more points");
  std::size_t next = 0;
  while (reader.remaining() > 0) {
    CURLIDAR_TRY_ASSIGN(gap, reader.read_count("points", points.size() - next));
    next += gap;
    if (next >= points.size()) return reader.corrupt("a correction of no point");
    Vec3& p = points[next++];
    p.x = reader.read<double>();
    p.y = reader.read<double>();
    p.z = reader.read<double>();
    CURLIDAR_TRY(reader.check("correction"));
    if (!std::isfinite(p.x + p.y + p.z)) return reader.corrupt("a coordinate is not finite");
  }
  return reader.finish();
}

}  // namespace curlidar
