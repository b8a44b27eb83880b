// SPDX-License-Identifier: BSD-3-Clause
// Proof for whoever knows which slot of a file is which of a cloud.
#pragma once

#include <cstddef>
#include <memory>

#include "base/bytes.hpp"
#include "curlidar/codec.hpp"
#include "curlidar/verify.hpp"

namespace curlidar {

/// As `verify`, but slot by slot also for files that gave up the order.
Result<Verification> verify_slots(ByteSpan bytes, const Cloud& cloud, std::size_t threads,
                                  const std::shared_ptr<const PredictionReference>& reference = {});

}  // namespace curlidar
