// SPDX-License-Identifier: BSD-3-Clause
// What the target of predicted scans starts from.
#pragma once

#include <vector>

#include "compact/prediction.hpp"
#include "hostile/targets/predicted.hpp"

namespace curlidar::test {

/// The chunks of a scan predicted from the street, as the target reads them.
inline std::vector<std::byte> predicted_input(bool residuals) {
  using namespace compact;
  const compact::DecodedScan& reference = reference_street();
  const CompactScan street = integer_street(12, 48, 2000);
  PredictionHeader header;
  header.pose.move = {300, -20, 5};
  header.same_rows = true;
  header.reference = fingerprint_of(reference);
  const Prediction prediction = predict(reference, header.pose, reference.table, 12, 48);
  ScanSettings settings = street_settings();
  if (residuals) settings.steps.residual_step = settings.steps.step;
  settings.prediction = &prediction;
  settings.header = &header;
  const auto encoded = encode_scan(street.image, reference.table, settings).value();
  std::vector<std::byte> out{std::byte{kNodes}};
  for (const ScanChunk& chunk : encoded.chunks) {
    write_fuzz_chunk(static_cast<std::uint8_t>(static_cast<int>(chunk.part) - 0x10), chunk.payload,
                     out);
  }
  return out;
}

}  // namespace curlidar::test
