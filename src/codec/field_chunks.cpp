// SPDX-License-Identifier: BSD-3-Clause
#include "codec/field_chunks.hpp"

#include <cmath>

#include "base/try.hpp"
#include "format/packed.hpp"
#include "format/payload.hpp"
#include "paper/patches.hpp"

namespace curlidar {
namespace {

template <class T>
std::vector<std::byte> pack_numbers(const std::vector<T>& numbers) {
  ByteWriter raw;
  for (const T v : numbers) raw.write(v);
  return pack(split_planes(raw.bytes(), sizeof(T)));
}

template <class T>
Result<std::vector<T>> unpack_numbers(PayloadReader& reader, std::string_view what,
                                      std::uint64_t count) {
  CURLIDAR_TRY_ASSIGN(planes, unpack_exactly(reader, what, count * sizeof(T)));
  const std::vector<std::byte> raw = join_planes(planes, sizeof(T));
  std::vector<T> numbers;
  numbers.reserve(raw.size() / sizeof(T));
  for (std::size_t at = 0; at < raw.size(); at += sizeof(T)) {
    numbers.push_back(load_little_endian<T>(raw.data() + at));
  }
  return numbers;
}

}  // namespace

void write_masks(const CellMasks& masks, ContainerWriter& writer) {
  writer.add(ChunkType::point_grid, pack_bits(masks.point));
  ByteWriter cliffs;
  for (const auto* mask : {&masks.cliff_row, &masks.cliff_column, &masks.cliff_diagonal}) {
    cliffs.write_bytes(pack_bits(*mask));
  }
  writer.add(ChunkType::cliffs, cliffs.bytes());
}

Result<CellMasks> read_masks(const std::vector<Chunk>& chunks, const Lattice& lattice) {
  CURLIDAR_TRY_ASSIGN(grid_chunk, require_chunk(chunks, ChunkType::point_grid));
  CURLIDAR_TRY_ASSIGN(cliff_chunk, require_chunk(chunks, ChunkType::cliffs));
  CellMasks masks;
  masks.rows = lattice.rows();
  masks.columns = lattice.columns();
  PayloadReader grid(grid_chunk);
  CURLIDAR_TRY_ASSIGN(point, unpack_bits(grid, "point grid", lattice.cells()));
  CURLIDAR_TRY(grid.finish());
  masks.point = std::move(point);
  PayloadReader cliffs(cliff_chunk);
  for (auto* mask : {&masks.cliff_row, &masks.cliff_column, &masks.cliff_diagonal}) {
    CURLIDAR_TRY_ASSIGN(bits, unpack_bits(cliffs, "cliffs", lattice.cells()));
    *mask = std::move(bits);
  }
  CURLIDAR_TRY(cliffs.finish());
  return masks;
}

std::vector<std::byte> write_patches(const std::vector<PatchFit>& patches) {
  std::vector<std::uint16_t> counts;
  std::vector<float> coefficients;
  for (const PatchFit& patch : patches) {
    counts.push_back(static_cast<std::uint16_t>(patch.coefficients.size()));
    for (const double c : patch.coefficients) coefficients.push_back(static_cast<float>(c));
  }
  ByteWriter writer;
  writer.write_bytes(pack_numbers(counts));
  writer.write_bytes(pack_numbers(coefficients));
  return std::move(writer).bytes();
}

Result<std::vector<PatchFit>> read_patches(const Chunk& chunk, const PatchGrid& grid,
                                           std::uint64_t max_bytes) {
  PayloadReader reader(chunk);
  CURLIDAR_TRY_ASSIGN(counts, unpack_numbers<std::uint16_t>(reader, "patch sizes", grid.count()));
  std::uint64_t total = 0;
  for (const std::uint16_t count : counts) {
    if (count > kMaxPatchFunctions) return reader.corrupt("a patch has too many coefficients");
    total += count;
  }
  if (total > max_bytes / sizeof(double)) {
    return reader.error(ErrorCode::limit_exceeded,
                        "the coefficients take more memory than allowed");
  }
  CURLIDAR_TRY_ASSIGN(coefficients, unpack_numbers<float>(reader, "coefficients", total));
  CURLIDAR_TRY(reader.finish());
  std::vector<PatchFit> patches(grid.count());
  std::size_t at = 0;
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      PatchFit& patch = patches[row * grid.columns() + column];
      const std::size_t count = counts[row * grid.columns() + column];
      if (count > grid.window(row, column).cells()) {
        return reader.corrupt("a patch has more coefficients than cells");
      }
      for (std::size_t k = 0; k < count; ++k) {
        const float c = coefficients[at++];
        if (!std::isfinite(c)) return reader.corrupt("a coefficient is not a finite number");
        patch.coefficients.push_back(static_cast<double>(c));
      }
    }
  }
  return patches;
}

std::vector<std::byte> write_global(const std::vector<double>& coefficients) {
  return pack_numbers(coefficients);
}

Result<std::vector<double>> read_global(const Chunk& chunk, std::uint32_t degree) {
  PayloadReader reader(chunk);
  const std::uint64_t count = std::uint64_t{degree + 1} * (degree + 1);
  CURLIDAR_TRY_ASSIGN(coefficients, unpack_numbers<double>(reader, "coefficients", count));
  CURLIDAR_TRY(reader.finish());
  for (const double c : coefficients) {
    if (!std::isfinite(c)) return reader.corrupt("a coefficient is not a finite number");
  }
  return coefficients;
}

}  // namespace curlidar
