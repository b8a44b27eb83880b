// SPDX-License-Identifier: BSD-3-Clause
// From the chunks of a compact file, as far as they are there, to an image and its field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compact/field_code.hpp"
#include "compact/relative_pose.hpp"
#include "compact/scan_types.hpp"
#include "curlidar/result.hpp"

namespace curlidar::compact {

struct LearntModels;

struct ScanLimits {
  /// Rows * columns; at most 2^31 - 1 in any case. Checked before anything is allocated; a decoder
  /// takes some 100 bytes a cell, and for hostile bytes, which may make every cell a leaf, at most
  /// some 1000.
  std::uint64_t max_cells = std::uint64_t{1} << 26;
};

/// Cells of the image: rows row_begin .. row_end - 1, likewise columns; the ends are clamped.
struct Region {
  std::uint32_t row_begin = 0, row_end = UINT32_MAX;
  std::uint32_t column_begin = 0, column_end = UINT32_MAX;
};

struct DecodedScan;

struct ScanOptions {
  bool field_only = false;       ///< leave the residual layer out
  std::optional<Region> region;  ///< only segments that touch it are read; cells outside stay empty
  bool keep_nodes = false;       ///< keep the partition of each segment
  std::size_t threads = 0;       ///< 0 = all cores
  const DecodedScan* reference = nullptr;  ///< whole: what a predicted scan is predicted from
};

/// The chunks of a file as an opener finds them.
struct ScanChunks {
  std::vector<ScanChunkView> chunks;  ///< in file order; others than a scan's are left out
  bool complete = true;               ///< false: the file is cut off, so that chunks may be missing
};

/// What a leaf is: a block with one or more layers.
struct DecodedLeaf {
  Block block;                      ///< in the segment
  std::uint32_t first_surface = 0;  ///< in DecodedScan::surfaces
  std::uint32_t layers = 1;
  bool has_residual = false;
};

/// How a scan is predicted: the motion since its reference, and what it shares with it.
struct PredictionHeader {
  RelativePose pose;
  bool same_rows = false;       ///< elevations, heights, range offsets and rays are the reference's
  bool same_firings = false;    ///< so are columns, firings and motion; only with same_rows
  std::uint16_t reference = 0;  ///< fingerprint of the reference

  friend bool operator==(const PredictionHeader&, const PredictionHeader&) = default;
};

struct DecodedSegment {
  SegmentPlace place;
  bool wanted = true;           ///< false: outside the region, nothing else is filled
  std::uint32_t mask_rows = 0;  ///< rows whose mask is known
  std::size_t roots = 0;        ///< roots whose field is known, row by row
  std::uint32_t residual_rows = 0;
  std::uint32_t first_surface = 0, surfaces = 0;  ///< in DecodedScan::surfaces
  std::uint32_t first_leaf = 0, leaves = 0;       ///< in DecodedScan::leaves
  std::vector<Node> nodes;                        ///< of the roots, if keep_nodes
};

/// A part of a segment that the file should hold and does not.
struct Missing {
  ScanPart part = ScanPart::mask;
  std::uint32_t segment = 0;
  SegmentPlace place;
  std::uint64_t known = 0, total = 0;  ///< rows of a mask or residual, roots of a field
};
/// "the field of rows 0..63, columns 512..1023 from root 12 of 128 on".
std::string to_string(const Missing& missing);

struct DecodedScan {
  ScanParameters parameters;
  RowTable table;
  /// All of rows * columns cells, row-major.
  std::vector<std::uint8_t> occupied;     ///< whether the cell holds a return
  std::vector<std::int32_t> range;        ///< Q16 metres; 0 = empty or not known
  std::vector<std::int32_t> field_range;  ///< the same of the field alone
  std::vector<std::int32_t> surface;      ///< place in `surfaces`, kNoSurface = none
  std::vector<std::int32_t> leaf;         ///< place in `leaves`, -1 = none
  /// With blocks relative to their segments, whose geometry_of() evaluates them; they give
  /// range - range_offset.
  std::vector<PlacedSurface> surfaces;
  /// Of predicted scans: what warped surfaces lie over in each cell, as Prediction; else empty.
  std::vector<Plane> guide_planes;
  std::vector<std::int32_t> guide_source;
  std::shared_ptr<const LearntModels> learnt;  ///< at the end of scans of one segment
  std::vector<DecodedLeaf> leaves;
  std::vector<DecodedSegment> segments;
  std::vector<Missing> missing;  ///< empty: all that was asked for is here
};

/// Parameters and table only: what `info` needs. Errors as decode_scan.
struct ScanHeader {
  ScanParameters parameters;
  RowTable table;
  std::optional<PredictionHeader> prediction{};  ///< of predicted scans
};
/// `reference` as ScanOptions has it.
Result<ScanHeader> decode_scan_header(const ScanChunks& chunks, const ScanLimits& limits = {},
                                      const DecodedScan* reference = nullptr);

/// The surface of a cell that has one, as it is in this cell.
inline Surface surface_in(const DecodedScan& scan, std::size_t cell) {
  const Surface& surface = scan.surfaces[static_cast<std::size_t>(scan.surface[cell])].surface;
  if (!surface.warped || scan.guide_source[cell] < 0) return surface;
  return on_plane_of(surface, scan.guide_planes[static_cast<std::size_t>(scan.guide_source[cell])]);
}

/// Decodes what is there. Integers only: the same on every machine and for any number of threads.
/// Any bytes decode to something or to an error: corrupt (a chunk too many, or too few in a
/// complete file, or one that makes no sense; names chunk and byte), limit_exceeded, unsupported
/// (flags of a later version). O(cells), about 1 us a return.
Result<DecodedScan> decode_scan(const ScanChunks& chunks, const ScanLimits& limits = {},
                                const ScanOptions& options = {});

/// Where each chunk of a file lies, from its index, so that a region can be read without the rest.
struct IndexedChunk {
  ScanPart part = ScanPart::mask;
  std::uint32_t segment = 0;
  std::uint64_t offset = 0;  ///< of the payload, from the end of the index chunk (its checksum)
  std::uint64_t size = 0;
};
/// nullopt if the file has no index chunk.
Result<std::optional<std::vector<IndexedChunk>>> decode_scan_index(const ScanChunks& chunks,
                                                                   const ScanLimits& limits = {});

}  // namespace curlidar::compact
