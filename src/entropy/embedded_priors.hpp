// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace curlidar {

/// The text of docs/format/priors/NAME.txt, as apply_priors takes it; empty if there is none.
std::string_view embedded_priors(std::string_view name);

}  // namespace curlidar
