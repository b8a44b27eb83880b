// SPDX-License-Identifier: BSD-3-Clause
// What is known of masks before the first cell: docs/format/priors/mask.txt and mask_mix.txt.
#pragma once

#include "compact/mask_guide.hpp"
#include "compact/mask_model.hpp"

namespace curlidar::compact {

/// The trained states; parsed once.
const MaskModel& mask_priors();
/// Those of predicted scans: predicted_mask.txt and predicted_mask_mix.txt.
const GuidedMaskModel& guided_mask_priors();

}  // namespace curlidar::compact
