// SPDX-License-Identifier: BSD-3-Clause
// Proof that a file gives a scan back as it says.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// What a file and the cloud that it was made of have in common: slot by slot, or, where the file
/// gave up the order (RecordPromise::any_order), as sets of returns. Nobody knows then which return
/// is whose: `ok` says that there are as many; that they are the same if bits are promised; that
/// with a bound every return has one of the other cloud within it, both ways; and that the values
/// of attributes come in the same combinations equally often.
struct Verification {
  bool ok = false;         ///< everything below is as the file promises
  std::size_t points = 0;  ///< returns of the cloud
  /// Of the returns, each against its own original; without an order, against the nearest, both
  /// ways.
  double max_error_m = 0;
  double mean_error_m = 0, rms_error_m = 0;
  RecordPromise promise;
  bool bit_exact = false;   ///< all coordinates are the same bits
  bool order = false;       ///< slot by slot the same kinds; never told of files that gave it up
  bool shape = false;       ///< the same width and height
  bool attributes = false;  ///< those that the file holds are the cloud's, bit for bit
  std::vector<std::string> attributes_left_out;  ///< of the cloud, not in the file
  std::vector<std::string> failures;             ///< one sentence each; empty if ok
};

/// Decodes a compact file with every return and compares it with its cloud. Errors: those of
/// decode, and unsupported for files that do not hold every return in its slot. O(n), without an
/// order O(n log n).
Result<Verification> verify(std::span<const std::byte> bytes, const Cloud& cloud,
                            std::size_t threads = 1);

/// The same of a scan that is decoded already, as those of sequences are.
Result<Verification> verify(const DecodedScan& scan, const Cloud& cloud, std::size_t threads = 1);

}  // namespace curlidar
