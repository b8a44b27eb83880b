// SPDX-License-Identifier: BSD-3-Clause
// predicted_tool FOLDER: writes a street, three scans each predicted from the one before, and what
// they decode to.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "compact/prediction_chunk.hpp"
#include "compact/scan_encoder.hpp"
#include "format/container.hpp"
#include "support/compact_scans.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::compact;

ScanSettings settings_of(std::uint32_t number) {
  ScanSettings settings;
  settings.steps = steps_for_step(kRangeUnit / 4);
  if (number >= 2) settings.steps.residual_step = settings.steps.step;
  settings.effort = 3;
  settings.sectors = number == 3 ? 2 : 1;
  settings.bands = 1;
  settings.index = false;
  return settings;
}

void write(const std::string& path, const std::vector<ScanChunk>& chunks, const DecodedScan& scan) {
  ContainerWriter writer;
  for (const ScanChunk& chunk : chunks)
    writer.add(static_cast<ChunkType>(chunk.part), chunk.payload);
  const std::vector<std::byte> bytes = std::move(writer).finish();
  std::ofstream(path + ".curl", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  nlohmann::json twin;
  twin["rows"] = scan.parameters.rows;
  twin["columns"] = scan.parameters.columns;
  twin["range"] = scan.range;
  twin["field"] = scan.field_range;
  std::ofstream(path + ".json") << twin.dump() << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: predicted_tool FOLDER\n", stderr);
    return 2;
  }
  DecodedScan before;
  for (std::uint32_t number = 0; number < 4; ++number) {
    const test::CompactScan street = test::integer_street(12, 72, 400 + 300 * number);
    ScanSettings settings = settings_of(number);
    PredictionHeader header;
    Prediction prediction;
    if (number > 0) {
      header.pose.turn = {100, -300, 4000 * static_cast<std::int32_t>(number)};
      header.pose.move = {-200, 40, 7};
      header.same_rows = number == 1;
      header.reference = fingerprint_of(before);
      prediction = predict(before, header.pose, street.table, 12, 72);
      settings.prediction = &prediction;
      settings.header = &header;
    }
    const auto encoded = encode_scan(street.image, street.table, settings);
    if (!encoded) return 1;
    ScanOptions options;
    options.reference = &before;
    auto decoded = decode_scan(test::views_of(encoded->chunks), {}, options);
    if (!decoded) return 1;
    const std::string folder = argv[1];
    write(folder + "/street-" + std::to_string(number), encoded->chunks, *decoded);
    before = *std::move(decoded);
  }
  return 0;
}
