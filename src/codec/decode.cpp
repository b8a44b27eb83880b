// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/try.hpp"
#include "codec/compact_decode.hpp"
#include "codec/field_chunks.hpp"
#include "curlidar/codec.hpp"
#include "format/attributes_chunk.hpp"
#include "format/metadata_chunk.hpp"
#include "format/parameters_chunk.hpp"
#include "format/sensor_chunk.hpp"
#include "paper/global_fit.hpp"
#include "paper/patch_field.hpp"

namespace curlidar {
namespace {

/// The fitted patches with their places on the coded lattice and their degrees, which follow from
/// the number of their coefficients.
std::vector<PaperPatch> places_of(const std::vector<PatchFit>& patches, const PatchGrid& grid,
                                  const Lattice& lattice, std::uint32_t side) {
  std::vector<PaperPatch> places;
  for (std::size_t i = 0; i < grid.rows(); ++i) {
    std::map<std::size_t, PatchBasis>
        bases;  // of this row's patches, by the width of their windows
    for (std::size_t j = 0; j < grid.columns(); ++j) {
      const std::size_t count = patches[i * grid.columns() + j].coefficients.size();
      if (count == 0) continue;
      const std::size_t width = grid.window(i, j).width();
      auto basis = bases.find(width);
      if (basis == bases.end()) basis = bases.emplace(width, grid.make_basis(i, j)).first;
      const auto row = static_cast<std::uint32_t>(i) * side;
      const auto column = static_cast<std::uint32_t>(j) * side;
      places.push_back({row, column, std::min(side, lattice.rows() - row),
                        std::min(side, lattice.columns() - column),
                        static_cast<std::uint32_t>(basis->second.degree_with(count))});
    }
  }
  return places;
}

Result<std::shared_ptr<const Field>> read_field(const std::vector<Chunk>& chunks,
                                                const Parameters& parameters,
                                                const Lattice& lattice, CellMasks masks,
                                                const DecodeOptions& options, DecodedScan& scan) {
  if (parameters.profile == Profile::paper_global) {
    CURLIDAR_TRY_ASSIGN(chunk, require_chunk(chunks, ChunkType::global));
    CURLIDAR_TRY_ASSIGN(coefficients, read_global(chunk, parameters.paper.global_degree));
    scan.coefficients = coefficients.size();
    scan.patches = 1;
    return std::shared_ptr<const Field>(std::make_shared<GlobalField>(
        GlobalModel{lattice, parameters.paper, std::move(masks), std::move(coefficients)}));
  }
  CURLIDAR_TRY_ASSIGN(chunk, require_chunk(chunks, ChunkType::patches));
  CURLIDAR_TRY(check_patches(parameters.paper, lattice));
  const PatchGrid grid(lattice, parameters.paper.upsample_rows, parameters.paper.upsample_columns,
                       parameters.paper.patch, parameters.paper.overlap);
  CURLIDAR_TRY_ASSIGN(patches, read_patches(chunk, grid, options.limits.max_bytes));
  for (const PatchFit& patch : patches) {
    scan.coefficients += patch.coefficients.size();
    scan.patches += patch.coefficients.empty() ? 0 : 1;
  }
  if (options.partition) {
    scan.paper_patches = places_of(patches, grid, lattice, parameters.paper.patch);
  }
  return std::shared_ptr<const Field>(std::make_shared<PatchField>(
      PaperModel{lattice, parameters.paper, std::move(masks), std::move(patches)}));
}

Result<DecodedScan> decode_paper(const std::vector<Chunk>& chunks, const DecodeOptions& options) {
  const DecodeLimits& limits = options.limits;
  CURLIDAR_TRY_ASSIGN(sensor_chunk, require_chunk(chunks, ChunkType::sensor));
  CURLIDAR_TRY_ASSIGN(sensor, read_sensor(sensor_chunk));
  CURLIDAR_TRY_ASSIGN(parameters_chunk, require_chunk(chunks, ChunkType::parameters));
  CURLIDAR_TRY_ASSIGN(parameters, read_parameters(parameters_chunk));
  if (const Status status = validate(parameters.paper); !status) {
    return Error{ErrorCode::corrupt, "parameters chunk: " + status.error().message};
  }
  const PaperSettings& settings = parameters.paper;
  const Lattice lattice = make_lattice({settings.row_rule, settings.rows, settings.columns,
                                        settings.min_range_m, settings.max_range},
                                       sensor);
  if (lattice.cells() > limits.max_cells) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("the file's lattice has {} x {} cells, more than the {} allowed",
                             lattice.rows(), lattice.columns(), limits.max_cells)};
  }
  CURLIDAR_TRY_ASSIGN(masks, read_masks(chunks, lattice));
  DecodedScan scan;
  scan.profile = parameters.profile;
  scan.sensor = std::move(sensor);
  scan.paper = settings;
  scan.coded_returns =
      static_cast<std::size_t>(std::count(masks.point.begin(), masks.point.end(), 1));
  if (const Chunk* chunk = find_chunk(chunks, ChunkType::attributes)) {
    CURLIDAR_TRY_ASSIGN(attributes, read_attributes(*chunk, scan.coded_returns, limits.max_bytes));
    scan.attributes = std::move(attributes);
  }
  if (const Chunk* chunk = find_chunk(chunks, ChunkType::metadata)) {
    CURLIDAR_TRY_ASSIGN(metadata, read_metadata(*chunk));
    scan.metadata = std::move(metadata);
  }
  CURLIDAR_TRY_ASSIGN(field,
                      read_field(chunks, parameters, lattice, std::move(masks), options, scan));
  scan.field = std::move(field);
  return scan;
}

