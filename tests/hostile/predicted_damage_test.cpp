// SPDX-License-Identifier: BSD-3-Clause
// Damaged chunks of predicted scans decode to something or to an error.
#include <gtest/gtest.h>

#include "compact/prediction.hpp"
#include "hostile/targets/predicted.hpp"

namespace curlidar {
namespace {

/// The chunks of a scan predicted from the street, as the target reads them.
std::vector<std::byte> predicted_input(bool residuals) {
  using namespace compact;
  const DecodedScan& reference = test::reference_street();
  const test::CompactScan street = test::integer_street(12, 48, 2000);
  PredictionHeader header;
  header.pose.move = {300, -20, 5};
  header.same_rows = true;
  header.reference = fingerprint_of(reference);
  const Prediction prediction = predict(reference, header.pose, reference.table, 12, 48);
  ScanSettings settings = test::street_settings();
  if (residuals) settings.steps.residual_step = settings.steps.step;
  settings.prediction = &prediction;
  settings.header = &header;
  const auto encoded = encode_scan(street.image, reference.table, settings);
  EXPECT_TRUE(encoded);
  std::vector<std::byte> out{std::byte{test::kNodes}};
  for (const ScanChunk& chunk : encoded->chunks) {
    test::write_fuzz_chunk(static_cast<std::uint8_t>(static_cast<int>(chunk.part) - 0x10),
                           chunk.payload, out);
  }
  return out;
}

TEST(PredictedDamage, ChangedBytesAndCuts) {
  for (const bool residuals : {false, true}) {
    const std::vector<std::byte> input = predicted_input(residuals);
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
