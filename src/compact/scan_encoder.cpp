// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "compact/prediction_chunk.hpp"
#include "compact/ray_chunk.hpp"
#include "compact/scan_header.hpp"
#include "compact/scan_segment.hpp"

namespace curlidar::compact {
namespace {

Status check_image(const Image& image) {
  if (image.range.size() != image.cells()) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{} ranges for an image of {} x {} cells", image.range.size(),
                             image.rows, image.columns)};
  }
  for (std::size_t cell = 0; cell < image.range.size(); ++cell) {
    if (image.range[cell] < 0 || image.range[cell] > kMaxRange) {
      return Error{
          ErrorCode::invalid_argument,
          fmt::format("the range in row {}, column {} is {} / 65536 m; 0 (empty) to 2048 m "
                      "are possible",
                      cell / image.columns, cell % image.columns, image.range[cell])};
    }
  }
  return {};
}

std::uint64_t count_returns(const Image& image) {
  std::uint64_t returns = 0;
  for (const std::int32_t range : image.range) returns += range != 0;
  return returns;
}

/// A further segment costs some 100 bytes (contexts learn anew, surfaces lose their left
/// neighbours): one for every 9 kB expected, which are 6 in the end, stays within 2 %.
std::uint32_t default_sectors(const Image& image, const ScanParameters& p) {
  const std::int32_t finest = p.residual_step > 0 ? std::min(p.step, p.residual_step) : p.step;
  // Bits a return: one more for each halving of the step, roughly; 3 at 5 cm.
  const int width = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(finest)));
  const int bits = std::max(15 - width, 1);
  const std::uint64_t bytes = count_returns(image) * static_cast<std::uint64_t>(bits) / 8;
  constexpr std::uint64_t kBytesPerSegment = 9000;
  const std::uint64_t most = std::clamp(image.columns / 128, 1u, 16u);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(1 + bytes / kBytesPerSegment, most));
}

ScanParameters parameters_for(const Image& image, const ScanSettings& settings) {
  ScanParameters p;
  p.rows = image.rows;
  p.columns = image.columns;
  p.step = settings.steps.step;
  p.lattice_q32 = settings.steps.lattice_q32;
  p.residual_step = p.lattice_q32 != 0
                        ? static_cast<std::int32_t>(std::min(p.lattice_q32, kMostLattice) >> 16)
                        : settings.steps.residual_step;
  p.root_log2 = settings.steps.root_log2;
  p.smallest_leaf = settings.steps.smallest_leaf;
  p.bands = std::max(settings.bands, 1u);
  p.sectors = settings.sectors;
  if (p.sectors == 0) p.sectors = settings.index ? default_sectors(image, p) : 1;
  return p;
}

void count_nodes(const Node& node, const std::vector<std::uint8_t>& occupied, std::uint32_t columns,
                 EncodeStatistics& statistics) {
  if (node.split != Split::none) {
    for (const Node& child : node.children) count_nodes(child, occupied, columns, statistics);
    return;
  }
  const Block& b = node.block;
  bool any = false;
  for (std::uint32_t i = 0; i < b.height && !any; ++i) {
    const auto* row = occupied.data() + std::size_t{b.row + i} * columns + b.column;
    any = std::any_of(row, row + b.width, [](std::uint8_t cell) { return cell != 0; });
  }
  if (!any) return;
  ++statistics.leaves;
  ++statistics.leaves_by_size[static_cast<std::size_t>(std::bit_width(b.cells())) - 1];
  ++statistics.leaves_by_layers[node.leaf.layers - 1];
  for (std::uint32_t k = 0; k < node.leaf.layers; ++k) {
    ++statistics.layers_by_functions[node.leaf.layer[k].functions];
    statistics.inherited_layers += node.leaf.layer[k].parent > 0;
  }
}

void put_into(Image& image, const SegmentPlace& place, const std::vector<std::int32_t>& ranges) {
  for (std::uint32_t i = 0; i < place.rows; ++i) {
    std::copy_n(
        ranges.begin() + static_cast<std::ptrdiff_t>(std::size_t{i} * place.columns), place.columns,
        image.range.begin() +
            static_cast<std::ptrdiff_t>(std::size_t{place.row + i} * image.columns + place.column));
  }
}

