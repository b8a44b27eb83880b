// SPDX-License-Identifier: BSD-3-Clause
// Files of many scans where one is wanted.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace curlidar::app {

/// Failure for the bytes of a map or a sequence, with what to do instead. `path` names them.
void refuse_many(const std::string& path, std::span<const std::byte> bytes);

}  // namespace curlidar::app
