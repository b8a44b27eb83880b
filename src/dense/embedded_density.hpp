// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "base/embedded.hpp"

namespace curlidar {

/// The TOML texts of the built-in density profiles, profiles/density/*.toml, sorted by name.
std::span<const EmbeddedText> embedded_density();

}  // namespace curlidar
