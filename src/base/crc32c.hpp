// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "base/bytes.hpp"

namespace curlidar {

/// CRC-32C (Castagnoli; reflected polynomial 0x82f63b78, as in iSCSI, RFC 3720 appendix B.4).
/// crc32c(b, crc32c(a)) is the checksum of a followed by b.
std::uint32_t crc32c(ByteSpan bytes, std::uint32_t crc = 0);

}  // namespace curlidar
