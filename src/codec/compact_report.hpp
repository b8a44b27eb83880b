// SPDX-License-Identifier: BSD-3-Clause
// What an encoding reached, in the words of the public interface.
#pragma once

#include "codec/compact_search.hpp"

namespace curlidar {

CompactReport report_of(const CompactTrial& trial, const GriddedScan& scan,
                        const CompactModel& model, const OwnErrors& errors);

}  // namespace curlidar
