// SPDX-License-Identifier: BSD-3-Clause
// What a file with every return holds beside its image, and the way from a decoded image to the
// points in their slots.
#pragma once

#include <optional>
#include <vector>

#include "compact/scan_types.hpp"
#include "curlidar/codec.hpp"
#include "format/container.hpp"
#include "records/grid.hpp"
#include "records/order.hpp"

namespace curlidar {

/// Whether the chunks are those of a file with every return.
bool has_records(const std::vector<Chunk>& chunks);

/// Corrupt if there are chunks that only files with every return have: of a whole file without an
/// order.
Status check_no_records(const std::vector<Chunk>& chunks);

/// Coordinates as a type holds them.
void round_to(ScalarType type, std::vector<Vec3>& points);

/// An image as records see it.
class RecordCells {
 public:
  RecordCells(const compact::RowTable& table, const compact::Image& image);

  CellGrid grid(std::size_t loose) const { return {image_.rows, image_.columns, occupied_, loose}; }
  RecordGeometry geometry(std::size_t loose) const;
  /// Ranges of the occupied cells.
  const std::vector<std::int32_t>& ranges() const { return ranges_; }

 private:
  const compact::Image& image_;
  std::vector<std::uint8_t> occupied_;
  std::vector<std::int32_t> ranges_;
  std::vector<std::int32_t> column_shift_;
};

/// What the chunks beside the image decode to.
struct DecodedRecords {
  std::vector<Vec3> points;  ///< of every record: cells in raster order, then loose ones
  std::size_t loose = 0;
  CloudOrder order;
  std::vector<Attribute> attributes;  ///< of every slot
};

/// `image` may have no rows; it is what directions and attributes were coded with. With `coarse`
/// the points of cells are those of its ranges instead, and corrections are left out: they make no
/// sense there. Errors: as the chunks' readers.
Result<DecodedRecords> decode_records(const std::vector<Chunk>& chunks,
                                      const compact::RowTable& table, const compact::Image& image,
                                      const compact::Image* coarse, const DecodeLimits& limits);

/// The points of the cells with the offsets of their directions, if there are any; those of
/// `coarse`'s ranges if it is given.
Result<std::vector<Vec3>> decode_cell_points(const std::vector<Chunk>& chunks,
                                             const compact::RowTable& table,
                                             const compact::Image& image,
                                             const compact::Image* coarse);

/// Every record in its slot.
Cloud assemble_cloud(const DecodedRecords& records);
/// Attributes of records in place of those of slots.
std::vector<Attribute> attributes_of_records(const DecodedRecords& records);

std::vector<std::byte> write_promise(const RecordPromise& promise);
Result<RecordPromise> read_promise(const std::vector<Chunk>& chunks);

}  // namespace curlidar
