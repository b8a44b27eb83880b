// SPDX-License-Identifier: BSD-3-Clause
// Profile::compact with every return: an image on the sensor's own lattice, and what brings each
// point back to its place in the cloud.
#pragma once

#include "codec/predicted_image.hpp"
#include "curlidar/codec.hpp"

namespace curlidar {

Result<Encoded> encode_records(const Cloud& cloud, const EncodeSettings& settings,
                               const ProgressCallback& progress,
                               const PredictionSource* source = nullptr);

}  // namespace curlidar
