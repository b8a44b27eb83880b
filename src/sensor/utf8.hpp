// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace curlidar {

/// UTF-8 text with every character beyond ASCII written as \uXXXX or \UXXXXXXXX; nothing if the
/// text is not UTF-8.
std::optional<std::string> escape_non_ascii(std::string_view text);

}  // namespace curlidar
