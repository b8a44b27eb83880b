// SPDX-License-Identifier: BSD-3-Clause
// encode_digest: prints digests of what encoding writes, and of what decoding computes, for
// comparison between compilers and their optimisation.
#include "cross/decode_sections.hpp"
#include "support/compact_scans.hpp"

namespace curlidar::test {
namespace {

/// Bits of a source with memory, coded with adaptive models and their mix.
void digest_entropy_encoding() {
  Numbers numbers;
  RangeEncoder encoder;
  std::array<BitModel, 256> first{}, second{};
  MixWeights<2> weights;
  std::uint32_t history = 1;
  for (int i = 0; i < 100000; ++i) {
    const std::array<BitModel*, 2> models{&first[history & 255], &second[(history >> 4) & 15]};
    const bool bit = numbers.next32() % 8 < (history & 7);
    code_bit(encoder, models, weights, 20, 255, bit);
    history = history << 1 | (bit ? 1 : 0);
  }
  Digest digest;
  digest.add(std::move(encoder).finish());
  digest.print("entropy.encode");
}

void digest_container_encoding() {
  Digest digest;
  digest.add(sample_container());
  digest.print("container.write");
}

/// A street at several efforts and in all three regimes of steps.
void digest_scan_encoding() {
  const CompactScan scan = integer_street(24, 144);
  for (const std::uint32_t effort : {1u, 4u, 9u}) {
    for (const std::int64_t error_mm : {50, 15, 2}) {
      compact::ScanSettings settings;
      settings.steps = compact::steps_for_error(error_mm * compact::kRangeUnit / 1000);
      settings.effort = effort;
      settings.sectors = 2;
      const auto written = compact::encode_scan(scan.image, scan.table, settings);
      Digest digest;
      if (written) {
        for (const compact::ScanChunk& chunk : written->chunks) digest.add(chunk.payload);
        digest_scan_file(digest, file_of(written->chunks));
      }
      digest.print("scan.encode");
    }
  }
}

}  // namespace
}  // namespace curlidar::test

int main() {
  curlidar::test::digest_entropy_encoding();
  curlidar::test::digest_container_encoding();
  curlidar::test::digest_scan_encoding();
  curlidar::test::digest_decoding();
  return 0;
}
