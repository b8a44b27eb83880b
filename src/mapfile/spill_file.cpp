// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/spill_file.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace curlidar {
namespace {

Error spill_error(const char* doing, int number) {
  return {ErrorCode::io,
          fmt::format("cannot {} a temporary file: {}; TMPDIR names the folder that is used", doing,
                      std::generic_category().message(number))};
}

}  // namespace

SpillFile::SpillFile(SpillFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

SpillFile& SpillFile::operator=(SpillFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

SpillFile::~SpillFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<std::uint64_t> SpillFile::append(ByteSpan bytes) {
  if (descriptor_ < 0) {
    std::error_code error;
    std::string path =
        (std::filesystem::temp_directory_path(error) / ".curlidar-map-XXXXXX").string();
    descriptor_ = error ? -1 : ::mkstemp(path.data());
    if (descriptor_ < 0) return spill_error("make", error ? error.value() : errno);
    ::unlink(path.c_str());
  }
  const std::uint64_t begin = size_;
  while (!bytes.empty()) {
    const ssize_t put =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return spill_error("write", errno);
    size_ += static_cast<std::uint64_t>(put);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return begin;
}

Result<std::vector<std::byte>> SpillFile::read(std::uint64_t offset, std::uint64_t size) const {
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::pread(descriptor_, bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return spill_error("read", got < 0 ? errno : EIO);
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

}  // namespace curlidar
