// SPDX-License-Identifier: BSD-3-Clause
#include "codec/chosen_attributes.hpp"

#include <fmt/format.h>

#include "base/try.hpp"
#include "format/attributes_chunk.hpp"
#include "format/metadata_chunk.hpp"

namespace curlidar {

Status add_attributes(const Cloud& cloud, const std::optional<std::vector<std::string>>& names,
                      const std::vector<std::uint32_t>& coded, ContainerWriter& writer) {
  Cloud chosen;
  chosen.positions = cloud.positions;
  if (!names) chosen.attributes = cloud.attributes;
  for (const std::string& name : names.value_or(std::vector<std::string>{})) {
    const Attribute* attribute = cloud.find(name);
    if (attribute == nullptr) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("the cloud has no attribute '{}' to keep", name)};
    }
    chosen.attributes.push_back(*attribute);
  }
  if (chosen.attributes.empty()) return {};
  CURLIDAR_TRY_ASSIGN(payload, write_attributes(select(chosen, coded).attributes, coded.size()));
  writer.add(ChunkType::attributes, payload);
  return {};
}

Status add_metadata(const std::map<std::string, std::string>& metadata, ContainerWriter& writer) {
  if (metadata.empty()) return {};
  CURLIDAR_TRY_ASSIGN(payload, write_metadata(metadata));
  writer.add(ChunkType::metadata, payload);
  return {};
}

}  // namespace curlidar
