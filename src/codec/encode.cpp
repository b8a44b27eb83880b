// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "base/stopwatch.hpp"
#include "base/try.hpp"
#include "codec/chosen_attributes.hpp"
#include "codec/compact_encode.hpp"
#include "codec/field_chunks.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/paper.hpp"
#include "format/parameters_chunk.hpp"
#include "format/sensor_chunk.hpp"
#include "paper/global_fit.hpp"
#include "paper/pipeline.hpp"

namespace curlidar {
namespace {

/// A scan made ready for the pipeline: checked settings, the sensor, the ring of every point.
struct Prepared {
  PaperSettings settings;
  Detection detection;
};

/// The file's sensor describes the rows of its lattice: the rings as this scan shows them from the
/// origin, which is not where the beams of every sensor start.
void look_along_rings(Detection& detection) {
  for (std::size_t k = 0; k < detection.sensor.rings.size(); ++k) {
    Ring& ring = detection.sensor.rings[k];
    ring.elevation = detection.ring_elevations[k];
    ring.vertical_offset_m = 0;
  }
}

Result<Prepared> prepare(const Cloud& cloud, const EncodeSettings& settings) {
  Prepared out{settings.paper, {}};
  CURLIDAR_TRY(validate(out.settings));
  if (count_returns(cloud) == 0) {
    return Error{ErrorCode::invalid_argument,
                 "the cloud has no return: every point is (0, 0, 0) or not finite"};
  }
  CURLIDAR_TRY_ASSIGN(
      detection, settings.sensor ? assign_rings(cloud, *settings.sensor) : detect_sensor(cloud));
  if (detection.sensor.pattern == ScanPattern::limited_field) {
    return Error{ErrorCode::unsupported,
                 "the scan comes from a limited-field scanner, which the paper profiles cannot "
                 "code: they need a sensor that spins through the full turn"};
  }
  out.detection = std::move(detection);
  if (out.settings.row_rule == RowRule::rings) look_along_rings(out.detection);
  return out;
}

/// The points that cells with a bit in the mask come from, in raster order.
std::vector<std::uint32_t> coded_points(const RangeImage& image, const CellMasks& masks) {
  std::vector<std::uint32_t> coded;
  for (std::size_t cell = 0; cell < image.source.size(); ++cell) {
    if (masks.point[cell]) coded.push_back(image.source[cell]);
  }
  return coded;
}

double cp_paper(std::size_t coefficients, std::size_t cells, std::size_t gridded_points) {
  if (gridded_points == 0) return 0;
  const double bytes = 8.0 * static_cast<double>(coefficients) + 0.5 * static_cast<double>(cells);
  return 100 * bytes / (24.0 * static_cast<double>(gridded_points));
}

/// Adds the chunk of the fitted field; returns its masks and settings through `parameters`.
CellMasks add_field(const PaperStages& stages, const EncodeSettings& settings,
                    Parameters& parameters, const ProgressCallback& progress,
                    ContainerWriter& field_chunks, EncodeReport& report) {
  if (settings.profile == Profile::paper_global) {
    GlobalModel model = fit_global(stages, parameters.paper, settings.threads, progress);
    parameters.paper = model.settings;
    report.coefficients = model.coefficients.size();
    report.patches = 1;
    write_masks(model.masks, field_chunks);
    field_chunks.add(ChunkType::global, write_global(model.coefficients));
    return std::move(model.masks);
  }
  PaperModel model = fit_patches(stages, parameters.paper, settings.threads, progress);
  parameters.paper = model.settings;
  for (const PatchFit& patch : model.patches) {
    if (patch.coefficients.empty()) continue;
    ++report.patches;
    report.coefficients += patch.coefficients.size();
    if (report.degrees.size() <= patch.degree) report.degrees.resize(patch.degree + 1);
    ++report.degrees[patch.degree];
  }
  write_masks(model.masks, field_chunks);
  field_chunks.add(ChunkType::patches, write_patches(model.patches));
  return std::move(model.masks);
}

Result<Encoded> encode_paper(const Cloud& cloud, const EncodeSettings& settings,
                             const ProgressCallback& progress) {
  Stopwatch watch;
  CURLIDAR_TRY_ASSIGN(prepared, prepare(cloud, settings));
  Encoded out;
  EncodeReport& report = out.report;
  report.stages_ms.push_back({"detect", watch.lap_ms()});
  const PaperSettings& paper = prepared.settings;
  if (settings.profile != Profile::paper_global) {
    CURLIDAR_TRY(check_patches(paper, make_lattice({paper.row_rule, paper.rows, paper.columns,
                                                    paper.min_range_m, paper.max_range},
                                                   prepared.detection.sensor)));
  }

  const PaperStages stages = run_stages(cloud, prepared.detection, prepared.settings,
                                        {.threads = settings.threads}, progress);
  report.stages_ms.insert(report.stages_ms.end(), stages.times.begin(), stages.times.end());
  if (stages.counts.kept == 0) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("no return is left to code: of {} returns {} are outliers, {} out of "
                             "range, {} out of the field of view; check the sensor and the limits",
                             stages.counts.returns, stages.counts.outliers,
                             stages.counts.out_of_range, stages.counts.out_of_fov)};
  }
  watch.lap_ms();
  Parameters parameters{settings.profile, prepared.settings};
  ContainerWriter writer;
  CURLIDAR_TRY_ASSIGN(sensor, write_sensor(prepared.detection.sensor));
  writer.add(ChunkType::sensor, sensor);
  const CellMasks masks = add_field(stages, settings, parameters, progress, writer, report);
  report.stages_ms.push_back({"fit", watch.lap_ms()});

