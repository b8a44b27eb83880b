// SPDX-License-Identifier: BSD-3-Clause
// Texts of density profiles: read, and asked along lines of sight.
#pragma once

#include <string>
#include <string_view>

#include "hostile/targets/input.hpp"
#include "support/density.hpp"

namespace curlidar::test {

/// The input is the text. What can be read must be valid, be written and read again as it is, and
/// never make a field of the world of tests/support/density.hpp say what no field may.
inline std::string density_target(ByteSpan bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto profile = parse_density_profile(text, "text");
  if (!profile) return profile.error().message.empty() ? "an error without a message" : "";
  if (!validate(*profile)) return "read, and yet not valid";
  const auto again = parse_density_profile(density_profile_text(*profile), "text");
  if (!again || !(*again == *profile)) return "not written as it was read";
  return fault_with(*profile);
}

}  // namespace curlidar::test
