// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_encode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/stopwatch.hpp"
#include "base/try.hpp"
#include "codec/chosen_attributes.hpp"
#include "codec/compact_decode.hpp"
#include "codec/compact_offsets.hpp"
#include "codec/compact_report.hpp"
#include "codec/compact_search.hpp"
#include "codec/compact_tuning.hpp"
#include "codec/record_encode.hpp"
#include "image/range_image.hpp"

namespace curlidar {
namespace {

/// The points behind the occupied cells, in raster order.
std::vector<std::uint32_t> coded_points(const GriddedScan& scan) {
  std::vector<std::uint32_t> coded;
  coded.reserve(scan.counts.kept);
  for (const std::uint32_t source : scan.source) {
    if (source != kNoPoint) coded.push_back(source);
  }
  return coded;
}

/// Decodes the file and measures it: what a report says is what a reader gets.
Result<OwnErrors> measure_file(const std::vector<std::byte>& bytes, const Cloud& cloud,
                               const GriddedScan& scan, const compact::Image& expected,
                               const PredictionSource* source, std::size_t threads) {
  DecodeOptions options;
  if (source != nullptr) options.reference = source->reference;
  options.threads = threads;
  options.limits = {UINT64_MAX, UINT64_MAX};
  CURLIDAR_TRY_ASSIGN(back, decode_compact_image(bytes, options));
  if (back.image.range != expected.range) {
    return Error{ErrorCode::corrupt,
                 "the file decodes to something else than was encoded, which is a defect of this "
                 "program: please report it with the scan"};
  }
  CompactModel as_read;
  as_read.table = std::move(back.table);
  return own_errors(cloud, scan, points_of(as_read, back.image));
}

/// The metadata of a file with any name the sensor, too: rows alone do not tell.
std::map<std::string, std::string> metadata_of(const Cloud& cloud, const GriddedScan& scan) {
  std::map<std::string, std::string> metadata = cloud.metadata;
  if (!metadata.empty() && !scan.cell_centres) metadata.emplace(kSensorKey, scan.sensor);
  return metadata;
}

/// Codes the depth image that the settings ask for: returns that it has no cell for are dropped.
Result<Encoded> encode_image(const Cloud& cloud, const EncodeSettings& settings,
                             const ProgressCallback& progress, const PredictionSource* source) {
  Stopwatch watch;
  Encoded out;
  EncodeReport& report = out.report;
  CURLIDAR_TRY_ASSIGN(scan, grid_scan(cloud, settings));
  const double error_m = first_error_guess(settings.compact);
  const RowModel rows = fit_rows(cloud, scan, error_m);
  CompactModel model = make_model(scan, rows, error_m);
  report.stages_ms.push_back({"grid", watch.lap_ms()});

  CompactJob job{cloud, scan, model, settings.compact, settings.threads, progress};
  std::optional<PredictedModel> predicted;
  if (source != nullptr) predicted = predict_model(*source, model);
  if (predicted) job.predicted = &*predicted;
  if (!predicted || !predicted->header.same_rows) {
    CURLIDAR_TRY(choose_range_offsets(job, estimate_range_offsets(scan, rows), error_m, model));
  }
  report.stages_ms.push_back({"offsets", watch.lap_ms()});
  CURLIDAR_TRY(choose_kind(job));
  CURLIDAR_TRY_ASSIGN(trial, search_target(job));
  report.stages_ms.push_back({"search", watch.lap_ms()});

  ContainerWriter writer;
  for (const compact::ScanChunk& chunk : trial.encoded.chunks) {
    writer.add(static_cast<ChunkType>(chunk.part), chunk.payload);
  }
  CURLIDAR_TRY(add_attributes(cloud, settings.attributes, coded_points(scan), writer));
  CURLIDAR_TRY(add_metadata(metadata_of(cloud, scan), writer));
  out.bytes = std::move(writer).finish();
  report.stages_ms.push_back({"write", watch.lap_ms()});

  CURLIDAR_TRY_ASSIGN(errors, measure_file(out.bytes, cloud, scan, trial.encoded.decoded, source,
                                           settings.threads));
  report.compact = report_of(trial, scan, model, errors);
  if (settings.compact.target == CompactTarget::error_nn) {
    report.compact->error_nn_m = trial.error_nn_m;
  }
  report.stages_ms.push_back({"measure", watch.lap_ms()});
  report.sensor = scan.sensor;
  report.points_in = scan.counts.returns;
  report.points_coded = scan.counts.kept;
  report.projection = scan.counts;
  report.bytes = out.bytes.size();
  report.bits_per_point =
      8.0 * static_cast<double>(report.bytes) / static_cast<double>(report.points_in);
  if (progress) progress("write", 1);
  return out;
}

}  // namespace

Result<Encoded> encode_compact(const Cloud& cloud, const EncodeSettings& settings,
                               const ProgressCallback& progress, const PredictionSource* source) {
  CURLIDAR_TRY(validate(settings.compact));
  return keeps_every_return(settings.compact) ? encode_records(cloud, settings, progress, source)
                                              : encode_image(cloud, settings, progress, source);
}

}  // namespace curlidar
