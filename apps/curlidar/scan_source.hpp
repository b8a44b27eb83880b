// SPDX-License-Identifier: BSD-3-Clause
// Scans one after the other, wherever they come from: files, folders, sequence files.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common_inputs.hpp"
#include "curlidar/sequence.hpp"

namespace curlidar::app {

/// A list of scans, read one at a time. Inputs are cloud files, .curl files of a scan, sequence
/// files, and folders.
class ScanSource {
 public:
  struct Settings {
    std::optional<CloudFormat> format{};  ///< of cloud files; by content if none
    std::size_t threads = 1;
  };
  /// Lists, but reads no scan. Failure for folders without scans and damaged sequence files.
  ScanSource(const std::vector<std::string>& inputs, const Settings& settings);
  ~ScanSource();
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;

  std::size_t size() const { return scans_.size(); }
  /// "scans/000012.bin", or "drive.curl, scan 12".
  std::string name(std::size_t index) const;
  /// The points as they were given to `encode`, or decoded. Failure.
  Cloud cloud(std::size_t index);
  /// What a sequence file tells; empty for other files.
  ScanStamp stamp(std::size_t index);
  /// Whether every scan has a pose of its own.
  bool has_poses();

 private:
  struct Scan {
    std::string path;
    std::optional<std::size_t> in_sequence{};
  };
  SequenceFile& sequence(const std::string& path);

  Settings settings_;
  std::vector<Scan> scans_;
  std::string open_path_;
  std::optional<SequenceFile> open_;
};

}  // namespace curlidar::app
