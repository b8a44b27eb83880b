// SPDX-License-Identifier: BSD-3-Clause
// The tiles of a map, encoded and written in the order of their keys.
#pragma once

#include "curlidar/map.hpp"
#include "format/indexed_file.hpp"
#include "mapfile/still_filter.hpp"
#include "mapfile/tile_store.hpp"

namespace curlidar {

/// Encodes all tiles of the store, and those of `old` that the store does not touch as they are.
/// `old` and `still` may be null. Counts into the report.
Status write_tiles(TileStore& store, const MapFile* old, const StillFilter* still,
                   const MapHeader& header, IndexedWriter& writer, std::size_t threads,
                   MapReport& report, const ProgressCallback& progress);

}  // namespace curlidar
