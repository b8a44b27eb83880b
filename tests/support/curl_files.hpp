// SPDX-License-Identifier: BSD-3-Clause
// A file with every plain chunk, and a reader of every plain chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/try.hpp"
#include "format/attributes_chunk.hpp"
#include "format/container.hpp"
#include "format/metadata_chunk.hpp"
#include "format/packed.hpp"
#include "format/parameters_chunk.hpp"
#include "format/sensor_chunk.hpp"

namespace curlidar::test {

inline constexpr std::uint64_t kReturns = 40;
inline constexpr std::uint64_t kCells = 77;
inline constexpr std::uint64_t kMaxBytes = 1u << 16;

/// The plain readers' answer to one chunk, whatever it is.
inline Status read_chunk(const Chunk& chunk) {
  switch (chunk.type) {
    case ChunkType::sensor:
      CURLIDAR_TRY(read_sensor(chunk));
      return {};
    case ChunkType::parameters:
      CURLIDAR_TRY(read_parameters(chunk));
      return {};
    case ChunkType::attributes:
      CURLIDAR_TRY(read_attributes(chunk, kReturns, kMaxBytes));
      return {};
    case ChunkType::metadata:
      CURLIDAR_TRY(read_metadata(chunk));
      return {};
    case ChunkType::point_grid: {
      PayloadReader reader(chunk);
      CURLIDAR_TRY(unpack_bits(reader, "grid", kCells));
      return reader.finish();
    }
    case ChunkType::patches: {
      PayloadReader reader(chunk);
      CURLIDAR_TRY(unpack(reader, "block", kMaxBytes));
      return reader.finish();
    }
    default:
      return {};
  }
}

inline Status read_all_chunks(ByteSpan file) {
  CURLIDAR_TRY_ASSIGN(chunks, read_container(file));
  for (const Chunk& chunk : chunks) CURLIDAR_TRY(read_chunk(chunk));
  return {};
}

/// A sensor of three rings.
inline SensorProfile three_ring_sensor() {
  SensorProfile sensor;
  sensor.name = "small";
  sensor.description = "three rings";
  for (int i = 0; i < 3; ++i) sensor.rings.push_back({0.1 - 0.1 * i, 0, 0, 0});
  sensor.columns = 90;
  sensor.fov_up = 0.2;
  sensor.fov_down = -0.2;
  return sensor;
}

/// A valid file of about 600 bytes with every type that read_chunk reads, and an unknown ancillary
/// chunk.
inline std::vector<std::byte> whole_file() {
  std::vector<std::uint8_t> cells(kCells);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = i % 3 == 0 ? 1 : 0;
  std::vector<float> intensity(kReturns);
  std::vector<std::uint16_t> colour(kReturns * 3);
  for (std::size_t i = 0; i < intensity.size(); ++i) intensity[i] = static_cast<float>(i) / 8;
  for (std::size_t i = 0; i < colour.size(); ++i) colour[i] = static_cast<std::uint16_t>(i * i);
  ContainerWriter writer;
  writer.add(ChunkType::sensor, *write_sensor(three_ring_sensor()));
  writer.add(ChunkType::parameters, write_parameters({}));
  writer.add(ChunkType::point_grid, pack_bits(cells));
  writer.add(ChunkType::patches, pack(std::vector<std::byte>(5000, std::byte{3})));
  writer.add(ChunkType::attributes,
             *write_attributes({{"intensity", 1, intensity}, {"colour", 3, colour}}, kReturns));
  writer.add(ChunkType::metadata,
             *write_metadata({{"frame_id", "lidar"}, {"note", "gr\xc3\xbcn"}}));
  writer.add(static_cast<ChunkType>(0xf1), std::vector<std::byte>(9));
  return std::move(writer).finish();
}

}  // namespace curlidar::test
