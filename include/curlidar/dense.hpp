// SPDX-License-Identifier: BSD-3-Clause
// Between the samples: a decoded scan asked along any line of sight, for any virtual sensor.
#pragma once

#include <cstdint>
#include <memory>

#include "curlidar/field.hpp"

namespace curlidar {

/// What decides between the samples.
enum class DenseStrategy : std::uint8_t {
  best,   ///< the returns on the rings around a line of sight: the right surface at a jump
  masks,  ///< what the field itself says, by its own masks
};

struct DenseSettings {
  DenseStrategy strategy = DenseStrategy::best;
};

/// The field of a decoded scan made to be asked between its rows and columns. On its own cells it
/// says what the field says. Between them a surface is interpolated from the returns of the two
/// rings that are above and below as seen from where the line of sight starts, planes exactly;
/// where the two rings saw different surfaces one of them is chosen, never a place between; where
/// neither saw any, there is nothing. O(cells) to make, about 1 us a line of sight.
std::shared_ptr<const Field> dense_field(std::shared_ptr<const Field> field,
                                         const DenseSettings& settings = {});

}  // namespace curlidar
