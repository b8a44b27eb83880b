// SPDX-License-Identifier: BSD-3-Clause
// Profile::compact: a scan to a file.
#pragma once

#include "codec/predicted_image.hpp"
#include "curlidar/codec.hpp"

namespace curlidar {

/// `source`: what the scan is predicted from, if it is.
Result<Encoded> encode_compact(const Cloud& cloud, const EncodeSettings& settings,
                               const ProgressCallback& progress,
                               const PredictionSource* source = nullptr);

}  // namespace curlidar
