// SPDX-License-Identifier: BSD-3-Clause
// The figures of the literature for two clouds: a reference (the scan) and what was made of it.
// All are over returns; lengths are metres. Every function gives the same for any number of
// threads (0 = all cores).
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Share of returns with a neighbour within `threshold`, from either side.
struct Match {
  double threshold = 0;
  double precision = 0;  ///< of the made cloud's returns: the rest is invented
  double recall = 0;     ///< of the reference's returns, its completeness: the rest is missed
  double f_score = 0;    ///< harmonic mean of the two, 0 if both are
};

/// Mean squared errors both ways, m2, and what MPEG's pc_error makes of them: the worse direction.
struct GeometryError {
  double a_to_b_mse = 0, b_to_a_mse = 0;
  double mse = 0;   ///< the larger
  double rms = 0;   ///< its square root, m
  double psnr = 0;  ///< of `mse`, dB; infinite without error
};

/// Overlap of the cubes that two clouds occupy. The grid starts at the smallest coordinates of both
/// clouds, as in the protocol of TULIP (CVPR 2024).
struct VoxelOverlap {
  double voxel = 0;  ///< edge, m
  std::size_t occupied_a = 0, occupied_b = 0, occupied_both = 0;
  double iou = 0, precision = 0, recall = 0, f1 = 0;
};

struct MetricsSettings {
  std::vector<double> thresholds = {0.02, 0.05, 0.1, 0.2};  ///< m, each at least 0
  double peak = 59.70;  ///< of the PSNR, m; above 0. What LiDAR literature takes for KITTI
  double voxel = 0.1;   ///< m, above 0
  bool planes = false;  ///< D2 as well: it needs normals, which cost more than all the rest
  std::size_t normal_neighbours = 12;  ///< see surface_normals
  std::size_t quantiles = 0;           ///< so many of the distances each way; 0 or at least 2
};

/// a is the reference, b what was made of it.
struct Metrics {
  Comparison directed;           ///< what compare() gives
  double symmetric_mean = 0;     ///< the larger of the two mean distances
  double symmetric_rms = 0;      ///< the larger of the two rms distances
  double chamfer_squared = 0;    ///< m2: sum of the two mean squared distances (TULIP's protocol)
  double chamfer = 0;            ///< m: mean of the two mean distances
  std::vector<Match> matches;    ///< one for each threshold
  GeometryError point_to_point;  ///< D1
  std::optional<GeometryError> point_to_plane;  ///< D2, if asked for
  bool normals_given = false;                   ///< D2 took the reference's own normals
  VoxelOverlap voxels;
  std::vector<double> quantiles_a_to_b, quantiles_b_to_a;
};

/// Everything above. D2 follows pc_error: normals belong to the reference; each return of b gets
/// the mean of the normals of the returns of a that it is nearest to, or if there is none, the
/// normal of the return of a nearest to it. The vector from a point to its nearest neighbour is
/// projected on the neighbour's normal; without a normal its length counts. Of equally near
/// neighbours the first in its cloud is taken. O(n log n).
/// Errors: invalid_argument (a cloud without returns, a setting out of its range).
Result<Metrics> measure(const Cloud& a, const Cloud& b, const MetricsSettings& settings = {},
                        std::size_t threads = 1);

/// 10 log10(3 peak^2 / mse), dB: pc_error's for geometry. Infinite if mse is 0.
double psnr(double mse, double peak);
/// Share of the distances that are at most `threshold`; NaN entries do not count, 0 if none is
/// left.
double share_within(const std::vector<double>& distances, double threshold);
/// The values at `count` fractions 0, 1 / (count - 1), .. 1 of the sorted distances, linear between
/// order statistics: a cumulative distribution to plot. NaN entries do not count; empty if none is
/// left or count is below 2. O(n log n).
std::vector<double> quantiles(std::vector<double> distances, std::size_t count);
/// Errors: invalid_argument (a cloud without returns, a voxel that is not above 0). O(n log n).
Result<VoxelOverlap> voxel_overlap(const Cloud& a, const Cloud& b, double voxel = 0.1);

/// Unit normals, one a slot: the attributes normal_x, normal_y and normal_z if the cloud has them
/// all, else those of the planes through the `neighbours` nearest returns (itself among them, by
/// principal components), turned towards the origin. NaN where there is no return or its
/// neighbours span no plane. O(n log n).
std::vector<Vec3> surface_normals(const Cloud& cloud, std::size_t neighbours = 12,
                                  std::size_t threads = 1);
/// The cloud has normal_x, normal_y and normal_z.
bool has_normals(const Cloud& cloud);

struct ImageSettings {
  /// Ranges outside count as empty pixels, in both images.
  double min_range = 0, max_range = std::numeric_limits<double>::infinity();
};

/// Two range images, pixel by pixel: a is the reference. Means over no pixel are NaN.
struct ImageMetrics {
  std::size_t pixels = 0;
  std::size_t valid_a = 0, valid_b = 0, valid_both = 0;
  std::size_t missed = 0;    ///< in a only
  std::size_t invented = 0;  ///< in b only
  double mask_iou = 0;       ///< valid_both over pixels valid in either
  double mae_all = 0;        ///< m, over all pixels, an empty one being range 0 (TULIP's protocol)
  double mae_both = 0, rmse_both = 0;  ///< m, over pixels valid in both
  /// m2: sum of the two mean squared distances to the nearest pixel's point, over all pixels, an
  /// empty one being a point at the origin. It is what the published code of TULIP computes;
  /// Metrics::chamfer_squared is over returns.
  double chamfer_squared_all = 0;
};
/// Ranges of organised clouds of one shape, pixel by pixel. Errors: invalid_argument (a cloud is
/// not organised, shapes differ, the limits of range make no sense). O(n).
Result<ImageMetrics> compare_images(const Cloud& a, const Cloud& b,
                                    const ImageSettings& settings = {}, std::size_t threads = 1);

}  // namespace curlidar
