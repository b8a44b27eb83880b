// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace curlidar {

/// Whether `text` is well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, nothing
/// above U+10FFFF). The empty text is.
bool is_utf8(std::string_view text);

}  // namespace curlidar
