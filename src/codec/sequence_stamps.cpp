// SPDX-License-Identifier: BSD-3-Clause
#include "codec/sequence_stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/try.hpp"

namespace curlidar {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kMostTime = std::int64_t{1} << 62;
constexpr std::int64_t kMostMove = std::int64_t{1} << 62;
constexpr std::int64_t kMostTurn = std::int64_t{1} << 30;
/// Rows of a matrix from text have six digits or more.
constexpr double kRotationTolerance = 1e-4;

std::uint64_t zigzag(std::uint64_t difference) {
  return (difference << 1) ^ (0 - (difference >> 63));
}

std::uint64_t unzigzag(std::uint64_t told) {
  return (told >> 1) ^ (0 - (told & 1));
}

/// Numbers that go on as they did; sums wrap around, alike for writers and readers.
class Course {
 public:
  std::uint64_t expected() const { return 2 * last_ - before_; }
  void take(std::uint64_t value) {
    before_ = seen_ ? last_ : value;
    last_ = value;
    seen_ = true;
  }

 private:
  std::uint64_t last_ = 0, before_ = 0;
  bool seen_ = false;
};

void write_number(Course& course, std::int64_t value, ByteWriter& writer) {
  const auto bits = static_cast<std::uint64_t>(value);
  writer.write_varint(zigzag(bits - course.expected()));
  course.take(bits);
}

Result<std::int64_t> read_number(Course& course, std::int64_t most, const char* what,
                                 ByteReader& reader) {
  const std::uint64_t bits = course.expected() + unzigzag(reader.read_varint());
  const auto value = static_cast<std::int64_t>(bits);
  if (!reader.ok() || value > most || value < -most) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {} of the group: no {} can be this one", reader.offset(), what)};
  }
  course.take(bits);
  return value;
}

struct PoseCourse {
  std::array<Course, 3> move;
  std::array<Course, 4> turn;
};

bool is_rotation(const RigidMotion& pose) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double wanted = i == k ? 1 : 0;
      if (!(std::abs(dot(pose.rotation[i], pose.rotation[k]) - wanted) < kRotationTolerance)) {
        return false;
      }
    }
  }
  const Vec3& z = pose.rotation[2];
  return dot(cross(pose.rotation[0], pose.rotation[1]), z) > 0;
}

/// w, x, y, z; the largest of them is above zero.
std::array<double, 4> quaternion_of(const RigidMotion& pose) {
  const auto& [x, y, z] = pose.rotation;
  const std::array<double, 4> squares{1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z,
                                      1 - x.x - y.y + z.z};
  const auto largest =
      static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double twice = std::sqrt(squares[largest]);
  const double wx = z.y - y.z, wy = x.z - z.x, wz = y.x - x.y;
  const double xy = y.x + x.y, xz = x.z + z.x, yz = z.y + y.z;
  const std::array<std::array<double, 4>, 4> products{{{twice * twice, wx, wy, wz},
                                                       {wx, twice * twice, xy, xz},
                                                       {wy, xy, twice * twice, yz},
                                                       {wz, xz, yz, twice * twice}}};
  std::array<double, 4> q{};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = products[largest][i] / (2 * twice);
    sum += q[i] * q[i];
  }
  for (double& part : q) part /= std::sqrt(sum);
  return q;
}

/// The same rotation by that one of its two quaternions that lies nearer to the one before.
void keep_sign(const FixedPose& before, FixedPose& pose) {
  double along = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    along += static_cast<double>(before.turn[i]) * static_cast<double>(pose.turn[i]);
  }
  if (along >= 0) return;
  for (std::int64_t& part : pose.turn) part = -part;
}

}  // namespace

Result<std::int64_t> fixed_time(double time_s) {
  const double whole = std::floor(time_s);
  const bool fits =
      std::isfinite(time_s) && std::abs(whole) < static_cast<double>(kMostTime / kSecond) - 1;
  if (!fits) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} s is no time that a sequence can hold", time_s)};
  }
  return static_cast<std::int64_t>(whole) * kSecond +
         static_cast<std::int64_t>(std::floor((time_s - whole) * kSecond + 0.5));
}

double time_of(std::int64_t time_ns) {
  std::int64_t whole = time_ns / kSecond, part = time_ns % kSecond;
  if (part < 0) {
    part += kSecond;
    --whole;
  }
  constexpr std::int64_t kExact = std::int64_t{1} << 53;
  if (std::abs(time_ns) < kExact) {
    return static_cast<double>(time_ns) / static_cast<double>(kSecond);
  }
  return static_cast<double>(whole) + static_cast<double>(part) / static_cast<double>(kSecond);
}

