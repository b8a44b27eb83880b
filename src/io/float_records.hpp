// SPDX-License-Identifier: BSD-3-Clause
// Headerless files of float32 records, KITTI and nuScenes.
#pragma once

#include <string>
#include <vector>

#include "io/formats.hpp"

namespace curlidar::io {

/// `fields` start with x, y, z. A size that is no multiple of the record is an error.
Result<Cloud> parse_float_records(const Source& source, const char* format,
                                  const std::vector<std::string>& fields);

/// Attributes are converted to float32; missing ones are written as 0; others are an error.
Result<Bytes> format_float_records(const Cloud& cloud, const char* format,
                                   const std::vector<std::string>& fields);

}  // namespace curlidar::io
