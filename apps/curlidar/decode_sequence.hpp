// SPDX-License-Identifier: BSD-3-Clause
// Which scans of sequence files `curlidar decode` is to write, and where to.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common_inputs.hpp"
#include "curlidar/sequence.hpp"
#include "decode_plan.hpp"

namespace curlidar::app {

/// Scans [begin, end) of a sequence.
struct ScanInterval {
  std::size_t begin = 0, end = 0;
};
/// "12" or "10:20", as Python counts: from 0, the end not included, either end may be left out;
/// empty: all. Failure(kExitUsage) if it is neither; Failure(kExitInput) if the sequence has no
/// such scan.
ScanInterval parse_scans(const std::string& text, std::size_t scans, const std::string& path);

/// The work on the inputs of one command line. A file stays open while its scans are decoded one
/// after the other.
class SequenceJobs {
 public:
  SequenceJobs(const DecodeCommand& command, const DecodePlan& plan)
      : command_(command), plan_(plan) {}

  /// One job an input or, of sequences, one a scan. Failure for inputs of both kinds at once.
  std::vector<Job> plan_jobs();
  /// The scan of a job; Failure.
  DecodedScan decode(const Job& job);
  /// Warns of what files lack that were cut off; the exit code that this means.
  int finish() const;

 private:
  SequenceFile& file(const std::string& path);
  void plan_scans(const std::string& path, std::vector<Job>& jobs);

  const DecodeCommand& command_;
  const DecodePlan& plan_;
  std::string open_path_;
  std::optional<SequenceFile> open_;
  std::vector<std::string> missing_;
};

}  // namespace curlidar::app
