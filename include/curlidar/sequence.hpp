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

namespace curlidar {

class RandomAccess;

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

/// Writes a sequence file as the scans come: it holds the frames of one group, whatever their
/// number. The file appears when it is finished; until then, and on errors, there is none.
class SequenceWriter {
 public:
  /// Errors: invalid_argument; io where no file can be made.
  static Result<SequenceWriter> create(const std::string& path, const SequenceSettings& settings);
  SequenceWriter(SequenceWriter&&) noexcept;
  SequenceWriter& operator=(SequenceWriter&&) noexcept;
  /// Without finish() before it, nothing is left.
  ~SequenceWriter();

  /// Codes and keeps a scan. Either all scans of a group have a time or none; likewise poses.
  /// Errors: as of SequenceEncoder::add; of stamps that cannot be kept; io.
  Result<EncodedFrame> add(const Cloud& cloud, const ScanStamp& stamp = {},
                           const ProgressCallback& progress = {});
  /// Bytes of the file. Errors: invalid_argument without a scan; io.
  Result<std::uint64_t> finish();

 private:
  struct State;
  explicit SequenceWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// What a file tells of a scan without decoding it.
struct SequenceScan {
  FrameKind kind = FrameKind::first;
  std::size_t group = 0;
  std::size_t bytes = 0;  ///< of its frame
  std::uint64_t returns = 0;
  ScanStamp stamp;
};

/// What a file tells of a group without reading it.
struct SequencePart {
  std::uint64_t first_scan = 0, scans = 0, returns = 0;
  std::uint64_t bytes = 0;
  std::optional<double> time_s{};  ///< of its first scan
};

struct SequenceReadOptions {
  DecodeLimits limits{};
  std::size_t threads = 1;
  /// Takes files that are cut off or whose index is damaged as far as they go.
  bool allow_truncated = false;
};

/// A sequence file: any scan of it, at the cost of those of its group before it. Scans that are
/// read in their order cost one decoding each. Groups that are damaged harm no others.
class SequenceFile {
 public:
  /// Errors: not_found, io; corrupt; unsupported (another kind of file); limit_exceeded.
  static Result<SequenceFile> open(const std::string& path,
                                   const SequenceReadOptions& options = {});
  /// The same from memory; `name` is used for messages.
  static Result<SequenceFile> parse(std::vector<std::byte> bytes, const std::string& name,
                                    const SequenceReadOptions& options = {});
  SequenceFile(SequenceFile&&) noexcept;
  SequenceFile& operator=(SequenceFile&&) noexcept;
  ~SequenceFile();

  std::size_t scans() const;
  std::uint64_t bytes() const;  ///< of the whole file
  std::uint32_t group_size() const;
  bool still() const;
  const std::vector<SequencePart>& groups() const;
  /// What should be there and is not, one sentence each: the file was cut off.
  const std::vector<std::string>& missing() const;

  /// What is known of a scan. Errors: invalid_argument behind the end; corrupt if its group is
  /// damaged, naming the scans that are lost.
  Result<SequenceScan> scan(std::size_t index);
  /// A scan. Limits and threads are the file's, `allow_truncated` means nothing here. Errors: as
  /// of scan(), and those of decode().
  Result<DecodedScan> decode(std::size_t index, const DecodeOptions& options = {});

 private:
  struct State;
  explicit SequenceFile(std::unique_ptr<State> state);
  static Result<SequenceFile> open(std::shared_ptr<const RandomAccess> source,
                                   const SequenceReadOptions& options);
  std::unique_ptr<State> state_;
};

/// Whether a file is a sequence, told by its first bytes; false if it cannot be read.
bool is_sequence_file(const std::string& path);
bool is_sequence(std::span<const std::byte> bytes);

}  // namespace curlidar
