// SPDX-License-Identifier: BSD-3-Clause
#include "format/payload.hpp"

#include <fmt/format.h>

#include "base/try.hpp"
#include "base/utf8.hpp"

namespace curlidar {

Error PayloadReader::error(ErrorCode code, std::string_view what) const {
  return {code, fmt::format("{} chunk, byte {}: {}", to_string(type_), start_ + offset(), what)};
}

Status PayloadReader::check(std::string_view what) const {
  if (ok()) return {};
  return corrupt(fmt::format("the payload ends inside the {}", what));
}

Status PayloadReader::finish() const {
  CURLIDAR_TRY(check("payload"));
  if (remaining() == 0) return {};
  return corrupt(fmt::format("{} unexpected bytes at the end", remaining()));
}

Result<std::uint64_t> PayloadReader::read_count(std::string_view what, std::uint64_t max) {
  const std::uint64_t count = read_varint();
  CURLIDAR_TRY(check(fmt::format("number of {}", what)));
  if (count > max) {
    return corrupt(fmt::format("{} {} claimed, at most {} are possible here", count, what, max));
  }
  return count;
}

Result<std::string> PayloadReader::read_text(std::string_view what, std::size_t max_bytes) {
  CURLIDAR_TRY_ASSIGN(size, read_count(fmt::format("bytes of {}", what), max_bytes));
  const ByteSpan bytes = take(size);
  CURLIDAR_TRY(check(what));
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!is_utf8(text)) return corrupt(fmt::format("the {} is not valid UTF-8", what));
  return text;
}

Status write_text(ByteWriter& writer, std::string_view what, std::string_view text,
                  std::size_t max_bytes) {
  if (text.size() > max_bytes) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("the {} has {} bytes, a .curl file holds at most {}; shorten it", what,
                             text.size(), max_bytes)};
  }
  if (!is_utf8(text)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("the {} is not valid UTF-8; convert or remove it", what)};
  }
  writer.write_string(text);
  return {};
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 64;
  const bool printable = is_utf8(text);
  std::string shown = "\"";
  for (const char c : text.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte >= 0x20 && byte != 0x7f && (byte < 0x80 || printable);
    shown += plain ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return shown + (text.size() > kShown ? "...\"" : "\"");
}

}  // namespace curlidar
