// SPDX-License-Identifier: BSD-3-Clause
// Bounded little-endian reading and writing; the only way bytes become numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace curlidar {

using ByteSpan = std::span<const std::byte>;

template <std::size_t Size>
using UnsignedOfSize = std::conditional_t<
    Size == 1, std::uint8_t,
    std::conditional_t<Size == 2, std::uint16_t,
                       std::conditional_t<Size == 4, std::uint32_t, std::uint64_t>>>;

/// The arithmetic value whose little-endian bytes start at `bytes` (sizeof(T) of them).
template <class T>
T load_little_endian(const std::byte* bytes) {
  UnsignedOfSize<sizeof(T)> bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bits = static_cast<decltype(bits)>(
        bits | static_cast<decltype(bits)>(static_cast<std::uint64_t>(bytes[i]) << (8 * i)));
  }
  return std::bit_cast<T>(bits);
}

template <class T>
T load_big_endian(const std::byte* bytes) {
  std::byte reversed[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) reversed[i] = bytes[sizeof(T) - 1 - i];
  return load_little_endian<T>(reversed);
}

/// Reads forward through a span. The first read past the end makes the reader fail for good:
/// every later read gives zero, so that callers may check `ok()` once per record.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t offset() const { return offset_; }
  std::size_t remaining() const { return bytes_.size() - offset_; }

  /// An integer or floating-point number.
  template <class T>
  T read() {
    const ByteSpan span = take(sizeof(T));
    return span.empty() ? T{} : load_little_endian<T>(span.data());
  }
  /// Unsigned LEB128, at most 64 bits.
  std::uint64_t read_varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const auto byte = read<std::uint8_t>();
      if (shift == 63 && byte > 1) break;
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return ok_ ? value : 0;
    }
    ok_ = false;
    return 0;
  }
  /// The next `size` bytes; empty (and failed) if there are fewer.
  ByteSpan take(std::uint64_t size) {
    if (!ok_ || size > remaining()) {
      ok_ = false;
      return {};
    }
    const ByteSpan span = bytes_.subspan(offset_, static_cast<std::size_t>(size));
    offset_ += static_cast<std::size_t>(size);
    return span;
  }
  /// A string with a varint length.
  std::string read_string() {
    const ByteSpan span = take(read_varint());
    return {reinterpret_cast<const char*>(span.data()), span.size()};
  }

 private:
  ByteSpan bytes_;
  std::size_t offset_ = 0;
  bool ok_ = true;
};

/// Appends to a vector of bytes.
class ByteWriter {
 public:
  template <class T>
  void write(T value) {
    const auto bits = std::bit_cast<UnsignedOfSize<sizeof(T)>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_.push_back(static_cast<std::byte>((static_cast<std::uint64_t>(bits) >> (8 * i)) & 0xff));
    }
  }
  void write_varint(std::uint64_t value) {
    while (value >= 0x80) {
      write(static_cast<std::uint8_t>(value | 0x80));
      value >>= 7;
    }
    write(static_cast<std::uint8_t>(value));
  }
  void write_bytes(ByteSpan bytes) {
    // Not insert(): gcc 12 takes its growth for an overflow (-Wstringop-overflow).
    const std::size_t end = bytes_.size();
    bytes_.resize(end + bytes.size());
    if (!bytes.empty()) std::memcpy(bytes_.data() + end, bytes.data(), bytes.size());
  }
  void write_string(std::string_view text) {
    write_varint(text.size());
    write_bytes(std::as_bytes(std::span(text.data(), text.size())));
  }

  std::size_t size() const { return bytes_.size(); }
  const std::vector<std::byte>& bytes() const& { return bytes_; }
  std::vector<std::byte> bytes() && { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace curlidar
