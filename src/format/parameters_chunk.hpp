// SPDX-License-Identifier: BSD-3-Clause
// The parameters chunk: the profile that made the field, and its settings.
#pragma once

#include <cstddef>
#include <vector>

#include "curlidar/result.hpp"
#include "curlidar/settings.hpp"
#include "format/container.hpp"

namespace curlidar {

struct Parameters {
  Profile profile = Profile::paper;
  PaperSettings paper;
};

/// The payload for the parameters, every number exactly as it is. Numbers must be finite.
std::vector<std::byte> write_parameters(const Parameters& parameters);
/// Checks that names are known, flags are 0 or 1 and numbers finite; whether the settings make
/// sense together is for the profile to tell.
Result<Parameters> read_parameters(const Chunk& chunk);

}  // namespace curlidar
