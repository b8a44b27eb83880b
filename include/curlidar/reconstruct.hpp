// SPDX-License-Identifier: BSD-3-Clause
// Clouds and meshes from a decoded scan: at any density, in any directions, as any sensor sees it.
//
// Everything comes from the continuous field of the file; points are given where it believes in a
// surface. The returns that were coded are given as they are by `reconstruct` with factors 1 x 1,
// and kept among invented points on request.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/dense.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/vec3.hpp"

namespace curlidar {

/// Factors on the coded lattice's rows and columns, and points on a square metre, lie between
/// these.
inline constexpr double kLeastFactor = 1e-3, kMostFactor = 4096;
inline constexpr double kLeastDensity = 1e-3, kMostDensity = 1e8;

struct ReconstructSettings {
  double rows = 1;         ///< R_row: factor on the coded lattice's rows, may be fractional
  double columns = 1;      ///< R_col
  bool masks = true;       ///< only what is believed; off gives a point wherever one can be guessed
  bool organised = false;  ///< keep the grid, with NaN where there is nothing
  /// What decides between the samples; usual_strategy() if not told.
  std::optional<DenseStrategy> strategy{};
  /// What scans of the sensor taught, for strategy best; one that does not fit the file's rings is
  /// left aside (check_density_profile tells). What its rows measure too far, their range offsets,
  /// is given to those who ask as its sensor: by reconstruct_sensor, and by grids with as many rows
  /// as it has.
  std::shared_ptr<const DensityProfile> density_profile{};
  /// What continuous_field() made of the scan, for more than one question to it; if null it is made
  /// anew. Strategy and density profile are those that it was made with.
  std::shared_ptr<const Field> field{};
  /// Invented points are left out below this confidence, in [0, 1]. Of strategy best.
  double min_confidence = 0;
  /// Attribute "confidence" (float32): of coded returns 1; of invented points with strategy best.
  bool confidence = false;
  /// Attributes "normal_x", "normal_y", "normal_z" (float32): of the surface, towards the sensor;
  /// NaN where it is not known.
  bool normals = false;
  /// All coded returns come first, exactly and with their own attributes; no invented point lies
  /// within half a cell (of densities: half the spacing) of one. Of grids and densities only.
  bool keep_originals = false;
  /// Attribute "original" (uint8): 1 of coded returns, 0 of invented points. Grids other than 1 x 1
  /// and densities hold coded returns only if they are kept: all their other points are invented.
  bool original = false;
  /// The part of the scan that was decoded: nothing is invented outside its azimuths.
  std::optional<ScanRegion> region{};
  std::size_t threads = 1;                ///< never changes the result; 0 = all cores
  std::uint64_t max_points = 1ull << 31;  ///< refuse larger results
};

/// What decides between the samples of a file unless told otherwise: best, but of the paper's
/// profiles masks.
DenseStrategy usual_strategy(const DecodedScan& scan);

/// The continuous field that all of these ask: the scan's own, seen with a strategy (nullopt: the
/// usual one). For queries of one's own: Field::range_at. O(cells) to make. `rows_of_profile`: see
/// DenseSettings.
std::shared_ptr<const Field> continuous_field(
    const DecodedScan& scan, std::optional<DenseStrategy> strategy = {},
    std::shared_ptr<const DensityProfile> density_profile = {}, bool rows_of_profile = false);

/// Invalid_argument for settings that points cannot be invented with, whatever is asked for:
/// factors or a confidence out of bounds, confidence or a density profile with strategy masks,
/// which tells of none. All of the functions below refuse them; `reconstruct` with factors 1 x 1
/// and masks, which invents nothing, only what is out of bounds.
Status check_settings(const DecodedScan& scan, const ReconstructSettings& settings);

/// The cloud seen on an R_row x R_col times denser grid. With factors 1 x 1 and masks: the coded
/// returns one for one with their attributes, or the encoded cloud of files with every return,
/// whatever the strategy, the confidence wanted, and whether originals are to be kept.
///
/// Attributes of invented points: measured ones (intensity, ...) are interpolated between the coded
/// returns of the surface, those that name or count (ring, time, returns, labels, packed colours,
/// 64-bit integers) are taken from the nearest. Compact files cut off or decoded in part give what
/// is there; nothing there is an empty cloud. Errors: invalid_argument (check_settings, files
/// without a field), limit_exceeded (max_points, counted before the work). 1 to 2.5 us a line.
Result<Cloud> reconstruct(const DecodedScan& scan, const ReconstructSettings& settings = {},
                          const ProgressCallback& progress = {});

/// One point for each direction (any length > 0) from the origin of the cloud's frame, in the same
/// order; NaN where nothing is believed. `rows`, `columns` and `organised` do not matter. Errors:
/// invalid_argument (also: a direction that is zero or not finite, named by its index).
Result<Cloud> reconstruct_directions(const DecodedScan& scan, std::span<const Vec3> directions,
                                     const ReconstructSettings& settings = {},
                                     const ProgressCallback& progress = {});

/// The scan as another spinning sensor at the same place sees it: every ring and column of the
/// profile, from where its beams start, between its limits of range. Ring by ring from the top;
/// `organised` keeps rings x columns with NaN. Attribute "ring" (uint16) is that of the profile.
/// Errors: invalid_argument (a profile that validate() refuses), unsupported (limited fields of
/// view), limit_exceeded.
Result<Cloud> reconstruct_sensor(const DecodedScan& scan, const SensorProfile& sensor,
                                 const ReconstructSettings& settings = {},
                                 const ProgressCallback& progress = {});

/// About `points_per_m2` points on every square metre of surface that is believed, near or far,
/// straight or at an angle: returns that lie closer than that are thinned, wide gaps on one surface
/// are filled. Unorganised. Errors: invalid_argument (a density outside [1e-3, 1e8]),
/// limit_exceeded: as soon as the surfaces are known to need more than max_points.
Result<Cloud> reconstruct_density(const DecodedScan& scan, double points_per_m2,
                                  const ReconstructSettings& settings = {},
                                  const ProgressCallback& progress = {});

/// Triangles with their front, counter-clockwise, to the sensor.
struct SurfaceMesh {
  std::vector<Vec3> vertices;
  std::vector<Vec3> normals;  ///< of the vertices, unit length, if asked for; else empty
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The surfaces between neighbouring points of the R_row x R_col times denser grid: two neighbours
/// are joined where the field believes in a surface half way, on the straight line between them;
/// so cliffs and gaps stay open. Four evaluations a vertex. Errors: those of reconstruct;
/// limit_exceeded also beyond 2^32 vertices.
Result<SurfaceMesh> reconstruct_mesh(const DecodedScan& scan,
                                     const ReconstructSettings& settings = {},
                                     const ProgressCallback& progress = {});

}  // namespace curlidar
