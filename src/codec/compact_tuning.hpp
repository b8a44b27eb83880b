// SPDX-License-Identifier: BSD-3-Clause
// What is learnt of a scan by encoding it quickly, before the search for its target.
#pragma once

#include <vector>

#include "codec/compact_search.hpp"

namespace curlidar {

/// Gives the model, which is the job's, range offsets if they make the file smaller at the same
/// error, and the job what was learnt about where to start. `offsets`: a first guess, metres, of
/// each row; `error_m`: the mean range error that is wanted.
Status choose_range_offsets(CompactJob& job, std::vector<double> offsets, double error_m,
                            CompactModel& model);

}  // namespace curlidar
