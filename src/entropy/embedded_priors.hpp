// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "base/embedded.hpp"

namespace curlidar {

/// All files of docs/format/priors, sorted by name.
std::span<const EmbeddedText> embedded_priors();

/// The text of docs/format/priors/NAME.txt, as apply_priors takes it; empty if there is none.
inline std::string_view embedded_priors(std::string_view name) {
  return text_named(embedded_priors(), name);
}

}  // namespace curlidar
