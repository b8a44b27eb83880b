// SPDX-License-Identifier: BSD-3-Clause
#include "format/packed.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <utility>

#include "base/try.hpp"

namespace curlidar {
namespace {

/// The most that `compressed` bytes of zstd can hold: a block takes at least 4 bytes (3 of header
/// and the byte of a run) and holds at most 128 KiB.
std::uint64_t most_unpacked(std::uint64_t compressed) {
  constexpr std::uint64_t kBlock = std::uint64_t{1} << ZSTD_BLOCKSIZELOG_MAX;
  return (compressed / 4 + 1) * kBlock;
}

/// One zstd frame, or nothing where it would not be smaller than the bytes themselves.
std::vector<std::byte> compress(ByteSpan raw, int level) {
  std::vector<std::byte> frame(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), level);
  if (ZSTD_isError(size) != 0 || size >= raw.size()) return {};
  frame.resize(size);
  return frame;
}

/// A packed block as it lies in the payload.
struct Block {
  std::uint64_t size = 0;  ///< claimed, unpacked
  bool compressed = false;
  ByteSpan stored;
};

Result<Block> read_block(PayloadReader& reader, std::string_view what) {
  const std::uint64_t head = reader.read_varint();
  Block block{head / 2, (head & 1) != 0, {}};
  block.stored = reader.take(block.compressed ? reader.read_varint() : block.size);
  CURLIDAR_TRY(reader.check(what));
  return block;
}

/// Whether the frame could unpack to `size` bytes, told without unpacking it. Only frames of
/// today's zstd format are taken, no legacy or skippable ones.
bool is_plausible(ByteSpan frame, std::uint64_t size) {
  if (frame.size() < sizeof(std::uint32_t) ||
      load_little_endian<std::uint32_t>(frame.data()) != ZSTD_MAGICNUMBER) {
    return false;
  }
  const auto stated = ZSTD_getFrameContentSize(frame.data(), frame.size());
  return (stated == ZSTD_CONTENTSIZE_UNKNOWN || stated == size) &&
         size <= most_unpacked(frame.size());
}

Result<std::vector<std::byte>> unpack(const PayloadReader& reader, std::string_view what,
                                      const Block& block) {
  const ByteSpan stored = block.stored;
  if (!block.compressed) return std::vector<std::byte>(stored.begin(), stored.end());
  if (!is_plausible(stored, block.size)) {
    return reader.corrupt(
        fmt::format("the compressed {} cannot hold the {} bytes claimed", what, block.size));
  }
  std::vector<std::byte> raw(static_cast<std::size_t>(block.size));
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size());
  if (ZSTD_isError(size) != 0) {
    return reader.corrupt(fmt::format("the compressed {} is damaged: zstd says \"{}\"", what,
                                      ZSTD_getErrorName(size)));
  }
  if (size != raw.size()) {
    return reader.corrupt(
        fmt::format("the compressed {} gives {} bytes, {} were claimed", what, size, raw.size()));
  }
  return raw;
}

}  // namespace

std::vector<std::byte> pack(ByteSpan raw, int level) {
  const std::vector<std::byte> frame = compress(raw, level);
  ByteWriter writer;
  writer.write_varint(2 * static_cast<std::uint64_t>(raw.size()) + (frame.empty() ? 0 : 1));
  if (frame.empty()) {
    writer.write_bytes(raw);
  } else {
    writer.write_varint(frame.size());
    writer.write_bytes(frame);
  }
  return std::move(writer).bytes();
}

Result<std::vector<std::byte>> unpack(PayloadReader& reader, std::string_view what,
                                      std::uint64_t max_size) {
  CURLIDAR_TRY_ASSIGN(block, read_block(reader, what));
  if (block.size > max_size) {
    return reader.error(
        ErrorCode::limit_exceeded,
        fmt::format("the {} claims {} bytes, the limit is {}", what, block.size, max_size));
  }
  return unpack(reader, what, block);
}

Result<std::vector<std::byte>> unpack_exactly(PayloadReader& reader, std::string_view what,
                                              std::uint64_t size) {
  CURLIDAR_TRY_ASSIGN(block, read_block(reader, what));
  if (block.size != size) {
    return reader.corrupt(
        fmt::format("the {} claims {} bytes, {} are expected", what, block.size, size));
  }
  return unpack(reader, what, block);
}

std::vector<std::byte> pack_bits(std::span<const std::uint8_t> cells) {
  std::vector<std::byte> bits((cells.size() + 7) / 8);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] != 0) bits[i / 8] |= std::byte{1} << (i % 8);
  }
  return pack(bits);
}

Result<std::vector<std::uint8_t>> unpack_bits(PayloadReader& reader, std::string_view what,
                                              std::uint64_t cells) {
  const std::uint64_t bytes = cells / 8 + (cells % 8 != 0 ? 1 : 0);
  CURLIDAR_TRY_ASSIGN(bits, unpack_exactly(reader, what, bytes));
  std::vector<std::uint8_t> values(static_cast<std::size_t>(cells));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<std::uint8_t>((bits[i / 8] >> (i % 8)) & std::byte{1});
  }
  if (cells % 8 != 0 && (bits.back() >> (cells % 8)) != std::byte{0}) {
    return reader.corrupt(fmt::format("the {} has bits beyond its last cell", what));
  }
  return values;
}

std::vector<std::byte> split_planes(ByteSpan bytes, std::size_t value_size) {
  const std::size_t count = bytes.size() / value_size;
  std::vector<std::byte> planes(bytes.size());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < value_size; ++k) planes[k * count + i] = bytes[i * value_size + k];
  }
  return planes;
}

std::vector<std::byte> join_planes(ByteSpan planes, std::size_t value_size) {
  const std::size_t count = planes.size() / value_size;
  std::vector<std::byte> bytes(planes.size());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < value_size; ++k) bytes[i * value_size + k] = planes[k * count + i];
  }
  return bytes;
}

}  // namespace curlidar
