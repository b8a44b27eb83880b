// SPDX-License-Identifier: BSD-3-Clause
// What a file with every return means, as JSON: the twin of a golden file.
#pragma once

#include <array>
#include <bit>
#include <string>

#include "curlidar/codec.hpp"
#include "golden/records_twin.hpp"

namespace curlidar::test {

/// Sixteen digits for each coordinate: its bits as a double.
inline std::string hex_of(const Vec3& p) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text;
  for (const double x : {p.x, p.y, p.z}) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    for (int shift = 60; shift >= 0; shift -= 4) text += digits[bits >> shift & 15];
  }
  return text;
}

/// Of a decoded file with every return. `bound`: metres, 0 for bit for bit, null if nothing is
/// promised.
inline Json twin_of(const DecodedScan& scan) {
  const Cloud& cloud = *scan.cloud;
  Json slots = Json::array();
  for (const Vec3& p : cloud.positions) slots.push_back(hex_of(p));
  const RecordPromise& promise = scan.records->promise;
  const bool promises = promise.bit_exact || promise.bound_m > 0;
  return {{"width", cloud.width},
          {"height", cloud.height},
          {"type", static_cast<int>(cloud.position_type)},
          {"bound", promises ? Json(promise.bound_m) : Json()},
          {"lattice", to_string(scan.records->lattice)},
          {"slots", slots},
          {"attributes", json_of(cloud.attributes)}};
}

}  // namespace curlidar::test
