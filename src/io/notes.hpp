// SPDX-License-Identifier: BSD-3-Clause
// Metadata in the comment lines of text headers: "curlidar metadata KEY VALUE".
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace curlidar::io {

using Metadata = std::map<std::string, std::string>;

/// One comment text for each entry. Blanks, '%' and control characters are written %XX, so that
/// any bytes survive.
std::vector<std::string> metadata_notes(const Metadata& metadata);

/// Takes an entry from a comment (its text after the format's comment mark). Comments of others
/// are left alone: false.
bool read_metadata_note(std::string_view comment, Metadata& metadata);

}  // namespace curlidar::io
