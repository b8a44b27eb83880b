// SPDX-License-Identifier: BSD-3-Clause
// What `curlidar info` tells of a sequence.
#pragma once

#include <string>

#include "common_inputs.hpp"

namespace curlidar::app {

struct SequenceInfoOptions {
  std::string poses_out, times_out;
  bool allow_truncated = false;
};

/// Every scan of the file, decoding none. Writes its poses and times to the files named, if any.
/// Groups that are damaged or cut off are named and make the exit code that of damaged input.
/// Failure.
Outcome describe_sequence(const std::string& path, const SequenceInfoOptions& options);

}  // namespace curlidar::app
