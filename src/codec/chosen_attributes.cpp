// SPDX-License-Identifier: BSD-3-Clause
#include "codec/chosen_attributes.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/try.hpp"
#include "format/attributes_chunk.hpp"
#include "format/metadata_chunk.hpp"

namespace curlidar {

Result<std::vector<Attribute>> choose_attributes(
    const Cloud& cloud, const std::optional<std::vector<std::string>>& names) {
  if (!names) return cloud.attributes;
  std::vector<Attribute> chosen;
  for (const std::string& name : *names) {
    const Attribute* attribute = cloud.find(name);
    if (attribute == nullptr) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("the cloud has no attribute '{}' to keep", name)};
    }
    chosen.push_back(*attribute);
  }
  return chosen;
}

Status add_attributes(const Cloud& cloud, const std::optional<std::vector<std::string>>& names,
                      const std::vector<std::uint32_t>& coded, ContainerWriter& writer) {
  Cloud chosen;
  chosen.positions = cloud.positions;
  CURLIDAR_TRY_ASSIGN(attributes, choose_attributes(cloud, names));
  chosen.attributes = std::move(attributes);
  if (chosen.attributes.empty()) return {};
  CURLIDAR_TRY_ASSIGN(payload, write_attributes(select(chosen, coded).attributes, coded.size()));
  writer.add(ChunkType::attributes, payload);
  return {};
}

Result<std::vector<std::byte>> metadata_payload(
    const std::map<std::string, std::string>& metadata) {
  if (metadata.empty()) return std::vector<std::byte>{};
  return write_metadata(metadata);
}

Status add_metadata(const std::map<std::string, std::string>& metadata, ContainerWriter& writer) {
  CURLIDAR_TRY_ASSIGN(payload, metadata_payload(metadata));
  if (!payload.empty()) writer.add(ChunkType::metadata, payload);
  return {};
}

}  // namespace curlidar
