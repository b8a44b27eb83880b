// SPDX-License-Identifier: BSD-3-Clause
// Attributes of points that nobody measured, from the coded returns on the same surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "curlidar/reconstruct.hpp"

namespace curlidar {

inline constexpr std::uint32_t kNoReturn = std::numeric_limits<std::uint32_t>::max();

/// Number of the coded return of each cell in raster order; kNoReturn in empty cells.
std::vector<std::uint32_t> number_returns(const Field& field);

/// Values of the numbered returns; zeros for kNoReturn.
Attribute gather(const Attribute& from, const std::vector<std::uint32_t>& returns);

/// Whether values between two returns make sense: of things measured, not of names and numbers.
bool is_interpolated(const Attribute& attribute);

/// The scan's attributes at points of its surfaces; zeros where a point is NaN or nothing is known
/// of it. `field` is the scan's, or one over it with the same cells. Threads change nothing.
std::vector<Attribute> attributes_at(const DecodedScan& scan, const Field& field,
                                     std::span<const Vec3> points, std::size_t threads);

}  // namespace curlidar