Result<FixedPose> fixed_pose(const RigidMotion& pose) {
  if (!is_rotation(pose)) {
    return Error{ErrorCode::invalid_argument,
                 "a pose's matrix is no rotation: its rows are not orthogonal and of length 1"};
  }
  FixedPose fixed;
  const std::array<double, 3> move{pose.move.x, pose.move.y, pose.move.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const double steps = std::floor(std::ldexp(move[i], FixedPose::kMoveBits) + 0.5);
    if (!(std::abs(steps) < static_cast<double>(kMostMove))) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("a pose lies at {} m, beyond what a sequence can hold", move[i])};
    }
    fixed.move[i] = static_cast<std::int64_t>(steps);
  }
  const std::array<double, 4> q = quaternion_of(pose);
  for (std::size_t i = 0; i < 4; ++i) {
    fixed.turn[i] =
        static_cast<std::int64_t>(std::floor(std::ldexp(q[i], FixedPose::kTurnBits) + 0.5));
  }
  return fixed;
}

RigidMotion pose_of(const FixedPose& pose) {
  RigidMotion motion;
  motion.move = {std::ldexp(static_cast<double>(pose.move[0]), -int{FixedPose::kMoveBits}),
                 std::ldexp(static_cast<double>(pose.move[1]), -int{FixedPose::kMoveBits}),
                 std::ldexp(static_cast<double>(pose.move[2]), -int{FixedPose::kMoveBits})};
  std::array<double, 4> q{};
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = static_cast<double>(pose.turn[i]);
    sum += q[i] * q[i];
  }
  if (!(sum > 0)) return motion;
  const double s = 2 / sum;
  const auto [w, x, y, z] = q;
  motion.rotation = {{{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                      {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                      {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}}};
  return motion;
}

Result<ScanStamp> rounded(const ScanStamp& stamp) {
  ScanStamp back;
  if (stamp.time_s) {
    CURLIDAR_TRY_ASSIGN(time, fixed_time(*stamp.time_s));
    back.time_s = time_of(time);
  }
  if (stamp.T_map_sensor) {
    CURLIDAR_TRY_ASSIGN(pose, fixed_pose(*stamp.T_map_sensor));
    back.T_map_sensor = pose_of(pose);
  }
  return back;
}

void write_stamps(const std::vector<ScanStamp>& stamps, ByteWriter& writer) {
  if (stamps.empty()) return;
  if (stamps.front().time_s) {
    Course course;
    for (const ScanStamp& stamp : stamps) {
      write_number(course, fixed_time(*stamp.time_s).value(), writer);
    }
  }
  if (!stamps.front().T_map_sensor) return;
  PoseCourse course;
  FixedPose before;
  for (const ScanStamp& stamp : stamps) {
    FixedPose pose = fixed_pose(*stamp.T_map_sensor).value();
    keep_sign(before, pose);
    for (std::size_t i = 0; i < 3; ++i) write_number(course.move[i], pose.move[i], writer);
    for (std::size_t i = 0; i < 4; ++i) write_number(course.turn[i], pose.turn[i], writer);
    before = pose;
  }
}

Result<std::vector<ScanStamp>> read_stamps(ByteReader& reader, std::size_t count, bool times,
                                           bool poses) {
  const std::size_t least = (times ? 1 : 0) + (poses ? 7 : 0);
  if (least > 0 && count > reader.remaining() / least) {
    return Error{ErrorCode::corrupt,
                 fmt::format("byte {} of the group: {} times or poses are not there",
                             reader.offset(), count)};
  }
  std::vector<ScanStamp> stamps(count);
  Course time_course;
  for (std::size_t i = 0; times && i < count; ++i) {
    CURLIDAR_TRY_ASSIGN(time, read_number(time_course, kMostTime, "time", reader));
    stamps[i].time_s = time_of(time);
  }
  PoseCourse course;
  for (std::size_t i = 0; poses && i < count; ++i) {
    FixedPose pose;
    for (std::size_t k = 0; k < 3; ++k) {
      CURLIDAR_TRY_ASSIGN(move, read_number(course.move[k], kMostMove, "place", reader));
      pose.move[k] = move;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      CURLIDAR_TRY_ASSIGN(turn, read_number(course.turn[k], kMostTurn, "turn", reader));
      pose.turn[k] = turn;
    }
    stamps[i].T_map_sensor = pose_of(pose);
  }
  return stamps;
}

}  // namespace curlidar
