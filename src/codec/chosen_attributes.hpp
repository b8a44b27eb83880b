// SPDX-License-Identifier: BSD-3-Clause
// Attributes and metadata on their way into a file, the same for every profile.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"
#include "format/container.hpp"

namespace curlidar {

/// The attributes with these names; nullopt = all. invalid_argument if the cloud lacks one.
Result<std::vector<Attribute>> choose_attributes(
    const Cloud& cloud, const std::optional<std::vector<std::string>>& names);

/// Adds the attributes of the points `coded`, in that order, and the cloud's metadata, where there
/// are any. `names`: nullopt = all attributes. invalid_argument if the cloud lacks one.
Status add_attributes(const Cloud& cloud, const std::optional<std::vector<std::string>>& names,
                      const std::vector<std::uint32_t>& coded, ContainerWriter& writer);
/// The payload of the metadata chunk; empty if there are none.
Result<std::vector<std::byte>> metadata_payload(const std::map<std::string, std::string>& metadata);
Status add_metadata(const std::map<std::string, std::string>& metadata, ContainerWriter& writer);

}  // namespace curlidar
