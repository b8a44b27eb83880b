// SPDX-License-Identifier: BSD-3-Clause
// The image of a file with every return: how exactly its ranges and directions are coded.
#pragma once

#include "codec/compact_search.hpp"
#include "codec/record_layout.hpp"

namespace curlidar {

/// An image as it will be written.
struct RecordImage {
  CompactModel model;
  CompactTrial trial;
};

/// Encodes the image of a layout that has one. `loose`: the points without a cell as decoded;
/// `beside_bits`: what the file takes besides. Errors as search_target.
Result<RecordImage> encode_record_image(const Cloud& cloud, const RecordLayout& layout,
                                        const std::vector<Vec3>& loose,
                                        const EncodeSettings& settings, double beside_bits,
                                        const ProgressCallback& progress,
                                        const PredictionSource* source = nullptr);

}  // namespace curlidar
