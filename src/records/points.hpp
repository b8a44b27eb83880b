// SPDX-License-Identifier: BSD-3-Clause
// What the chunks of points share: how points become numbers, how the numbers are stated, and
// points that are told raw.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/payload.hpp"
#include "records/coordinates.hpp"
#include "records/integers.hpp"
#include "records/point_predictor.hpp"

namespace curlidar::records {

using Triple = std::array<std::int64_t, 3>;

inline std::array<double, 3> as_array(const Vec3& p) {
  return {p.x, p.y, p.z};
}

inline bool same_bits(const Vec3& a, const Vec3& b) {
  return std::bit_cast<std::array<std::uint64_t, 3>>(a) ==
         std::bit_cast<std::array<std::uint64_t, 3>>(b);
}

/// The point that numbers stand for, if there is one.
std::optional<Vec3> point_of(const Numbers& numbers, const Triple& triple);
inline Triple numbers_of(const Numbers& numbers, const Vec3& p) {
  return {numbers.number(p.x), numbers.number(p.y), numbers.number(p.z)};
}
inline Position position_of(const Numbers& numbers, const Vec3& p) {
  return {numbers.position_of_value(p.x), numbers.position_of_value(p.y),
          numbers.position_of_value(p.z)};
}
/// The numbers of exactly this point, if it has any.
std::optional<Triple> exact_numbers_of(const Numbers& numbers, const Vec3& p);

/// Encoder: invalid_argument unless the type is one of coordinates and all points are finite values
/// of it.
Status check_points(std::span<const Vec3> points, ScalarType type);

/// Encoder: a setting that must be finite and not negative; `what` is its name.
Status check_setting(double value, const char* what);

/// Encoder: numbers that most of the points have exactly: decimals where that saves bits, else the
/// ranks of the type's values.
Numbers exact_numbers(std::span<const Vec3> points, ScalarType type);

/// Header of a chunk of points.
struct PointsHeader {
  Numbers numbers;
  bool some_raw = false;  ///< a decision before each point says whether it is raw
  std::uint64_t count = 0;
};
void write_header(ByteWriter& writer, const PointsHeader& header);
/// Errors: corrupt; limit_exceeded if there are more than `max_points`.
Result<PointsHeader> read_header(PayloadReader& reader, std::uint64_t max_points);

/// Codes whether points are raw, and raw points.
class RawCoder {
 public:
  explicit RawCoder(const PointsHeader& header)
      : some_(header.some_raw), type_(header.numbers.type()) {}

  template <class Coder>
  bool code_flag(Coder& coder, bool raw) {
    if (!some_) return false;
    last_ = code_bit(coder, models_[last_], kLimit, raw) ? 1 : 0;
    return last_ != 0;
  }

  /// The ranks of the coordinates; false if the decoder's are not those of finite numbers.
  template <class Coder>
  bool code_point(Coder& coder, Vec3& p) {
    const unsigned bits = type_ == ScalarType::float32 ? 32 : 64;
    bool finite = true;
    for (double* x : {&p.x, &p.y, &p.z}) {
      const auto rank = static_cast<std::uint64_t>(rank_of(*x, type_));
      *x = value_of_rank(static_cast<std::int64_t>(code_plain(coder, rank, bits)), type_);
      finite = finite && std::isfinite(*x);
    }
    return finite;
  }

 private:
  static constexpr std::uint32_t kLimit = 255;

  bool some_;
  ScalarType type_;
  std::array<BitModel, 2> models_;
  std::size_t last_ = 0;
};

}  // namespace curlidar::records
