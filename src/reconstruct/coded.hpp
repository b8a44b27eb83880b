// SPDX-License-Identifier: BSD-3-Clause
// The returns as they were coded: nothing between them, whatever is believed there.
#pragma once

#include <cstddef>

#include "curlidar/reconstruct.hpp"

namespace curlidar {

/// The encoded cloud of files with every return, else a point for each coded cell, organised on
/// the lattice on request. O(cells); threads change nothing.
Cloud coded_cloud(const DecodedScan& scan, bool organised, std::size_t threads);

/// The coded returns alone, without empty slots.
Cloud coded_returns(const DecodedScan& scan, std::size_t threads);

/// `invented` behind `coded`; both have attributes of the same scan.
Cloud behind(Cloud coded, const Cloud& invented);

}  // namespace curlidar
