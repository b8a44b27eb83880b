// SPDX-License-Identifier: BSD-3-Clause
#include "codec/record_encode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/float32.hpp"
#include "base/stopwatch.hpp"
#include "base/try.hpp"
#include "codec/chosen_attributes.hpp"
#include "codec/compact_decode.hpp"
#include "codec/compact_report.hpp"
#include "codec/record_file.hpp"
#include "codec/record_image.hpp"
#include "codec/record_layout.hpp"
#include "codec/record_loose.hpp"
#include "codec/verify_slots.hpp"
#include "compact/scan_header.hpp"
#include "image/range_image.hpp"
#include "records/attributes.hpp"
#include "records/corrections.hpp"

namespace curlidar {
namespace {

/// Bytes of a chunk, if it is written.
std::size_t framed(const std::vector<std::byte>& payload) {
  return payload.empty() ? 0 : compact::frame_size(payload.size()) + payload.size();
}

/// A scan on its way into a file.
struct RecordEncoding {
  Cloud cloud;  ///< as the file is to give it back
  RecordLayout layout;
  std::optional<RecordImage> image;
  std::vector<std::byte> loose, corrections, order, attributes;
  std::size_t corrected = 0;

  /// Bytes of the geometry without frames.
  std::size_t geometry_bytes() const {
    std::size_t bytes = loose.size() + corrections.size() + order.size();
    if (!image) return bytes;
    for (const auto& chunk : image->trial.encoded.chunks) bytes += chunk.payload.size();
    return bytes + image->trial.directions.size();
  }
};

RecordPromise promise_of(const CompactSettings& settings) {
  RecordPromise promise;
  promise.bit_exact = settings.target == CompactTarget::lossless;
  if (settings.target == CompactTarget::max_error) promise.bound_m = settings.target_value;
  promise.any_order = !settings.keep_order;
  return promise;
}

/// The slots behind the records: cells in raster order, then loose points.
std::vector<std::uint32_t> slots_of_records(const RecordLayout& layout) {
  std::vector<std::uint32_t> slots;
  for (const std::uint32_t source : layout.scan.source) {
    if (source != kNoPoint) slots.push_back(source);
  }
  slots.insert(slots.end(), layout.loose.begin(), layout.loose.end());
  return slots;
}

std::vector<Vec3> positions_at(const Cloud& cloud, const std::vector<std::uint32_t>& slots) {
  std::vector<Vec3> positions;
  positions.reserve(slots.size());
  for (const std::uint32_t slot : slots) positions.push_back(cloud.positions[slot]);
  return positions;
}

/// The order of the cloud's slots in terms of the layout's records.
CloudOrder record_order(const Cloud& cloud, const std::vector<std::uint32_t>& slots) {
  CloudOrder order = order_of(cloud);
  std::vector<std::uint32_t> record_of_slot(cloud.size(), 0);
  for (std::uint32_t record = 0; record < slots.size(); ++record) {
    record_of_slot[slots[record]] = record;
  }
  order.record.clear();
  for (std::size_t slot = 0; slot < cloud.size(); ++slot) {
    if (order.kind[slot] == SlotKind::point) order.record.push_back(record_of_slot[slot]);
  }
  return order;
}

/// The image as a decoder has it; without rows if the layout has none.
struct ImageView {
  compact::RowTable table;
  compact::Image image;
};

ImageView view_of(const RecordEncoding& encoding) {
  if (!encoding.image) return {};
  return {encoding.image->model.table, encoding.image->trial.encoded.decoded};
}

/// Corrections that bring the points within the promise.
Status add_corrections(const Cloud& cloud, const std::vector<std::uint32_t>& slots,
                       const CompactSettings& settings, const std::vector<Vec3>& loose,
                       RecordEncoding& encoding) {
  const RecordPromise promise = promise_of(settings);
  if (!encoding.image || !promise.of_points()) return {};
  std::vector<Vec3> predicted =
      points_of(encoding.image->model, encoding.image->trial.encoded.decoded);
  predicted.insert(predicted.end(), loose.begin(), loose.end());
  round_to(cloud.position_type, predicted);
  CURLIDAR_TRY_ASSIGN(coded, encode_corrections(predicted, positions_at(cloud, slots),
                                                cloud.position_type, {promise.bound_m}));
  if (coded.corrected > 0) encoding.corrections = std::move(coded.bytes);
  encoding.corrected = coded.corrected;
  return {};
}

/// Gives up the order of a cloud: its slots become those of the layout's records.
void reorder(Cloud& cloud, RecordLayout& layout) {
  if (layout.scan.counts.kept == 0) {
    const std::vector<std::uint32_t> slots = layout.loose;
    const std::vector<std::uint32_t> nearby = morton_order(positions_at(cloud, slots));
    for (std::size_t i = 0; i < nearby.size(); ++i) layout.loose[i] = slots[nearby[i]];
  }
  const ScalarType type = cloud.position_type;
  cloud = select(cloud, slots_of_records(layout));
  cloud.position_type = type;
  std::uint32_t record = 0;
  for (std::uint32_t& source : layout.scan.source) {
    if (source != kNoPoint) source = record++;
  }
  for (std::uint32_t& slot : layout.loose) slot = record++;
}

/// Geometry and order of a cloud laid out.
Result<RecordEncoding> encode_layout(Cloud given, RecordLayout layout,
                                     const EncodeSettings& settings,
                                     const ProgressCallback& progress,
                                     const PredictionSource* source) {
  const std::size_t container_bytes = kHeaderSize + compact::frame_size(0);
  RecordEncoding out;
  out.cloud = std::move(given);
  out.layout = std::move(layout);
  const Cloud& cloud = out.cloud;
  const bool has_image = out.layout.scan.counts.kept > 0;
  if (!settings.compact.keep_order) reorder(out.cloud, out.layout);
  const std::vector<std::uint32_t> slots = slots_of_records(out.layout);
  std::vector<std::uint8_t> occupied;
  for (const std::uint32_t slot : out.layout.scan.source) {
    occupied.push_back(slot != kNoPoint ? 1 : 0);
  }
  const CellGrid grid{out.layout.scan.rows, out.layout.scan.columns, occupied,
                      out.layout.loose.size()};
  out.order = encode_order(record_order(cloud, slots), grid);

  std::vector<Vec3> loose = positions_at(cloud, out.layout.loose);
  const double beside_bits = 8.0 * static_cast<double>(framed(out.order));
  if (!loose.empty()) {
    const double error_m = first_error_guess(settings.compact);
    Result<CodedPoints> coded =
        has_image ? encode_leftovers(loose, cloud.position_type, settings.compact, error_m)
                  : encode_all_loose(loose, cloud.position_type, settings.compact,
                                     beside_bits + 8.0 * static_cast<double>(container_bytes),
                                     settings.threads);
    if (!coded) return coded.error();
    out.loose = std::move(coded->bytes);
    loose = std::move(coded->decoded);
  }
  if (has_image) {
    Result<RecordImage> image = encode_record_image(
        cloud, out.layout, loose, settings,
        beside_bits + 8.0 * static_cast<double>(framed(out.loose)), progress, source);
    if (!image) return image.error();
    out.image.emplace(*std::move(image));
  }
  CURLIDAR_TRY(add_corrections(cloud, slots, settings.compact, loose, out));
  return out;
}

/// The cloud's type of coordinates, or float64 if it cannot hold them: clouds made by hand may say
/// float32 and hold doubles.
ScalarType exact_type(const Cloud& cloud) {
  constexpr double kMost = std::numeric_limits<float>::max();
  const auto single = [](double x) {
    return !std::isfinite(x) || (std::abs(x) <= kMost && round_to_float32(x) == x);
  };
  const bool fits = std::all_of(cloud.positions.begin(), cloud.positions.end(), [&](const Vec3& p) {
    return single(p.x) && single(p.y) && single(p.z);
  });
  return cloud.position_type == ScalarType::float32 && fits ? ScalarType::float32
                                                            : ScalarType::float64;
}

/// Whether the cloud is one: what io reads always is.
Status check_cloud(const Cloud& cloud) {
  const auto invalid = [](const std::string& what) {
    return Error{ErrorCode::invalid_argument, what};
  };
  if (cloud.size() >= kNoPoint) return invalid("a cloud has less than 2^32 - 1 points");
  if (cloud.organised() && std::uint64_t{cloud.width} * cloud.height != cloud.size()) {
    return invalid(
        fmt::format("a cloud of {} x {} with {} points", cloud.width, cloud.height, cloud.size()));
  }
  return {};
}

/// The cloud without the attributes that are not kept.
Result<Cloud> kept_cloud(const Cloud& cloud, const EncodeSettings& settings) {
  CURLIDAR_TRY(check_cloud(cloud));
  Cloud kept;
  kept.positions = cloud.positions;
  kept.position_type = exact_type(cloud);
  kept.width = cloud.width;
  kept.height = cloud.height;
  CURLIDAR_TRY_ASSIGN(attributes, choose_attributes(cloud, settings.attributes));
  kept.attributes = std::move(attributes);
  return kept;
}

/// Tries what may be smaller than the layout's image for clouds without a lattice of rays, and what
/// may reach a target that the image does not.
Result<RecordEncoding> encode_best(const Cloud& cloud, const EncodeSettings& settings,
                                   const ProgressCallback& progress,
                                   const PredictionSource* source) {
  CURLIDAR_TRY_ASSIGN(layout, lay_out(cloud, settings));
  const bool certain = layout.lattice || layout.scan.cell_centres || layout.scan.rows == 0;
  const bool has_image = layout.scan.counts.kept > 0;
  if (source != nullptr && !has_image) {
    return Error{ErrorCode::unsupported, "a scan without an image cannot be predicted"};
  }
  Result<RecordEncoding> laid_out =
      encode_layout(cloud, std::move(layout), settings, progress, source);
  if (source != nullptr) return laid_out;
  if (!laid_out && laid_out.error().code == ErrorCode::invalid_argument && has_image) {
    Result<RecordEncoding> loose =
        encode_layout(cloud, lay_out_loose(cloud), settings, {}, nullptr);
    if (!loose) return laid_out;
    loose->layout.notes.push_back(
        "The target is out of the reach of ranges on a lattice: the points are coded one after "
        "the other, without a field.");
    return loose;
  }
  CURLIDAR_TRY_ASSIGN(best, std::move(laid_out));
  // Bits compare where both keep to an error; a step means another error for points alone.
  const CompactTarget target = settings.compact.target;
  const bool comparable = target != CompactTarget::bits_per_point && target != CompactTarget::step;
  if (certain || !comparable) return best;
  Result<RecordEncoding> loose = encode_layout(cloud, lay_out_loose(cloud), settings, {}, nullptr);
  if (!loose || loose->geometry_bytes() >= best.geometry_bytes()) return best;
  loose->layout.notes.push_back("The points take less one after the other than on their rings.");
  return loose;
}

RecordReport record_report(const RecordEncoding& encoding, const CompactSettings& settings) {
  RecordReport report;
  report.loose = encoding.layout.loose.size();
  report.corrected = encoding.corrected;
  report.promise = promise_of(settings);
  report.notes = encoding.layout.notes;
  report.bytes = {0,
                  0,
                  framed(encoding.loose),
                  framed(encoding.corrections),
                  framed(encoding.order),
                  framed(encoding.attributes)};
  if (!encoding.image) return report;
  report.lattice = encoding.layout.lattice ? RecordLattice::rays : RecordLattice::rings;
  report.bytes.directions = framed(encoding.image->trial.directions);
  for (const auto& chunk : encoding.image->trial.encoded.chunks) {
    if (chunk.part == compact::ScanPart::rays) report.bytes.rays = framed(chunk.payload);
  }
  if (const auto& fit = encoding.layout.lattice) {
    report.table = fit->beams.table;
    report.motion = !fit->motion.none();
    report.share_on_lattice = fit->share;
    report.across_m = fit->residuals.across_median_m;
    report.up_m = fit->residuals.up_median_m;
    report.range_m = fit->residuals.range_median_m;
    report.firings = static_cast<std::uint32_t>(fit->firings.size());
    report.slots = fit->beams.slots;
    report.range_unit_m = fit->beams.range_unit_m;
  }
  return report;
}

std::vector<std::byte> write_file(const RecordEncoding& encoding, const CompactSettings& settings,
                                  const std::vector<std::byte>& metadata) {
  ContainerWriter writer;
  const auto add = [&](ChunkType type, const std::vector<std::byte>& payload) {
    if (!payload.empty()) writer.add(type, payload);
  };
  if (encoding.image) {
    for (const auto& chunk : encoding.image->trial.encoded.chunks) {
      writer.add(static_cast<ChunkType>(chunk.part), chunk.payload);
    }
    add(ChunkType::directions, encoding.image->trial.directions);
  }
  add(ChunkType::loose, encoding.loose);
  writer.add(ChunkType::order, encoding.order);
  add(ChunkType::corrections, encoding.corrections);
  add(ChunkType::records, encoding.attributes);
  const RecordPromise promise = promise_of(settings);
  if (promise != RecordPromise{}) writer.add(ChunkType::promise, write_promise(promise));
  add(ChunkType::metadata, metadata);
  return std::move(writer).finish();
}

}  // namespace

const char* to_string(RecordLattice lattice) {
  switch (lattice) {
    case RecordLattice::none:
      return "none";
    case RecordLattice::rings:
      return "rings";
    case RecordLattice::rays:
      return "rays";
  }
  return "none";
}

Result<Encoded> encode_records(const Cloud& given, const EncodeSettings& settings,
                               const ProgressCallback& progress, const PredictionSource* source) {
  Stopwatch watch;
  Encoded out;
  EncodeReport& report = out.report;
  CURLIDAR_TRY_ASSIGN(kept, kept_cloud(given, settings));
  CURLIDAR_TRY_ASSIGN(encoding, encode_best(kept, settings, progress, source));
  const Cloud& cloud = encoding.cloud;
  report.stages_ms.push_back({"geometry", watch.lap_ms()});

  if (!cloud.attributes.empty()) {
    const ImageView view = view_of(encoding);
    const RecordCells cells(view.table, view.image);
    CURLIDAR_TRY_ASSIGN(
        payload,
        write_records(cloud.attributes, record_order(cloud, slots_of_records(encoding.layout)),
                      cells.geometry(encoding.layout.loose.size())));
    encoding.attributes = std::move(payload);
  }
  report.stages_ms.push_back({"attributes", watch.lap_ms()});

  std::map<std::string, std::string> named = given.metadata;
  const GriddedScan& scan = encoding.layout.scan;
  if (!named.empty() && !scan.cell_centres && !scan.sensor.empty()) {
    named.emplace(kSensorKey, scan.sensor);
  }
  CURLIDAR_TRY_ASSIGN(metadata, metadata_payload(named));
  out.bytes = write_file(encoding, settings.compact, metadata);
  CURLIDAR_TRY_ASSIGN(proof, verify_slots(out.bytes, cloud, settings.threads,
                                          source != nullptr ? source->reference : nullptr));
  if (!proof.ok) {
    return Error{ErrorCode::corrupt,
                 fmt::format("the file does not give back what it promises ({}), which is a "
                             "defect of this program: please report it with the scan",
                             proof.failures.empty() ? "unknown" : proof.failures.front())};
  }
  report.stages_ms.push_back({"verify", watch.lap_ms()});

  report.records = record_report(encoding, settings.compact);
  const OwnErrors errors{proof.mean_error_m, proof.rms_error_m, proof.max_error_m};
  report.compact = encoding.image ? report_of(encoding.image->trial, encoding.layout.scan,
                                              encoding.image->model, errors)
                                  : CompactReport{};
  report.compact->mean_error_m = errors.mean;
  report.compact->rms_error_m = errors.rms;
  report.compact->max_error_m = errors.max;
  if (encoding.image && settings.compact.target == CompactTarget::error_nn) {
    report.compact->error_nn_m = encoding.image->trial.error_nn_m;
  }
  report.sensor = encoding.layout.scan.sensor.empty() ? "none" : encoding.layout.scan.sensor;
  report.points_in = report.points_coded = count_returns(cloud);
  report.projection.returns = report.projection.kept = report.points_in;
  report.bytes = out.bytes.size();
  const auto returns = static_cast<double>(std::max<std::size_t>(report.points_in, 1));
  report.bits_per_point = 8.0 * static_cast<double>(report.bytes) / returns;
  const std::size_t beside = framed(encoding.attributes) + framed(metadata);
  CompactBreakdown& parts = report.compact->breakdown;
  parts.records = 8.0 * static_cast<double>(report.bytes - beside) - parts.total();
  report.compact->bits_per_point_coded = 8.0 * static_cast<double>(report.bytes - beside) / returns;
  if (progress) progress("write", 1);
  return out;
}

}  // namespace curlidar
