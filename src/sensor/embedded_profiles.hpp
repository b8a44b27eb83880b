// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "base/embedded.hpp"

namespace curlidar {

/// The TOML texts of all built-in sensors, profiles/*.toml, sorted by name.
std::span<const EmbeddedText> embedded_profiles();

}  // namespace curlidar