/// Points that are coded one after the other are no scan before their order is known.
Status check_cut(const PartialContainer& container) {
  if (container.complete || is_compact(container.chunks)) return {};
  const bool loose = find_chunk(container.chunks, ChunkType::loose) != nullptr ||
                     (container.torn && container.torn->type == ChunkType::loose);
  if (!loose) return {};
  return Error{ErrorCode::corrupt,
               "the file is cut off before the order of its points, without which nothing of it "
               "can be decoded"};
}

/// A file may be cut off behind its geometry.
void note_cut(const PartialContainer& container, DecodedScan& scan) {
  if (container.complete || !scan.missing.empty()) return;
  scan.missing.push_back(container.torn ? fmt::format("its {} chunk and what lies behind it",
                                                      to_string(container.torn->type))
                                        : "its end, with any attributes and metadata behind it");
}

}  // namespace

Result<DecodedScan> decode(std::span<const std::byte> bytes, const DecodeLimits& limits) {
  DecodeOptions options;
  options.limits = limits;
  return decode(bytes, options);
}

Result<DecodedScan> decode(std::span<const std::byte> bytes, const DecodeOptions& options) {
  PartialContainer container;
  if (options.allow_truncated) {
    CURLIDAR_TRY_ASSIGN(partial, read_container_prefix(bytes));
    container = std::move(partial);
  } else {
    CURLIDAR_TRY_ASSIGN(chunks, read_container(bytes));
    container.complete = true;
    container.chunks = std::move(chunks);
  }
  CURLIDAR_TRY(check_cut(container));
  if (is_compact(container.chunks)) {
    CURLIDAR_TRY_ASSIGN(scan, decode_compact(container, options));
    note_cut(container, scan);
    return scan;
  }
  if (options.field_only || options.region) {
    return Error{ErrorCode::invalid_argument,
                 "only files of the compact profile can be decoded in part; this one has another"};
  }
  CURLIDAR_TRY_ASSIGN(scan, decode_paper(container.chunks, options));
  note_cut(container, scan);
  return scan;
}

}  // namespace curlidar
