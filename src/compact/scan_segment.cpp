// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_segment.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include "compact/leaf_flags.hpp"
#include "compact/learnt_models.hpp"
#include "compact/mask_coder.hpp"
#include "compact/residual_coder.hpp"
#include "compact/row_offsets.hpp"

namespace curlidar::compact {
namespace {

FieldSettings field_settings(const ScanParameters& p) {
  return {p.step, p.root_log2, p.smallest_leaf};
}

std::optional<Guide> guide_in(const Prediction* prediction, const SegmentPlace& place) {
  if (prediction == nullptr) return std::nullopt;
  return guide_of(*prediction, place);
}

MaskShape mask_shape(const RowTable& table, const SegmentPlace& place) {
  return {place.rows, place.columns, table.turn_columns};
}

std::int32_t clamp_range(std::int64_t range) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(range, 1, kMaxRangeQ16));
}

/// Calls `body(cell of the segment, cell of the image, range offset)` for every cell.
template <class Body>
void for_each_cell(const RowTable& table, const SegmentPlace& place, std::uint32_t columns,
                   const Body& body) {
  std::size_t cell = 0;
  for (std::uint32_t i = 0; i < place.rows; ++i) {
    const std::int32_t offset = offset_of(table, place.row + i);
    const std::size_t begin = std::size_t{place.row + i} * columns + place.column;
    for (std::uint32_t j = 0; j < place.columns; ++j) body(cell++, begin + j, offset);
  }
}

/// The ranges of known cells with the offsets of their rows, 0 elsewhere.
std::vector<std::int32_t> with_offsets(const RowTable& table, const SegmentPlace& place,
                                       const FieldState& state,
                                       const std::vector<std::int32_t>& ranges) {
  std::vector<std::int32_t> out(ranges.size(), 0);
  for_each_cell(table, place, place.columns, [&](std::size_t cell, std::size_t, std::int32_t b) {
    if (state.surface[cell] == kNoSurface) return;
    out[cell] = clamp_range(std::int64_t{ranges[cell]} + b);
  });
  return out;
}

/// The field as residuals are taken from it: on a lattice of ranges with the rows' offsets, else
/// without.
const std::vector<std::int32_t>& residual_base(const FieldState& state, const ScanParameters& p,
                                               const SegmentScan& scan) {
  return p.lattice_q32 != 0 ? scan.field_range : state.range;
}

ResidualSegment residual_segment(const FieldState& state, const std::vector<std::uint8_t>& coded,
                                 const std::vector<std::int32_t>& base) {
  return {state.geometry.rows(), state.geometry.columns(), state.occupied, coded, base,
          state.surface};
}

ResidualLevels levels_of(const ScanParameters& p) {
  return {p.residual_step, p.lattice_q32};
}

/// Takes over what the residual layer decoded.
void take_ranges(const FieldState& state, const RowTable& table, const ScanParameters& p,
                 const SegmentPlace& place, std::vector<std::int32_t>& decoded, SegmentScan& scan) {
  scan.range = p.lattice_q32 != 0 ? std::move(decoded) : with_offsets(table, place, state, decoded);
}

std::vector<std::uint8_t> coded_cells(const std::vector<DecodedLeaf>& leaves,
                                      const std::vector<std::int32_t>& leaf_of_cell) {
  std::vector<std::uint8_t> coded(leaf_of_cell.size(), 0);
  for (std::size_t cell = 0; cell < coded.size(); ++cell) {
    const std::int32_t leaf = leaf_of_cell[cell];
    if (leaf >= 0 && leaves[static_cast<std::size_t>(leaf)].has_residual) coded[cell] = 1;
  }
  return coded;
}

