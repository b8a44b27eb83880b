// SPDX-License-Identifier: BSD-3-Clause
#include "io/lzf.hpp"

#include <algorithm>
#include <utility>

namespace curlidar::io {
namespace {

constexpr std::size_t kMaxLiterals = 32;
constexpr std::size_t kMinMatch = 3;
constexpr std::size_t kMaxMatch = 264;
constexpr std::size_t kMaxDistance = 8192;
constexpr unsigned kHashBits = 15;

std::uint32_t hash_of(const std::byte* p) {
  const std::uint32_t three = std::to_integer<std::uint32_t>(p[0]) |
                              std::to_integer<std::uint32_t>(p[1]) << 8 |
                              std::to_integer<std::uint32_t>(p[2]) << 16;
  return (three * 2654435761u) >> (32 - kHashBits);
}

void put_literals(ByteSpan literals, std::vector<std::byte>& out) {
  while (!literals.empty()) {
    const ByteSpan run = literals.first(std::min(literals.size(), kMaxLiterals));
    out.push_back(static_cast<std::byte>(run.size() - 1));
    out.insert(out.end(), run.begin(), run.end());
    literals = literals.subspan(run.size());
  }
}

void put_match(std::size_t distance, std::size_t length, std::vector<std::byte>& out) {
  const std::size_t code = length - 2;
  const std::size_t back = distance - 1;
  out.push_back(static_cast<std::byte>(std::min<std::size_t>(code, 7) << 5 | back >> 8));
  if (code >= 7) out.push_back(static_cast<std::byte>(code - 7));
  out.push_back(static_cast<std::byte>(back & 0xff));
}

}  // namespace

std::vector<std::byte> lzf_compress(ByteSpan input) {
  constexpr std::size_t kNever = ~std::size_t{0};
  std::vector<std::size_t> last(std::size_t{1} << kHashBits, kNever);
  std::vector<std::byte> out;
  out.reserve(input.size() / 2 + 16);
  std::size_t literals = 0;  // where the bytes not yet written start
  std::size_t i = 0;
  while (i + kMinMatch <= input.size()) {
    const std::size_t candidate = std::exchange(last[hash_of(&input[i])], i);
    std::size_t length = 0;
    if (candidate != kNever && i - candidate <= kMaxDistance) {
      const std::size_t most = std::min(kMaxMatch, input.size() - i);
      while (length < most && input[candidate + length] == input[i + length]) ++length;
    }
    if (length < kMinMatch) {
      ++i;
      continue;
    }
    put_literals(input.subspan(literals, i - literals), out);
    put_match(i - candidate, length, out);
    i += length;
    literals = i;
  }
  put_literals(input.subspan(literals), out);
  return out;
}

std::optional<std::vector<std::byte>> lzf_decompress(ByteSpan input, std::uint64_t size) {
  if (size / kLzfMaxExpansion > input.size()) return std::nullopt;
  std::vector<std::byte> out(static_cast<std::size_t>(size));
  std::size_t at = 0;
  ByteReader in(input);
  while (in.remaining() > 0) {
    const auto control = in.read<std::uint8_t>();
    if (control < kMaxLiterals) {
      const ByteSpan run = in.take(control + 1u);
      if (run.empty() || run.size() > out.size() - at) return std::nullopt;
      std::copy(run.begin(), run.end(), out.begin() + static_cast<std::ptrdiff_t>(at));
      at += run.size();
      continue;
    }
    std::size_t length = control >> 5u;
    if (length == 7) length += in.read<std::uint8_t>();
    length += 2;
    const std::size_t distance = ((control & 0x1fu) << 8u) + in.read<std::uint8_t>() + 1u;
    if (!in.ok() || distance > at || length > out.size() - at) return std::nullopt;
    // Byte by byte: an overlapping copy repeats what it has just written.
    for (std::size_t k = 0; k < length; ++k, ++at) out[at] = out[at - distance];
  }
  if (at != out.size()) return std::nullopt;
  return out;
}

}  // namespace curlidar::io