/// Adds what a segment says of itself.
void count_segment(const EncodedSegment& segment, const SegmentPlace& place, EncodedScan& out) {
  Breakdown& b = out.breakdown;
  b.mask += 8 * static_cast<double>(segment.mask.size());
  b.residual += 8 * static_cast<double>(segment.residual.size());
  const std::array<double*, kFieldParts> parts = {&b.partition, &b.modes, &b.coefficients,
                                                  &b.labels};
  b.header += 8 * static_cast<double>(segment.field.size());
  for (std::size_t part = 0; part < kFieldParts; ++part) {
    const double bits = static_cast<double>(segment.part_cost[part]) / 256;
    *parts[part] += bits;
    b.header -= bits;
  }
  for (const Node& node : segment.decoded.nodes) {
    count_nodes(node, segment.decoded.occupied, place.columns, out.statistics);
  }
  for (const DecodedLeaf& leaf : segment.decoded.leaves) {
    out.statistics.leaves_with_residual += leaf.has_residual;
  }
}

/// Masks, fields, residuals; behind an index of them if wanted.
void add_segment_chunks(std::vector<EncodedSegment>& segments, bool residual, bool index,
                        std::vector<ScanChunk>& chunks) {
  std::vector<ScanChunk> coded;
  for (EncodedSegment& s : segments) coded.push_back({ScanPart::mask, std::move(s.mask)});
  for (EncodedSegment& s : segments) coded.push_back({ScanPart::field, std::move(s.field)});
  if (residual) {
    for (EncodedSegment& s : segments) coded.push_back({ScanPart::residual, std::move(s.residual)});
  }
  if (index) {
    std::vector<std::uint64_t> sizes;
    for (const ScanChunk& chunk : coded) sizes.push_back(chunk.payload.size());
    chunks.push_back({ScanPart::index, write_index(sizes)});
  }
  for (ScanChunk& chunk : coded) chunks.push_back(std::move(chunk));
}

/// Counts the small chunks and the frames of all.
void count_frames(EncodedScan& out) {
  for (const ScanChunk& chunk : out.chunks) {
    const bool small = chunk.part < ScanPart::mask || chunk.part > ScanPart::residual;
    out.breakdown.header += 8 * static_cast<double>(frame_size(chunk.payload.size()) +
                                                    (small ? chunk.payload.size() : 0));
  }
}

}  // namespace

Result<EncodedScan> encode_scan(const Image& image, const RowTable& table,
                                const ScanSettings& settings) {
  CURLIDAR_TRY(check_image(image));
  const ScanParameters parameters = parameters_for(image, settings);
  CURLIDAR_TRY(check_header(parameters, table));
  // On a lattice of ranges the caller knows them to lie on it.
  if (settings.max_error > 0 && parameters.lattice_q32 == 0 &&
      (parameters.residual_step == 0 || parameters.residual_step / 2 > settings.max_error)) {
    return Error{ErrorCode::invalid_argument,
                 "a largest error needs residuals in steps of at most twice it"};
  }
  Effort effort = search_settings(settings.effort, parameters.step, parameters.residual_step,
                                  settings.lambda_per_mille);
  effort.max_error = settings.max_error;
  const std::vector<SegmentPlace> places = segments_of(parameters);
  std::vector<EncodedSegment> segments(places.size());
  parallel_for(places.size(), settings.threads, [&](std::size_t i) {
    segments[i] = encode_segment(image, table, parameters, places[i], effort, settings.prediction);
  });

  EncodedScan out;
  out.decoded = {image.rows, image.columns, std::vector<std::int32_t>(image.cells(), 0)};
  out.statistics.returns = count_returns(image);
  for (std::size_t i = 0; i < places.size(); ++i) {
    put_into(out.decoded, places[i], segments[i].decoded.range);
    count_segment(segments[i], places[i], out);
  }
  out.chunks.push_back({ScanPart::parameters, write_parameters(parameters, table)});
  if (settings.prediction != nullptr) {
    out.chunks.push_back({ScanPart::prediction, write_prediction(*settings.header)});
  }
  const bool shared = settings.prediction != nullptr && settings.header->same_rows;
  if (!shared) out.chunks.push_back({ScanPart::sensor, write_rows(table)});
  if (table.rays && !(shared && settings.header->same_firings)) {
    out.chunks.push_back({ScanPart::rays, shared ? write_firings_only(table) : write_rays(table)});
  }
  add_segment_chunks(segments, parameters.residual_step > 0, settings.index && places.size() > 1,
                     out.chunks);
  count_frames(out);
  return out;
}

}  // namespace curlidar::compact
