// SPDX-License-Identifier: BSD-3-Clause
#include "records/attributes.hpp"

#include "base/try.hpp"
#include "format/attributes_chunk.hpp"

namespace curlidar {

Result<std::vector<std::byte>> write_records(const std::vector<Attribute>& attributes,
                                             const CloudOrder& order,
                                             const RecordGeometry& /*geometry*/) {
  return write_attributes(attributes, order.slots());
}

Result<std::vector<Attribute>> read_records(const Chunk& chunk, const CloudOrder& order,
                                            const RecordGeometry& /*geometry*/,
                                            std::uint64_t max_bytes) {
  return read_attributes(chunk, order.slots(), max_bytes);
}

}  // namespace curlidar
