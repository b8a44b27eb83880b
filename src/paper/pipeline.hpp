// SPDX-License-Identifier: BSD-3-Clause
// The paper's figure, left to right: outliers, depth image, mesh, upsampling, masks, patches.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/settings.hpp"
#include "image/range_image.hpp"
#include "paper/fit.hpp"
#include "paper/masks.hpp"
#include "paper/polar_mesh.hpp"
#include "paper/upsample.hpp"

namespace curlidar {

/// Ranges of every setting that the pipeline and the decoder rely on.
Status validate(const PaperSettings& settings);

/// Whether patches of these sizes take a bearable time on a lattice: making their bases, which
/// decoders must do, ten seconds at most. Limit_exceeded if not; the presets never are.
Status check_patches(const PaperSettings& settings, const Lattice& lattice);

/// Everything before the fit.
struct PaperStages {
  RangeImage image;
  PolarMesh mesh;  ///< empty when nothing is upsampled and no mesh was asked for
  CellMasks masks;
  SampleImage samples;
  ProjectionCounts counts;
  std::vector<StageTime> times;
};

struct StageOptions {
  bool always_mesh = false;  ///< build the mesh even if nothing is upsampled
  std::size_t threads = 1;
};
PaperStages run_stages(const Cloud& cloud, const Detection& detection,
                       const PaperSettings& settings, const StageOptions& options,
                       const ProgressCallback& progress);

/// What a file of the paper profiles holds: masks and patches on a lattice.
struct PaperModel {
  Lattice lattice;
  PaperSettings settings;  ///< max_range is the largest kept range, in metres
  CellMasks masks;
  std::vector<PatchFit> patches;  ///< row-major, empty ones without coefficients
};

/// Two passes of fitting: samples off by reject_m or more after the first are left out of the
/// second. Then the masks are updated: original cells off by as much lose their return, and
/// upsampled ones set the cliff they lie on. Same result for any thread count.
PaperModel fit_patches(const PaperStages& stages, const PaperSettings& settings,
                       std::size_t threads, const ProgressCallback& progress);

}  // namespace curlidar
