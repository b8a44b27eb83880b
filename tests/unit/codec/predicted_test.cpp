// SPDX-License-Identifier: BSD-3-Clause
// Scans that are coded from the scan before: they come back, they are smaller, and without the scan
// before they are refused.
#include "codec/predicted.hpp"

#include <gtest/gtest.h>

#include "support/scans.hpp"
#include "support/sequences.hpp"

namespace curlidar {
namespace {

EncodeSettings settings_of(double step_m = 0.2) {
  EncodeSettings settings = test::drive_settings(2).encode;
  settings.compact.target_value = step_m;
  return settings;
}

std::shared_ptr<const PredictionReference> reference_of(const std::vector<std::byte>& bytes) {
  const auto scan = decode(bytes);
  EXPECT_TRUE(scan);
  return PredictionReference::of(*scan).value();
}

Result<DecodedScan> decode_with(std::span<const std::byte> bytes,
                                const std::shared_ptr<const PredictionReference>& reference) {
  DecodeOptions options;
  options.reference = reference;
  return decode(bytes, options);
}

TEST(Predicted, ScansComeBackAndAreSmaller) {
  const auto clouds = test::drive(2, 0.3);
  const auto first = encode(clouds[0], settings_of());
  const auto alone = encode(clouds[1], settings_of());
  ASSERT_TRUE(first && alone);
  const auto reference = reference_of(first->bytes);
  const auto predicted = encode_predicted(clouds[1], settings_of(), reference);
  ASSERT_TRUE(predicted) << predicted.error().message;
  EXPECT_LT(predicted->bytes.size(), alone->bytes.size());
  const auto back = decode_with(predicted->bytes, reference);
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_TRUE(back->cloud);
  ASSERT_EQ(back->cloud->size(), clouds[1].size());
  double sum = 0;
  for (std::size_t i = 0; i < clouds[1].size(); ++i) {
    sum += norm(back->cloud->positions[i] - clouds[1].positions[i]);
  }
  EXPECT_NEAR(sum / static_cast<double>(clouds[1].size()), predicted->report.compact->mean_error_m,
              1e-12);
}

TEST(Predicted, OfAPredictedScanTheNextOneIsPredicted) {
  const auto clouds = test::drive(4, 0.2);
  auto reference = reference_of(encode(clouds[0], settings_of())->bytes);
  for (std::size_t i = 1; i < clouds.size(); ++i) {
    const auto predicted = encode_predicted(clouds[i], settings_of(), reference);
    ASSERT_TRUE(predicted) << predicted.error().message;
    const auto back = decode_with(predicted->bytes, reference);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->cloud->size(), clouds[i].size());
    reference = PredictionReference::of(*back).value();
  }
}

TEST(Predicted, AStillSensorSavesMost) {
  const Cloud before = test::scan_of(test::small_sensor(16, 192), 0, 1);
  const Cloud now = test::scan_of(test::small_sensor(16, 192), 0, 2);
  const auto reference = reference_of(encode(before, settings_of())->bytes);
  const auto alone = encode(now, settings_of());
  const auto still = encode_predicted(now, settings_of(), reference, {true, {}});
  ASSERT_TRUE(alone && still);
  EXPECT_LT(10 * still->bytes.size(), 8 * alone->bytes.size());
  EXPECT_TRUE(decode_with(still->bytes, reference));
}

TEST(Predicted, AnyGuessDecodesToTheSamePromise) {
  const auto clouds = test::drive(2, 0.3);
  const auto reference = reference_of(encode(clouds[0], settings_of())->bytes);
  RigidMotion wrong = test::some_pose(3);
  for (const PredictionGuess& guess :
       {PredictionGuess{true, {}}, PredictionGuess{false, wrong}, PredictionGuess{}}) {
    const auto predicted = encode_predicted(clouds[1], settings_of(), reference, guess);
    ASSERT_TRUE(predicted) << predicted.error().message;
    const auto back = decode_with(predicted->bytes, reference);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->cloud->size(), clouds[1].size());
  }
}

TEST(Predicted, ResidualsAndExactScansComeBack) {
  const auto clouds = test::drive(2, 0.2);
  EncodeSettings settings = settings_of();
  for (const CompactTarget target : {CompactTarget::error, CompactTarget::lossless}) {
    settings.compact.target = target;
    settings.compact.target_value = 0.01;
    const auto reference = reference_of(encode(clouds[0], settings)->bytes);
    const auto predicted = encode_predicted(clouds[1], settings, reference);
    ASSERT_TRUE(predicted) << predicted.error().message;
    const auto back = decode_with(predicted->bytes, reference);
    ASSERT_TRUE(back) << back.error().message;
    if (target != CompactTarget::lossless) continue;
    EXPECT_EQ(back->cloud->positions, clouds[1].positions);
  }
}

TEST(Predicted, SameBytesForAnyNumberOfThreads) {
  const auto clouds = test::drive(2);
  EncodeSettings settings = settings_of();
  settings.compact.sectors = 3;
  const auto reference = reference_of(encode(clouds[0], settings)->bytes);
  const auto one = encode_predicted(clouds[1], settings, reference);
  settings.threads = 3;
  const auto three = encode_predicted(clouds[1], settings, reference);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->bytes, three->bytes);
}

TEST(Predicted, WithoutTheScanBeforeItIsRefused) {
  const auto clouds = test::drive(3);
  const auto reference = reference_of(encode(clouds[0], settings_of())->bytes);
  const auto predicted = encode_predicted(clouds[1], settings_of(), reference);
  ASSERT_TRUE(predicted);
  const auto alone = decode(predicted->bytes);
  ASSERT_FALSE(alone);
  EXPECT_NE(alone.error().message.find("predicted from another"), std::string::npos);
  const auto other = reference_of(encode(clouds[2], settings_of())->bytes);
  EXPECT_EQ(decode_with(predicted->bytes, other).error().code, ErrorCode::corrupt);
}

TEST(Predicted, DamagedBytesDecodeToSomethingOrAnError) {
  const auto clouds = test::drive(2);
  const auto reference = reference_of(encode(clouds[0], settings_of())->bytes);
  const auto predicted = encode_predicted(clouds[1], settings_of(), reference);
  ASSERT_TRUE(predicted);
  std::size_t refused = 0;
  for (std::size_t at = 8; at < predicted->bytes.size(); at += 37) {
    std::vector<std::byte> bytes = predicted->bytes;
    bytes[at] ^= std::byte{0x41};
    if (!decode_with(bytes, reference)) ++refused;
    DecodeOptions options;
    options.reference = reference;
    options.allow_truncated = true;
    (void)decode(std::span(predicted->bytes).first(at), options);
  }
  EXPECT_GT(refused, 0u);
}

}  // namespace
}  // namespace curlidar
