// SPDX-License-Identifier: BSD-3-Clause
// What every machine computes alike, a line for each part of decoding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "compact/scan_decoder.hpp"
#include "compact/scan_header.hpp"
#include "compact/scan_points.hpp"
#include "cross/digest.hpp"
#include "entropy/model.hpp"
#include "fixed/fixed.hpp"
#include "format/container.hpp"
#include "support/compact_files.hpp"

namespace curlidar::test {

inline void digest_angles() {
  Digest sines, radians;
  for (std::uint64_t angle = 0; angle < std::uint64_t{1} << 32; angle += 20011) {
    const SinCos found = sin_cos_q30(static_cast<std::uint32_t>(angle));
    sines.add(found.sin);
    sines.add(found.cos);
    radians.add(radians_from_angle(static_cast<std::int32_t>(static_cast<std::uint32_t>(angle))));
  }
  sines.print("fixed.sin_cos");
  radians.print("fixed.radians");
}

inline void digest_arithmetic() {
  Digest products, portable, quotients, roots;
  Numbers numbers;
  for (int i = 0; i < 200000; ++i) {
    const std::int64_t a = numbers.next_of_any_size();
    const std::int64_t b = numbers.next_of_any_size();
    const unsigned shift = numbers.next32() % 130;
    products.add(mul_shift(a, b, shift));
    portable.add(mul_shift_portable(a, b, shift));
    quotients.add(div_floor(a, b));
    quotients.add(div_round(a, b));
    quotients.add(shift_right_round(a, shift / 2));
    roots.add(isqrt(static_cast<std::uint64_t>(a)));
  }
  products.print("fixed.mul_shift");
  portable.print("fixed.mul_shift_portable");
  quotients.print("fixed.div");
  roots.print("fixed.isqrt");
}

/// Bits that adaptive models and their mix read from bytes that mean nothing.
inline void digest_entropy_decoding() {
  Numbers numbers;
  std::vector<std::byte> bytes(20000);
  for (std::byte& b : bytes) b = static_cast<std::byte>(numbers.next32() & 0xff);
  RangeDecoder decoder(bytes);
  std::array<BitModel, 256> first{}, second{};
  MixWeights<2> weights;
  Digest digest;
  std::uint32_t history = 1;
  while (!decoder.exhausted()) {
    const std::array<BitModel*, 2> models{&first[history & 255], &second[(history >> 4) & 15]};
    const bool bit = code_bit(decoder, models, weights, 20, 255, false);
    history = history << 1 | (bit ? 1 : 0);
    digest.add(history);
  }
  digest.print("entropy.decode");
}

/// The chunks of a file, or the reason against it.
inline void digest_container(Digest& digest, ByteSpan file) {
  const auto container = read_container_prefix(file);
  if (!container) {
    digest.add(std::as_bytes(std::span(container.error().message)));
    return;
  }
  for (const Chunk& chunk : container->chunks) {
    digest.add(static_cast<std::uint32_t>(chunk.type));
    digest.add(chunk.payload);
  }
  if (container->torn) digest.add(container->torn->payload);
}

/// Everything that a scan decodes to, or the reason against it.
inline void digest_scan(Digest& digest, const Result<compact::DecodedScan>& scan) {
  if (!scan) {
    digest.add(std::as_bytes(std::span(scan.error().message)));
    return;
  }
  for (const compact::Missing& missing : scan->missing) {
    const std::string name = to_string(missing);
    digest.add(std::as_bytes(std::span(name)));
  }
  const compact::ScanParameters& p = scan->parameters;
  const compact::PointTable points(scan->table, p.rows, p.columns);
  for (std::uint32_t row = 0; row < p.rows; ++row) {
    for (std::uint32_t column = 0; column < p.columns; ++column) {
      const std::size_t cell = std::size_t{row} * p.columns + column;
      for (const auto* plane : {&scan->range, &scan->field_range, &scan->surface, &scan->leaf}) {
        digest.add((*plane)[cell]);
      }
      if (scan->range[cell] == 0) continue;
      const Vec3 point = points.metres(row, column, scan->range[cell]);
      digest.add(point.x);
      digest.add(point.y);
      digest.add(point.z);
    }
  }
}

/// The scan of a file that may hold one.
inline void digest_scan_file(Digest& digest, ByteSpan file) {
  const auto container = read_container_prefix(file);
  if (container) digest_scan(digest, compact::decode_scan(chunks_of(*container)));
}

/// A scan whose masks, fields and residuals are bytes that mean nothing: any bytes decode to
/// something, and these to all that there is.
inline void digest_scan_decoding() {
  using compact::ScanPart;
  compact::ScanParameters parameters;
  parameters.rows = 24;
  parameters.columns = 250;
  parameters.step = 6554;
  parameters.residual_step = 1311;
  parameters.sectors = 2;
  compact::RowTable table;
  table.turn_columns = 256;
  table.first_column = 100;
  Numbers numbers;
  for (std::int32_t row = 0; row < 24; ++row) {
    table.elevation.push_back((1 << 26) - row * (1 << 23));
    table.height.push_back(static_cast<std::int32_t>(numbers.next32() % 9000) - 3000);
    table.range_offset.push_back(static_cast<std::int32_t>(numbers.next32() % 9000) - 3000);
  }
  for (int round = 0; round < 6; ++round) {
    if (round == 3) {
      parameters.lattice_q32 = std::uint64_t{1} << 24;
      parameters.residual_step = 256;
    }
    std::vector<compact::ScanChunk> chunks;
    chunks.push_back({ScanPart::parameters, compact::write_parameters(parameters, table)});
    chunks.push_back({ScanPart::sensor, compact::write_rows(table)});
    for (const ScanPart part : {ScanPart::mask, ScanPart::field, ScanPart::residual}) {
      for (int segment = 0; segment < 2; ++segment) {
        std::vector<std::byte> payload(part == ScanPart::residual ? 20000 : 8000);
        for (std::byte& b : payload) b = static_cast<std::byte>(numbers.next32() & 0xff);
        payload[0] = std::byte{100};
        chunks.push_back({part, std::move(payload)});
      }
    }
    Digest digest;
    digest_scan_file(digest, file_of(chunks));
    digest.print("scan.decode");
  }
}

inline std::vector<std::byte> sample_container() {
  Numbers numbers;
  ContainerWriter writer;
  for (const ChunkType type : {ChunkType::compact_parameters, ChunkType::compact_mask}) {
    std::vector<std::byte> payload(numbers.next32() % 500);
    for (std::byte& b : payload) b = static_cast<std::byte>(numbers.next32() & 0xff);
    writer.add(type, payload);
  }
  return std::move(writer).finish();
}

inline void digest_container_decoding() {
  const std::vector<std::byte> file = sample_container();
  Digest digest;
  for (std::size_t size = 0; size <= file.size(); ++size) {
    digest_container(digest, ByteSpan(file).first(size));
  }
  digest.print("container.read");
}

/// Everything that needs no file.
inline void digest_decoding() {
  digest_angles();
  digest_arithmetic();
  digest_entropy_decoding();
  digest_container_decoding();
  digest_scan_decoding();
}

}  // namespace curlidar::test
