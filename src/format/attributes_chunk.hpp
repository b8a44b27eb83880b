// SPDX-License-Identifier: BSD-3-Clause
// The attributes chunk: named values of the coded returns, lossless.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"
#include "format/payload.hpp"

namespace curlidar {

inline constexpr std::size_t kMaxAttributes = 256;
inline constexpr std::size_t kMaxAttributeNameBytes = 255;
inline constexpr std::uint32_t kMaxAttributeComponents = 65536;

/// The payload for attributes of `returns` returns each, bit for bit (NaN payloads included).
/// invalid_argument, with the attribute named, for a wrong number of values, no or too many
/// components, a name that is empty, taken, too long or not UTF-8.
Result<std::vector<std::byte>> write_attributes(const std::vector<Attribute>& attributes,
                                                std::size_t returns);
/// The attributes of `returns` returns; limit_exceeded if they take more than max_bytes of memory
/// together.
Result<std::vector<Attribute>> read_attributes(const Chunk& chunk, std::uint64_t returns,
                                               std::uint64_t max_bytes);

/// Appends the values of an attribute to a payload.
using WriteValues = std::function<void(ByteWriter&, const Attribute&)>;
/// Sets the values of an attribute, of the type that its empty ones have.
using ReadValues = std::function<Status(PayloadReader&, Attribute&)>;

/// A list of attributes of `count` points each, their values written by `write_values`. Errors as
/// write_attributes.
Result<std::vector<std::byte>> write_attribute_list(const std::vector<Attribute>& attributes,
                                                    std::size_t count,
                                                    const WriteValues& write_values);
/// The same list, the end of the payload. Errors as read_attributes, and those of `read_values`.
Result<std::vector<Attribute>> read_attribute_list(PayloadReader& reader, std::uint64_t count,
                                                   std::uint64_t max_bytes,
                                                   const ReadValues& read_values);

}  // namespace curlidar