/// Gives residuals to the leaves that are the cheaper for them.
void choose_leaves(const FieldState& state, const std::vector<std::int32_t>& truth,
                   const Effort& effort, std::int32_t step,
                   const std::vector<std::int32_t>& leaf_of_cell,
                   std::vector<DecodedLeaf>& leaves) {
  constexpr std::int64_t kMust = std::int64_t{1} << 56;  // above any gain of a leaf's cells
  std::vector<std::int64_t> gain(leaves.size(), 0);
  const auto last = static_cast<std::int64_t>(effort.residual_costs.size()) - 1;
  for (std::size_t cell = 0; cell < leaf_of_cell.size(); ++cell) {
    if (leaf_of_cell[cell] < 0) continue;
    const std::int64_t error = std::abs(std::int64_t{truth[cell]} - state.range[cell]);
    const std::int64_t at = std::min(error * 8 / step, last);
    std::int64_t& of_leaf = gain[static_cast<std::size_t>(leaf_of_cell[cell])];
    if (effort.max_error > 0 && error > effort.max_error) of_leaf = kMust;
    of_leaf += error * 256 - effort.residual_costs[static_cast<std::size_t>(at)];
  }
  for (std::size_t i = 0; i < leaves.size(); ++i) leaves[i].has_residual = gain[i] > 0;
}

/// Writes the residual layer and takes over the ranges as they will be decoded. `truth`: what the
/// field approximates; `ranges`: the same with the rows' offsets.
void write_residual(const FieldState& state, const RowTable& table, const ScanParameters& p,
                    const SegmentPlace& place, const std::vector<std::int32_t>& truth,
                    const std::vector<std::int32_t>& ranges, const Effort& effort,
                    EncodedSegment& out) {
  SegmentScan& scan = out.decoded;
  choose_leaves(state, truth, effort, p.residual_step, scan.leaf, scan.leaves);
  const std::vector<std::byte> flags = encode_leaf_flags(state, scan.leaves, scan.leaf);
  const std::vector<std::uint8_t> coded = coded_cells(scan.leaves, scan.leaf);
  const ResidualBalance balance{static_cast<std::uint32_t>(effort.residual_lambda * 256),
                                effort.max_error};
  std::vector<std::int32_t> decoded(truth.size(), 0);
  ByteWriter writer;
  writer.write_varint(flags.size());
  writer.write_bytes(flags);
  writer.write_bytes(encode_residual(residual_segment(state, coded, residual_base(state, p, scan)),
                                     p.lattice_q32 != 0 ? ranges : truth, levels_of(p), balance,
                                     decoded));
  out.residual = std::move(writer).bytes();
  take_ranges(state, table, p, place, decoded, scan);
}

std::size_t root_count(const ScanParameters& p, const SegmentPlace& place) {
  const std::size_t side = std::size_t{1} << p.root_log2;
  return ((place.rows + side - 1) / side) * ((place.columns + side - 1) / side);
}

/// Takes everything of the field into the segment.
void take_field(FieldState& state, const RowTable& table, const SegmentPlace& place,
                SegmentScan& out) {
  out.leaves = leaves_of(state);
  out.leaf = leaf_cells(state, out.leaves);
  out.field_range = with_offsets(table, place, state, state.range);
  out.range = out.field_range;
}

/// Forgets what was read of the root after the complete ones.
void forget_torn_root(FieldState& state, std::size_t complete) {
  const std::vector<Block> roots = roots_of(state.geometry, state.settings);
  if (complete >= roots.size()) return;
  const Block& torn = roots[complete];
  const auto inside = [&](const Block& b) {
    return b.row >= torn.row && b.row < torn.row + torn.height && b.column >= torn.column &&
           b.column < torn.column + torn.width;
  };
  while (!state.surfaces.empty() && inside(state.surfaces.back().block)) state.surfaces.pop_back();
  const auto count = static_cast<std::int32_t>(state.surfaces.size());
  for (std::int32_t& surface : state.surface) {
    if (surface >= count) surface = kNoSurface;
  }
}

/// Reads the residual layer as far as it is there.
void read_residual(const FieldState& state, const RowTable& table, const ScanParameters& p,
                   const SegmentPlace& place, const SegmentChunk& chunk, SegmentScan& out) {
  ByteReader reader(chunk.payload);
  const std::uint64_t flag_size = reader.read_varint();
  const ByteSpan flags = reader.take(flag_size);
  if (!reader.ok() || !decode_leaf_flags(flags, state, out.leaves, out.leaf)) {
    for (DecodedLeaf& leaf : out.leaves) leaf.has_residual = false;
    return;
  }
  const std::vector<std::uint8_t> coded = coded_cells(out.leaves, out.leaf);
  const std::vector<std::int32_t>& base = residual_base(state, p, out);
  std::vector<std::int32_t> decoded(base.size(), 0);
  out.residual_rows =
      decode_residual(reader.take(reader.remaining()), residual_segment(state, coded, base),
                      levels_of(p), decoded, !chunk.whole);
  take_ranges(state, table, p, place, decoded, out);
}

}  // namespace

