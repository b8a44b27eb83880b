// SPDX-License-Identifier: BSD-3-Clause
// Golden chunks of order and attributes: payloads, the grid they belong to, what they decode to.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hostile/targets/records.hpp"
#include "records/attributes.hpp"
#include "records/order.hpp"

namespace curlidar::test {

using Json = nlohmann::ordered_json;

inline std::string hex_of(const std::vector<std::byte>& bytes) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text;
  for (const std::byte byte : bytes) {
    text += digits[static_cast<unsigned>(byte) >> 4];
    text += digits[static_cast<unsigned>(byte) & 15];
  }
  return text;
}
inline std::vector<std::byte> bytes_of_hex(const std::string& text) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// A grid that owns what its twin says.
struct TwinGrid {
  std::uint32_t rows = 0, columns = 0;
  std::size_t loose = 0;
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges, shift;

  RecordGeometry geometry() const { return {{rows, columns, occupied, loose}, ranges, shift}; }

  Json to_json() const {
    Json cells = Json::array();
    for (std::uint32_t row = 0; row < rows; ++row) {
      std::string flags;
      for (std::uint32_t j = 0; j < columns; ++j) {
        flags += occupied[row * columns + j] != 0 ? '1' : '0';
      }
      cells.push_back(flags);
    }
    return {{"columns", columns},
            {"loose", loose},
            {"occupied", cells},
            {"range", ranges},
            {"column_shift", shift}};
  }
  explicit TwinGrid(const Json& twin)
      : rows(static_cast<std::uint32_t>(twin["occupied"].size())),
        columns(twin["columns"]),
        loose(twin["loose"]),
        ranges(twin["range"]),
        shift(twin["column_shift"]) {
    for (const std::string flags : twin["occupied"]) {
      for (const char flag : flags) occupied.push_back(flag == '1' ? 1 : 0);
    }
  }
  TwinGrid() = default;
};

inline Json json_of(const CloudOrder& order) {
  std::string kinds;
  for (const SlotKind kind : order.kind) {
    kinds += static_cast<char>('0' + static_cast<int>(kind));
  }
  return {{"width", order.width}, {"height", order.height}, {"type", static_cast<int>(order.type)},
          {"kinds", kinds},       {"record", order.record}, {"odd", order.odd}};
}

inline Json json_of(const std::vector<Attribute>& attributes) {
  Json list = Json::array();
  for (const Attribute& attribute : attributes) {
    list.push_back({{"name", attribute.name},
                    {"type", static_cast<int>(type_of(attribute.values))},
                    {"components", attribute.components},
                    {"bits", bits_of(attribute.values)}});
  }
  return list;
}

}  // namespace curlidar::test
