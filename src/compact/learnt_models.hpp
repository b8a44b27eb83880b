// SPDX-License-Identifier: BSD-3-Clause
// What the models of a scan know at its end, where those of the scan predicted from it begin.
#pragma once

#include <optional>
#include <vector>

#include "compact/field_models.hpp"
#include "compact/mask_guide.hpp"

namespace curlidar::compact {

/// Of a scan of one segment: some 200 kB.
struct LearntModels {
  std::vector<BitModel> plain_mask;     ///< of single scans
  std::optional<GuidedMaskModel> mask;  ///< of predicted scans
  std::optional<FieldModels> field;     ///< of predicted scans
};

}  // namespace curlidar::compact
