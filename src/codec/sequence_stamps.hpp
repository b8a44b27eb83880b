// SPDX-License-Identifier: BSD-3-Clause
// Times and poses of a group of scans as whole numbers, each told by what two before foretell.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar {

/// T_map_sensor: where the sensor is in 2^-20 m, and a quaternion w, x, y, z in 2^-28.
struct FixedPose {
  static constexpr unsigned kMoveBits = 20, kTurnBits = 28;
  std::array<std::int64_t, 3> move{};
  std::array<std::int64_t, 4> turn{std::int64_t{1} << kTurnBits, 0, 0, 0};
};

/// Nanoseconds. Invalid_argument if the time is not finite or not within 2^62 ns of zero.
Result<std::int64_t> fixed_time(double time_s);
/// The double nearest to it, or one beside that.
double time_of(std::int64_t time_ns);

/// Invalid_argument if the matrix is not that of a rotation or the place beyond 2^42 m.
Result<FixedPose> fixed_pose(const RigidMotion& pose);
/// A rotation to the last bits, whatever the numbers.
RigidMotion pose_of(const FixedPose& pose);

/// What comes back of a stamp that is written; errors as above.
Result<ScanStamp> rounded(const ScanStamp& stamp);

/// Column by column. Every scan has a time or none has, likewise poses: what the first has. Writing
/// takes stamps that `rounded` accepts.
void write_stamps(const std::vector<ScanStamp>& stamps, ByteWriter& writer);
/// `count` stamps; corrupt where the bytes end or make no numbers in range. Allocates no more than
/// the bytes hold.
Result<std::vector<ScanStamp>> read_stamps(ByteReader& reader, std::size_t count, bool times,
                                           bool poses);

}  // namespace curlidar
