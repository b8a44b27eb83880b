// SPDX-License-Identifier: BSD-3-Clause
// One segment: mask, field and residual layer, each on the ones before it. Nothing here knows of
// other segments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "compact/field_encoder.hpp"
#include "compact/prediction.hpp"
#include "compact/scan_decoder.hpp"
#include "compact/scan_effort.hpp"

namespace curlidar::compact {

/// A segment as decoded. Surfaces and leaves are numbered within it; ranges include the rows'
/// offsets. Planes hold place.cells() entries.
struct SegmentScan {
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> range, field_range, surface, leaf;
  std::vector<PlacedSurface> surfaces;
  std::vector<DecodedLeaf> leaves;
  std::vector<Node> nodes;
  std::shared_ptr<const LearntModels> learnt;  ///< of segments that are the whole image
  std::size_t mask_rows = 0, roots = 0, total_roots = 0, residual_rows = 0;
};

struct EncodedSegment {
  std::vector<std::byte> mask, field, residual;
  std::array<std::uint64_t, kFieldParts> part_cost{};  ///< of the field, 1/256 bit
  SegmentScan decoded;
};

/// `prediction`, if any, is of the whole image.
EncodedSegment encode_segment(const Image& image, const RowTable& table,
                              const ScanParameters& parameters, const SegmentPlace& place,
                              const Effort& effort, const Prediction* prediction = nullptr);

/// A chunk of a segment as far as it is there.
struct SegmentChunk {
  bool present = false, whole = false;
  ByteSpan payload;
};

/// Decodes what is there: of a cut mask its rows (and no field), of a cut field its roots (and no
/// residuals), of cut residuals their rows. Progress of a whole chunk that is short of the whole
/// segment means that the chunk is damaged.
SegmentScan decode_segment(const RowTable& table, const ScanParameters& parameters,
                           const SegmentPlace& place, const SegmentChunk& mask,
                           const SegmentChunk& field, const SegmentChunk& residual, bool keep_nodes,
                           const Prediction* prediction = nullptr);

}  // namespace curlidar::compact
