// SPDX-License-Identifier: BSD-3-Clause
// Profile::compact: a scan to a file.
#pragma once

#include "curlidar/codec.hpp"

namespace curlidar {

Result<Encoded> encode_compact(const Cloud& cloud, const EncodeSettings& settings,
                               const ProgressCallback& progress);

}  // namespace curlidar