EncodedSegment encode_segment(const Image& image, const RowTable& table,
                              const ScanParameters& parameters, const SegmentPlace& place,
                              const Effort& effort, const Prediction* prediction) {
  EncodedSegment out;
  const std::optional<Guide> guide = guide_in(prediction, place);
  SegmentScan& scan = out.decoded;
  scan.occupied.resize(place.cells());
  std::vector<std::int32_t> truth(place.cells(), 0), ranges(place.cells(), 0);
  for_each_cell(table, place, image.columns,
                [&](std::size_t cell, std::size_t from, std::int32_t offset) {
                  if (image.range[from] == 0) return;
                  scan.occupied[cell] = 1;
                  ranges[cell] = image.range[from];
                  truth[cell] = clamp_range(std::int64_t{image.range[from]} - offset);
                });
  out.mask = encode_mask(scan.occupied, mask_shape(table, place),
                         effort.thorough_mask || guide.has_value(), guide ? &*guide : nullptr);

  const Geometry geometry = geometry_of(table, place);
  FieldState state(geometry, scan.occupied, field_settings(parameters), guide ? &*guide : nullptr);
  EncodedField field = encode_field(state, truth, effort.search);
  out.field = std::move(field.bytes);
  out.part_cost = field.part_cost;
  take_field(state, table, place, scan);
  if (parameters.residual_step > 0) {
    write_residual(state, table, parameters, place, truth, ranges, effort, out);
    scan.residual_rows = place.rows;
  }
  scan.surface = std::move(state.surface);
  scan.surfaces = std::move(state.surfaces);
  scan.nodes = std::move(field.roots);
  scan.mask_rows = place.rows;
  scan.roots = scan.total_roots = scan.nodes.size();
  return out;
}

SegmentScan decode_segment(const RowTable& table, const ScanParameters& parameters,
                           const SegmentPlace& place, const SegmentChunk& mask,
                           const SegmentChunk& field, const SegmentChunk& residual, bool keep_nodes,
                           const Prediction* prediction) {
  SegmentScan out;
  const std::optional<Guide> guide = guide_in(prediction, place);
  out.occupied.resize(place.cells());
  out.range.resize(place.cells());
  out.field_range.resize(place.cells());
  out.surface.resize(place.cells(), kNoSurface);
  out.leaf.resize(place.cells(), -1);
  out.total_roots = root_count(parameters, place);
  if (!mask.present) return out;
  std::shared_ptr<LearntModels> learnt;
  if (parameters.bands * parameters.sectors == 1) learnt = std::make_shared<LearntModels>();
  out.mask_rows = decode_mask(mask.payload, mask_shape(table, place), mask.whole, out.occupied,
                              guide ? &*guide : nullptr, learnt.get());
  std::fill(out.occupied.begin() + static_cast<std::ptrdiff_t>(out.mask_rows * place.columns),
            out.occupied.end(), std::uint8_t{0});
  if (out.mask_rows < place.rows || !field.present) return out;

  const Geometry geometry = geometry_of(table, place);
  FieldState state(geometry, out.occupied, field_settings(parameters), guide ? &*guide : nullptr);
  DecodedField decoded = decode_field(state, field.payload, field.whole, keep_nodes, learnt.get());
  out.roots = decoded.complete_roots;
  forget_torn_root(state, out.roots);
  out.nodes = std::move(decoded.roots);
  take_field(state, table, place, out);
  if (residual.present && out.roots == out.total_roots) {
    read_residual(state, table, parameters, place, residual, out);
  }
  out.surface = std::move(state.surface);
  out.surfaces = std::move(state.surfaces);
  out.learnt = std::move(learnt);
  return out;
}

}  // namespace curlidar::compact
