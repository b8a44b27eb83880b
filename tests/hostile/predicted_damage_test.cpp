// SPDX-License-Identifier: BSD-3-Clause
// Damaged chunks of predicted scans decode to something or to an error.
#include <gtest/gtest.h>

#include "support/predicted_inputs.hpp"

namespace curlidar {
namespace {

TEST(PredictedDamage, ChangedBytesAndCuts) {
  for (const bool residuals : {false, true}) {
    const std::vector<std::byte> input = test::predicted_input(residuals);
    ASSERT_EQ(test::predicted_target(input), "");
    for (std::size_t at = 0; at < input.size(); at += 3) {
      for (const int change : {0x01, 0x80, 0xff}) {
        std::vector<std::byte> damaged = input;
        damaged[at] ^= static_cast<std::byte>(change);
        ASSERT_EQ(test::predicted_target(damaged), "") << at << " " << change;
      }
      std::vector<std::byte> cut(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(at));
      if (!cut.empty()) cut[0] |= std::byte{test::kIncomplete | test::kTorn};
      ASSERT_EQ(test::predicted_target(cut), "") << at;
    }
  }
}

}  // namespace
}  // namespace curlidar
