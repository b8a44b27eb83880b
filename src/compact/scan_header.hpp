// SPDX-License-Identifier: BSD-3-Clause
// The small chunks of a scan: parameters, sensor table, index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "compact/scan_types.hpp"
#include "curlidar/result.hpp"

namespace curlidar::compact {

/// "<chunk> chunk, byte <offset>: <what>".
Error scan_error(ErrorCode code, ScanPart part, std::size_t offset, std::string_view what);

/// invalid_argument unless a file can hold them.
Status check_header(const ScanParameters& parameters, const RowTable& table);

std::vector<std::byte> write_parameters(const ScanParameters& parameters, const RowTable& table);
/// Fills all of the header but the table's rows.
Result<ScanHeader> read_parameters(const ScanChunkView& chunk, const ScanLimits& limits);

/// Rows of a table by the range coder: some 4 bits an elevation where rings are irregular.
std::vector<std::byte> write_rows(const RowTable& table);
/// Fills the table's rows; `rows` has been checked against the limits. Of a table with rays, whose
/// elevations are in the chunk of the rays, it makes room for these.
Status read_rows(const ScanChunkView& chunk, std::uint32_t rows, RowTable& table);

/// Sizes of the payloads of all masks, fields, residuals.
std::vector<std::byte> write_index(const std::vector<std::uint64_t>& sizes);
Result<std::vector<std::uint64_t>> read_index(const ScanChunkView& chunk, std::size_t count);

/// Bytes that a container adds to a payload.
std::uint64_t frame_size(std::uint64_t payload_size);

}  // namespace curlidar::compact
