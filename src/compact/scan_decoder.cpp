// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "compact/prediction.hpp"
#include "compact/prediction_chunk.hpp"
#include "compact/ray_chunk.hpp"
#include "compact/scan_header.hpp"
#include "compact/scan_segment.hpp"

namespace curlidar::compact {
namespace {

constexpr std::array<ScanPart, 3> kSegmentParts = {ScanPart::mask, ScanPart::field,
                                                   ScanPart::residual};

const ScanChunkView* find(const ScanChunks& chunks, ScanPart part) {
  for (const ScanChunkView& chunk : chunks.chunks) {
    if (chunk.part == part) return &chunk;
  }
  return nullptr;
}

Result<ScanChunkView> require(const ScanChunks& chunks, ScanPart part) {
  const ScanChunkView* chunk = find(chunks, part);
  if (chunk == nullptr || !chunk->whole) {
    return Error{ErrorCode::corrupt,
                 fmt::format("the .curl file has no {}{} chunk, without which nothing of its scan "
                             "can be decoded",
                             chunk == nullptr ? "" : "whole ", to_string(part))};
  }
  return *chunk;
}

std::size_t parts_of(const ScanParameters& parameters) {
  return parameters.residual_step > 0 ? 3 : 2;
}

/// The chunks of every segment: views[part][segment].
using SegmentViews = std::array<std::vector<ScanChunkView>, 3>;

Result<SegmentViews> segment_views(const ScanChunks& chunks, const ScanParameters& parameters,
                                   std::size_t segments) {
  SegmentViews views;
  for (const ScanChunkView& chunk : chunks.chunks) {
    const auto found = std::find(kSegmentParts.begin(), kSegmentParts.end(), chunk.part);
    if (found == kSegmentParts.end()) continue;
    const auto part = static_cast<std::size_t>(found - kSegmentParts.begin());
    if (part >= parts_of(parameters) || views[part].size() == segments) {
      return scan_error(ErrorCode::corrupt, chunk.part, chunk.offset,
                        "one more than the scan has segments");
    }
    views[part].push_back(chunk);
  }
  for (std::size_t part = 0; chunks.complete && part < parts_of(parameters); ++part) {
    if (views[part].size() < segments) {
      return Error{ErrorCode::corrupt,
                   fmt::format("the .curl file has {} {} chunks for {} segments",
                               views[part].size(), to_string(kSegmentParts[part]), segments)};
    }
  }
  return views;
}

/// Even the surest bit takes more than 1/2048 bit (kMinProbability), so a mask of few bytes cannot
/// hold many cells: refused here, before memory is taken for them.
Status check_mask_sizes(const std::vector<DecodedSegment>& segments,
                        const std::vector<ScanChunkView>& masks) {
  constexpr std::uint64_t cells_per_byte = 8 * 2048;
  for (std::size_t i = 0; i < std::min(segments.size(), masks.size()); ++i) {
    if (!segments[i].wanted || !masks[i].whole) continue;
    const std::uint64_t cells = segments[i].place.cells();
    if (cells <= (masks[i].payload.size() + 8) * cells_per_byte) continue;
    return scan_error(
        ErrorCode::corrupt, ScanPart::mask, masks[i].offset,
        fmt::format("{} bytes are too few for {} cells", masks[i].payload.size(), cells));
  }
  return {};
}

SegmentChunk chunk_of(const std::vector<ScanChunkView>& views, std::size_t segment) {
  if (segment >= views.size()) return {};
  return {true, views[segment].whole, views[segment].payload};
}

bool touches(const Region& region, const SegmentPlace& place) {
  return place.row < region.row_end && region.row_begin < place.row + place.rows &&
         place.column < region.column_end && region.column_begin < place.column + place.columns;
}

/// What is known of a part of a segment, of how much.
std::pair<std::uint64_t, std::uint64_t> progress(const SegmentScan& scan, const SegmentPlace& place,
                                                 ScanPart part) {
  switch (part) {
    case ScanPart::mask:
      return {scan.mask_rows, place.rows};
    case ScanPart::field:
      return {scan.roots, scan.total_roots};
    default:
      return {scan.residual_rows, place.rows};
  }
}

/// Notes what is missing of a segment; corrupt if a whole chunk did not hold what it should.
Status check_progress(const SegmentScan& scan, const SegmentPlace& place, std::uint32_t segment,
                      const SegmentViews& views, std::size_t parts, std::vector<Missing>& missing) {
  bool before = true;
  for (std::size_t k = 0; k < parts; ++k) {
    const ScanPart part = kSegmentParts[k];
    const auto [known, total] = progress(scan, place, part);
    if (known == total) continue;
    const bool whole = segment < views[k].size() && views[k][segment].whole;
    if (whole && before) {
      return scan_error(ErrorCode::corrupt, part, views[k][segment].offset,
                        fmt::format("the payload ends after {} of {} {}", known, total,
                                    part == ScanPart::field ? "roots" : "rows"));
    }
    before = false;
    missing.push_back({part, segment, place, known, total});
  }
  return {};
}

/// Copies a plane of a segment to its place in the image.
template <class T>
void put_plane(const std::vector<T>& from, const SegmentPlace& place, std::uint32_t columns,
               const T& add, const T& none, std::vector<T>& to) {
  for (std::uint32_t i = 0; i < place.rows; ++i) {
    const std::size_t at = std::size_t{place.row + i} * columns + place.column;
    for (std::uint32_t j = 0; j < place.columns; ++j) {
      const T value = from[std::size_t{i} * place.columns + j];
      to[at + j] = value == none ? none : static_cast<T>(value + add);
    }
  }
}

void put_segment(SegmentScan& scan, DecodedSegment& segment, DecodedScan& out) {
  const SegmentPlace& place = segment.place;
  const std::uint32_t columns = out.parameters.columns;
  segment.mask_rows = static_cast<std::uint32_t>(scan.mask_rows);
  segment.roots = scan.roots;
  segment.residual_rows = static_cast<std::uint32_t>(scan.residual_rows);
  segment.first_surface = static_cast<std::uint32_t>(out.surfaces.size());
  segment.surfaces = static_cast<std::uint32_t>(scan.surfaces.size());
  segment.first_leaf = static_cast<std::uint32_t>(out.leaves.size());
  segment.leaves = static_cast<std::uint32_t>(scan.leaves.size());
  segment.nodes = std::move(scan.nodes);
  put_plane(scan.occupied, place, columns, std::uint8_t{0}, std::uint8_t{0}, out.occupied);
  put_plane(scan.range, place, columns, 0, 0, out.range);
  put_plane(scan.field_range, place, columns, 0, 0, out.field_range);
  put_plane(scan.surface, place, columns, static_cast<std::int32_t>(segment.first_surface),
            kNoSurface, out.surface);
  put_plane(scan.leaf, place, columns, static_cast<std::int32_t>(segment.first_leaf), -1, out.leaf);
  if (out.surfaces.empty()) {
    out.surfaces = std::move(scan.surfaces);
  } else {
    out.surfaces.insert(out.surfaces.end(), scan.surfaces.begin(), scan.surfaces.end());
  }
  for (DecodedLeaf leaf : scan.leaves) {
    leaf.first_surface += segment.first_surface;
    out.leaves.push_back(leaf);
  }
}

/// Empties the cells outside the region.
void crop(const Region& region, DecodedScan& out) {
  const std::uint32_t columns = out.parameters.columns;
  for (std::uint32_t row = 0; row < out.parameters.rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      if (row >= region.row_begin && row < region.row_end && column >= region.column_begin &&
          column < region.column_end) {
        continue;
      }
      const std::size_t cell = std::size_t{row} * columns + column;
      out.occupied[cell] = 0;
      out.range[cell] = out.field_range[cell] = 0;
      out.surface[cell] = kNoSurface;
      out.leaf[cell] = -1;
    }
  }
}

/// Whether what a scan is predicted from is there.
Status check_reference(const PredictionHeader& prediction, const DecodedScan* reference) {
  if (reference == nullptr) {
    return Error{ErrorCode::invalid_argument,
                 "the scan is predicted from another one, without which it cannot be decoded: "
                 "decode it as a part of its sequence"};
  }
  if (!reference->missing.empty() || fingerprint_of(*reference) != prediction.reference) {
    return Error{ErrorCode::corrupt, "the scan is predicted from another one than the given"};
  }
  return {};
}

/// Fills the table of a scan with the rows of its reference.
Status take_rows(const ScanChunks& chunks, const PredictionHeader& prediction,
                 const DecodedScan& reference, ScanHeader& header) {
  const ScanParameters& p = header.parameters;
  const auto fault = [](const char* what) { return Error{ErrorCode::corrupt, what}; };
  if (find(chunks, ScanPart::sensor) != nullptr || reference.parameters.rows != p.rows) {
    return fault("the rows of a predicted scan are not those of its reference");
  }
  const std::uint32_t turn_columns = header.table.turn_columns,
                      first_column = header.table.first_column;
  header.table = reference.table;
  header.table.turn_columns = turn_columns;
  header.table.first_column = first_column;
  const bool own_times = header.table.rays && !prediction.same_firings;
  if (!own_times && find(chunks, ScanPart::rays) != nullptr) {
    return fault("rays of a predicted scan that has none of its own");
  }
  if (own_times) {
    CURLIDAR_TRY_ASSIGN(rays, require(chunks, ScanPart::rays));
    return read_firings_only(rays, p.columns, header.table);
  }
  if (prediction.same_firings &&
      (p.columns != reference.parameters.columns || turn_columns != reference.table.turn_columns ||
       first_column != reference.table.first_column)) {
    return fault("the columns of a predicted scan are not those of its reference");
  }
  return {};
}

std::vector<DecodedSegment> wanted_segments(const ScanParameters& parameters,
                                            const std::optional<Region>& region) {
  std::vector<DecodedSegment> segments;
  for (const SegmentPlace& place : segments_of(parameters)) {
    DecodedSegment segment;
    segment.place = place;
    segment.wanted = !region || touches(*region, place);
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace

std::string to_string(const Missing& m) {
  const char* name = m.part == ScanPart::mask    ? "mask"
                     : m.part == ScanPart::field ? "field"
                                                 : "residual layer";
  const std::string from =
      m.known == 0 ? std::string()
                   : fmt::format(" from {} {} of {} on", m.part == ScanPart::field ? "root" : "row",
                                 m.known, m.total);
  return fmt::format("the {} of rows {}..{}, columns {}..{}{}", name, m.place.row,
                     m.place.row + m.place.rows - 1, m.place.column,
                     m.place.column + m.place.columns - 1, from);
}

Result<ScanHeader> decode_scan_header(const ScanChunks& chunks, const ScanLimits& limits,
                                      const DecodedScan* reference) {
  CURLIDAR_TRY_ASSIGN(parameters, require(chunks, ScanPart::parameters));
  CURLIDAR_TRY_ASSIGN(header, read_parameters(parameters, limits));
  if (find(chunks, ScanPart::prediction) != nullptr) {
    CURLIDAR_TRY_ASSIGN(chunk, require(chunks, ScanPart::prediction));
    CURLIDAR_TRY_ASSIGN(prediction, read_prediction(chunk));
    CURLIDAR_TRY(check_reference(prediction, reference));
    header.prediction = prediction;
    if (prediction.same_rows) {
      CURLIDAR_TRY(take_rows(chunks, prediction, *reference, header));
      return header;
    }
  }
  CURLIDAR_TRY_ASSIGN(rows, require(chunks, ScanPart::sensor));
  CURLIDAR_TRY(read_rows(rows, header.parameters.rows, header.table));
  if (const ScanChunkView* rays = find(chunks, ScanPart::rays);
      rays != nullptr && !header.table.rays) {
    return scan_error(ErrorCode::corrupt, ScanPart::rays, rays->offset,
                      "rays of a scan that has none");
  }
  if (header.table.rays) {
    CURLIDAR_TRY_ASSIGN(rays, require(chunks, ScanPart::rays));
    CURLIDAR_TRY(read_rays(rays, header.parameters.rows, header.parameters.columns, header.table));
  }
  return header;
}

Result<DecodedScan> decode_scan(const ScanChunks& chunks, const ScanLimits& limits,
                                const ScanOptions& options) {
  CURLIDAR_TRY_ASSIGN(header, decode_scan_header(chunks, limits, options.reference));
  DecodedScan out;
  out.parameters = header.parameters;
  out.table = std::move(header.table);
  out.segments = wanted_segments(out.parameters, options.region);
  CURLIDAR_TRY_ASSIGN(views, segment_views(chunks, out.parameters, out.segments.size()));
  CURLIDAR_TRY(check_mask_sizes(out.segments, views[0]));

  std::optional<Prediction> prediction;
  if (header.prediction) {
    prediction = predict(*options.reference, header.prediction->pose, out.table,
                         out.parameters.rows, out.parameters.columns);
  }
  const std::size_t parts = options.field_only ? 2 : parts_of(out.parameters);
  const auto residual_of = [&](std::size_t i) {
    return parts > 2 ? chunk_of(views[2], i) : SegmentChunk{};
  };
  std::vector<SegmentScan> scans(out.segments.size());
  parallel_for(scans.size(), options.threads, [&](std::size_t i) {
    if (!out.segments[i].wanted) return;
    scans[i] = decode_segment(out.table, out.parameters, out.segments[i].place,
                              chunk_of(views[0], i), chunk_of(views[1], i), residual_of(i),
                              options.keep_nodes, prediction ? &*prediction : nullptr);
  });
  if (scans.size() == 1) out.learnt = std::move(scans.front().learnt);

  const std::size_t cells = std::size_t{out.parameters.rows} * out.parameters.columns;
  out.occupied.resize(cells);
  out.range.resize(cells);
  out.field_range.resize(cells);
  out.surface.resize(cells, kNoSurface);
  out.leaf.resize(cells, -1);
  std::size_t surfaces = 0;
  for (const SegmentScan& scan : scans) surfaces += scan.surfaces.size();
  out.surfaces.reserve(surfaces);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (!out.segments[i].wanted) continue;
    CURLIDAR_TRY(check_progress(scans[i], out.segments[i].place, static_cast<std::uint32_t>(i),
                                views, parts, out.missing));
    put_segment(scans[i], out.segments[i], out);
    scans[i] = {};
  }
  if (options.region) crop(*options.region, out);
  if (prediction) {
    out.guide_planes = std::move(prediction->planes);
    out.guide_source = std::move(prediction->source);
  }
  return out;
}

Result<std::optional<std::vector<IndexedChunk>>> decode_scan_index(const ScanChunks& chunks,
                                                                   const ScanLimits& limits) {
  using Index = std::optional<std::vector<IndexedChunk>>;
  CURLIDAR_TRY_ASSIGN(parameters, require(chunks, ScanPart::parameters));
  CURLIDAR_TRY_ASSIGN(header, read_parameters(parameters, limits));
  const ScanChunkView* chunk = find(chunks, ScanPart::index);
  if (chunk == nullptr || !chunk->whole) return Index{};
  const ScanParameters& p = header.parameters;
  const std::size_t segments = std::size_t{p.bands} * p.sectors;
  CURLIDAR_TRY_ASSIGN(sizes, read_index(*chunk, segments * parts_of(p)));
  std::vector<IndexedChunk> index;
  std::uint64_t end = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::uint64_t frame = frame_size(sizes[i]);
    index.push_back({kSegmentParts[i / segments], static_cast<std::uint32_t>(i % segments),
                     end + frame - 4, sizes[i]});
    end += frame + sizes[i];
  }
  return Index{std::move(index)};
}

}  // namespace curlidar::compact