  writer.add(ChunkType::parameters, write_parameters(parameters));
  const std::vector<std::uint32_t> coded = coded_points(stages.image, masks);
  report.points_coded = coded.size();
  CURLIDAR_TRY(add_attributes(cloud, settings.attributes, coded, writer));
  CURLIDAR_TRY(add_metadata(cloud.metadata, writer));
  out.bytes = std::move(writer).finish();
  report.stages_ms.push_back({"write", watch.lap_ms()});

  report.sensor = prepared.detection.sensor.name;
  report.points_in = stages.counts.returns;
  report.projection = stages.counts;
  report.points_upsampled = stages.samples.count();
  report.bytes = out.bytes.size();
  report.bits_per_point =
      8.0 * static_cast<double>(report.bytes) / static_cast<double>(report.points_in);
  report.cp_paper_percent =
      cp_paper(report.coefficients, stages.image.lattice.cells(), stages.counts.kept);
  if (progress) progress("write", 1);
  return out;
}

}  // namespace

Result<Encoded> encode(const Cloud& cloud, const EncodeSettings& settings,
                       const ProgressCallback& progress) {
  return settings.profile == Profile::compact ? encode_compact(cloud, settings, progress)
                                              : encode_paper(cloud, settings, progress);
}

Result<Mesh> polar_mesh(const Cloud& cloud, const EncodeSettings& settings) {
  CURLIDAR_TRY_ASSIGN(prepared, prepare(cloud, settings));
  PaperStages stages = run_stages(cloud, prepared.detection, prepared.settings,
                                  {.always_mesh = true, .threads = settings.threads}, {});
  Mesh mesh;
  mesh.vertices = std::move(stages.mesh.vertices);
  for (std::size_t t = 0; t < stages.mesh.triangles(); ++t) {
    mesh.triangles.push_back(
        {stages.mesh.corner(t, 0), stages.mesh.corner(t, 1), stages.mesh.corner(t, 2)});
  }
  return mesh;
}

Result<Upsampled> upsample_scan(const Cloud& cloud, const EncodeSettings& settings) {
  CURLIDAR_TRY_ASSIGN(prepared, prepare(cloud, settings));
  PaperStages stages =
      run_stages(cloud, prepared.detection, prepared.settings, {.threads = settings.threads}, {});
  const SampleImage& samples = stages.samples;
  Upsampled out;
  out.rows = samples.rows;
  out.columns = samples.columns;
  out.mask_rows = stages.masks.rows;
  out.mask_columns = stages.masks.columns;
  out.projection = stages.counts;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const DenseGrid grid(stages.image.lattice, samples.row_factor, samples.column_factor);
  for (std::size_t row = 0; row < samples.rows; ++row) {
    for (std::size_t column = 0; column < samples.columns; ++column) {
      const double range = samples.range[samples.index(row, column)];
      out.cloud.positions.push_back(
          stages.image.lattice.direction(grid.row(row), grid.column(column)) *
          (range > 0 ? range : kNan));
    }
  }
  out.cloud.width = samples.columns;
  out.cloud.height = samples.rows;
  out.cloud.metadata = cloud.metadata;
  out.point_grid = std::move(stages.masks.point);
  out.cliff_row = std::move(stages.masks.cliff_row);
  out.cliff_column = std::move(stages.masks.cliff_column);
  out.cliff_diagonal = std::move(stages.masks.cliff_diagonal);
  return out;
}

}  // namespace curlidar
