// SPDX-License-Identifier: BSD-3-Clause
// The peers on raw scans: every return goes in.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "curlidar/result.hpp"

namespace curlidar::bench {

struct CloudOptions {
  std::vector<std::string> codecs;  ///< by name; empty = all
  std::size_t settings = 0;         ///< at most so many of each codec's sweep; 0 = all of it
};

/// Prints a line with the number of returns, then one for each codec and setting: bytes, how many
/// points come back, nearest-neighbour distances both ways against the raw returns (metres), CPU
/// milliseconds of encoding and decoding. Errors: an unreadable scan, a codec that is not known.
Status print_cloud(const std::string& scan_path, const CloudOptions& options);

}  // namespace curlidar::bench
