// SPDX-License-Identifier: BSD-3-Clause
// The chunks that hold a field of the paper profiles: masks, patches, the global expansion.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/codec.hpp"
#include "format/container.hpp"
#include "paper/global_fit.hpp"
#include "paper/pipeline.hpp"

namespace curlidar {

void write_masks(const CellMasks& masks, ContainerWriter& writer);
Result<CellMasks> read_masks(const std::vector<Chunk>& chunks, const Lattice& lattice);

std::vector<std::byte> write_patches(const std::vector<PatchFit>& patches);
/// One entry per patch of the grid; every number finite, at most kMaxPatchFunctions a patch.
Result<std::vector<PatchFit>> read_patches(const Chunk& chunk, const PatchGrid& grid,
                                           std::uint64_t max_bytes);

std::vector<std::byte> write_global(const std::vector<double>& coefficients);
Result<std::vector<double>> read_global(const Chunk& chunk, std::uint32_t degree);

}  // namespace curlidar
