// SPDX-License-Identifier: BSD-3-Clause
// Scans that are coded from the decoded scan before: Profile::compact, scan to scan.
#pragma once

#include <memory>
#include <optional>

#include "compact/scan_decoder.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/motion.hpp"

namespace curlidar {

/// A decoded scan that another one may be predicted from.
class PredictionReference {
 public:
  /// Shares the scan's field. Errors: unsupported for scans without an image of the compact profile
  /// or decoded in part.
  static Result<std::shared_ptr<const PredictionReference>> of(const DecodedScan& scan);

  const compact::DecodedScan& scan() const { return *scan_; }

 private:
  std::shared_ptr<const Field> field_;  ///< owns the scan
  const compact::DecodedScan* scan_ = nullptr;
};

/// What is known of the motion between a scan and its reference.
struct PredictionGuess {
  bool still = false;  ///< the sensor stood still: no motion is looked for
  /// T_reference_scan: takes points from the scan's frame to that of the reference; where the
  /// search for it begins.
  std::optional<RigidMotion> motion{};
};

/// Codes a scan as `encode` does, predicted from the reference: only who has decoded this can
/// decode it (DecodeOptions::reference). Whether that is smaller than a file of its own is for the
/// caller to compare. Errors: those of encode, and unsupported for scans without an image and other
/// profiles. 0.5 to 1.4 times the time of encode.
Result<Encoded> encode_predicted(const Cloud& cloud, const EncodeSettings& settings,
                                 const std::shared_ptr<const PredictionReference>& reference,
                                 const PredictionGuess& guess = {},
                                 const ProgressCallback& progress = {});

}  // namespace curlidar
