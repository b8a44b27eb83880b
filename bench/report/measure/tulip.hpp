// SPDX-License-Identifier: BSD-3-Clause
// The protocol by which TULIP (Yang et al., CVPR 2024) scores the upsampling of KITTI scans.
#pragma once

#include "curlidar/result.hpp"
#include "protocol/tulip_image.hpp"

namespace curlidar::bench::tulip {

inline constexpr double kVoxel_m = .1;

struct Scores {
  double mae_m = 0;             ///< over all cells, empty ones included
  double both_valid_mae_m = 0;  ///< over predicted cells that have a range in both
  double chamfer_m2 = 0;        ///< sum of both mean squared distances to the nearest neighbour
  double iou = 0, precision = 0, recall = 0, f1 = 0;  ///< of voxels of kVoxel_m
  double mask_iou = 0;                                ///< of predicted cells that have a range
  double median_m = 0, p95_m = 0;  ///< of |error| in predicted cells that have a range in both
  double completeness = 0;         ///< share of the true returns of predicted rows with a range
};

/// `predicted` against `truth`; its given rows are those of `given`, and predictions outside
/// kLeast_m .. kMost_m are none. Errors: invalid_argument (an image without a range).
Result<Scores> score(const Image& predicted, const Image& given, const Image& truth);

}  // namespace curlidar::bench::tulip
