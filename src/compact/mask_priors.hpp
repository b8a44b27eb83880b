// SPDX-License-Identifier: BSD-3-Clause
// What is known of masks before the first cell: docs/format/priors/mask.txt and mask_mix.txt.
#pragma once

#include "compact/mask_model.hpp"

namespace curlidar::compact {

/// The trained states; parsed once.
const MaskModel& mask_priors();

}  // namespace curlidar::compact
