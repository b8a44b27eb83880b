// SPDX-License-Identifier: BSD-3-Clause
// Scans one after the other: each may be predicted from the one before. Frames in memory first,
// then files of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/motion.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/result.hpp"
#include "curlidar/verify.hpp"

namespace curlidar {

/// Scans of a group: seeking decodes this many at most, damage reaches no further.
inline constexpr std::uint32_t kSequenceGroup = 10;
inline constexpr std::uint32_t kMaxSequenceGroup = 65536;

struct SequenceSettings {
  /// Of every scan. One segment is enough: parts of a scan are not what anyone seeks here.
  EncodeSettings encode = [] {
    EncodeSettings settings;
    settings.compact.index = false;
    return settings;
  }();
  std::uint32_t group = kSequenceGroup;  ///< 1: no scan is predicted
  bool still = false;                    ///< the sensor does not move: no motion is looked for
};

/// When and where a scan was taken, if that is known. A file keeps times to the nanosecond (as far
/// as a double tells it), positions to 2^-20 m and turns to 2^-27 rad.
struct ScanStamp {
  std::optional<double> time_s{};
  std::optional<RigidMotion> T_map_sensor{};
};

/// What a frame needs to be decoded, as its first byte tells.
enum class FrameKind : std::uint8_t {
  first = 0,      ///< nothing: it starts a group
  alone = 1,      ///< the bytes, but not the scans, of the frames before it in its group
  predicted = 2,  ///< the scan before it
};
const char* to_string(FrameKind kind);  ///< "first", "alone", "predicted"

struct EncodedFrame {
  std::vector<std::byte> bytes;
  FrameKind kind = FrameKind::first;
  EncodeReport report;  ///< `bytes` and bits count the frame, not the scan as a file of its own
};

/// Codes scans as they come. Holds one decoded scan, whatever the number of frames.
class SequenceEncoder {
 public:
  /// Errors: invalid_argument for a group of no or too many scans.
  static Result<SequenceEncoder> create(const SequenceSettings& settings);
  SequenceEncoder(SequenceEncoder&&) noexcept;
  SequenceEncoder& operator=(SequenceEncoder&&) noexcept;
  ~SequenceEncoder();

  /// The next frame; same bytes for any number of threads. `stamp` helps to find the motion between
  /// two scans and is not part of the frame. Errors: as of encode; the frame is then left out, and
  /// the next scan is coded as if this one had not been.
  Result<EncodedFrame> add(const Cloud& cloud, const ScanStamp& stamp = {},
                           const ProgressCallback& progress = {});
  /// The next frame starts a group.
  void start_group();

 private:
  struct State;
  explicit SequenceEncoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Decodes frames in the order in which they were made, or from the first of a group on.
class SequenceDecoder {
 public:
  explicit SequenceDecoder(const DecodeLimits& limits = {}, std::size_t threads = 1);
  SequenceDecoder(SequenceDecoder&&) noexcept;
  SequenceDecoder& operator=(SequenceDecoder&&) noexcept;
  ~SequenceDecoder();

  /// The scan of a frame. Options on parts, partition and layers are those of `options`; limits and
  /// threads are the decoder's. Never throws, whatever the bytes. Errors: those of decode, and
  /// corrupt for a frame whose forerunners were not given; a frame that fails leaves the decoder
  /// where only the first frame of a group can follow.
  Result<DecodedScan> add(std::span<const std::byte> frame, const DecodeOptions& options = {});
  /// Passes a frame over without decoding its scan: the next one shall not be predicted.
  Status skip(std::span<const std::byte> frame);
  /// The frame as a .curl file of its own. Errors: unsupported for predicted frames. The decoder
  /// goes on as after skip.
  Result<std::vector<std::byte>> file_of(std::span<const std::byte> frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Kind of a frame; corrupt if its first byte tells none.
Result<FrameKind> frame_kind(std::span<const std::byte> frame);

}  // namespace curlidar
