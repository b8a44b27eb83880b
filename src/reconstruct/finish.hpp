// SPDX-License-Identifier: BSD-3-Clause
// From points to clouds: attributes, and the coded returns among them.
#pragma once

#include "reconstruct/view.hpp"

namespace curlidar {

/// The returns as they were coded: the encoded cloud of files with every return, else a point for
/// each coded cell, organised on the lattice on request.
Cloud coded_cloud(const DecodedScan& scan, bool organised);

/// Adds what the settings ask for to a cloud of coded returns.
void add_extras(const View& view, Cloud& coded);

/// The cloud of invented points with the scan's attributes and what the settings ask for.
Cloud finish(const View& view, Samples samples);

/// Invalid_argument if originals are to be kept where they have no place.
Status check_kept(const ReconstructSettings& settings);
/// The coded returns alone, without empty slots.
Result<Cloud> kept_originals(const DecodedScan& scan, std::size_t threads);
/// `invented` behind `originals`; both have attributes of the same scan.
Cloud behind(Cloud originals, const Cloud& invented);

}  // namespace curlidar
