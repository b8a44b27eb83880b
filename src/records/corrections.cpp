// SPDX-License-Identifier: BSD-3-Clause
#include "records/corrections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/try.hpp"
#include "format/payload.hpp"
#include "records/correction_coder.hpp"

namespace curlidar {
namespace {

using records::CorrectionCoder;
using records::NumberKind;
using records::Numbers;
using records::PointsHeader;
using records::Triple;

/// Encoder: what becomes of a point.
struct Correction {
  bool raw = false;
  Triple steps{};
  Vec3 decoded;
};

/// Of the steps around those to the original that bring a point within the bound, the shortest.
std::optional<Correction> shortest(const Numbers& numbers, const Vec3& predicted,
                                   const Vec3& original, double max_error_m) {
  const Triple nearest = records::steps_between(numbers, predicted, original);
  std::optional<Correction> best;
  std::int64_t least = 0;
  for (int i = 0; i < 27; ++i) {
    const Triple steps = {nearest[0] + i % 3 - 1, nearest[1] + i / 3 % 3 - 1,
                          nearest[2] + i / 9 - 1};
    const auto decoded = records::moved(numbers, predicted, steps);
    if (!decoded || !records::is_within(*decoded, original, max_error_m)) continue;
    const std::int64_t length = std::abs(steps[0]) + std::abs(steps[1]) + std::abs(steps[2]);
    if (best && length >= least) continue;
    least = length;
    best = Correction{false, steps, *decoded};
  }
  return best;
}

Correction correction_of(const Numbers& numbers, const Vec3& predicted, const Vec3& original,
                         double max_error_m) {
  std::optional<Correction> found;
  if (numbers.kind() != NumberKind::steps) {
    const auto exact = records::exact_numbers_of(numbers, original);
    if (exact) found = {false, records::steps_between(numbers, predicted, original), original};
  } else if (records::is_within(predicted, original, max_error_m)) {
    found = {false, {}, predicted};
  } else {
    found = shortest(numbers, predicted, original, max_error_m);
  }
  return found ? *found : Correction{true, {}, original};
}

Status check_count(std::size_t predicted, std::size_t original) {
  if (predicted == original) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("{} predicted points for {} original ones", predicted, original)};
}

}  // namespace

Result<CodedCorrections> encode_corrections(std::span<const Vec3> predicted,
                                            std::span<const Vec3> original, ScalarType type,
                                            const CorrectionSettings& settings) {
  CURLIDAR_TRY(check_count(predicted.size(), original.size()));
  CURLIDAR_TRY(records::check_setting(settings.max_error_m, "largest error in metres"));
  CURLIDAR_TRY(records::check_points(predicted, type));
  CURLIDAR_TRY(records::check_points(original, type));
  const double bound = settings.max_error_m;
  const Numbers numbers = bound > 0 ? Numbers::of_steps(type, 2 * bound / std::sqrt(3.0))
                                    : records::exact_numbers(original, type);
  CodedCorrections result;
  std::vector<Correction> corrections;
  corrections.reserve(original.size());
  for (std::size_t i = 0; i < original.size(); ++i) {
    corrections.push_back(correction_of(numbers, predicted[i], original[i], bound));
    result.decoded.push_back(corrections.back().decoded);
    if (!records::same_bits(result.decoded.back(), predicted[i])) ++result.corrected;
  }
  const bool some_raw = std::any_of(corrections.begin(), corrections.end(),
                                    [](const Correction& c) { return c.raw; });
  const PointsHeader header{numbers, some_raw, original.size()};
  RangeEncoder encoder;
  records::RawCoder raw(header);
  CorrectionCoder coder(numbers);
  for (std::size_t i = 0; i < original.size(); ++i) {
    Correction& c = corrections[i];
    if (raw.code_flag(encoder, c.raw)) {
      raw.code_point(encoder, c.decoded);
    } else {
      coder.code(encoder, predicted[i], c.steps);
    }
  }
  ByteWriter writer;
  write_header(writer, header);
  writer.write_bytes(std::move(encoder).finish());
  result.bytes = std::move(writer).bytes();
  return result;
}

Status apply_corrections(const Chunk& chunk, ScalarType type, std::span<Vec3> points) {
  PayloadReader reader(chunk);
  CURLIDAR_TRY_ASSIGN(header, records::read_header(reader, points.size()));
  if (header.numbers.type() != type || header.count != points.size()) {
    return reader.corrupt(fmt::format("corrections of {} {} points for {} {} ones", header.count,
                                      to_string(header.numbers.type()), points.size(),
                                      to_string(type)));
  }
  RangeDecoder decoder(reader.take(reader.remaining()));
  records::RawCoder raw(header);
  CorrectionCoder coder(header.numbers);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3& p = points[i];
    bool finite = true;
    if (raw.code_flag(decoder, false)) {
      finite = raw.code_point(decoder, p);
    } else {
      Triple steps{};
      coder.code(decoder, p, steps);
      const auto corrected = records::moved(header.numbers, p, steps);
      finite = corrected.has_value();
      if (finite) p = *corrected;
    }
    if (!finite) return reader.corrupt(fmt::format("point {} is not finite", i));
    if (decoder.exhausted()) {
      return reader.corrupt(fmt::format("the corrections end after {} of {}", i, points.size()));
    }
  }
  return {};
}

}  // namespace curlidar
