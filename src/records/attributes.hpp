// SPDX-License-Identifier: BSD-3-Clause
// The records chunk: attributes of every slot, bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"
#include "records/grid.hpp"
#include "records/order.hpp"

namespace curlidar {

/// The payload for attributes of every slot of `order`, in the order of the slots, NaN payloads
/// included. `geometry` must be what the decoder will have. Errors as write_attributes.
Result<std::vector<std::byte>> write_records(const std::vector<Attribute>& attributes,
                                             const CloudOrder& order,
                                             const RecordGeometry& geometry);

/// The attributes, in the order of the slots. Errors: corrupt, limit_exceeded (they take more than
/// max_bytes of memory together).
Result<std::vector<Attribute>> read_records(const Chunk& chunk, const CloudOrder& order,
                                            const RecordGeometry& geometry,
                                            std::uint64_t max_bytes);

}  // namespace curlidar
