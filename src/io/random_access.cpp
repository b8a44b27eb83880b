// SPDX-License-Identifier: BSD-3-Clause
#include "io/random_access.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace curlidar {
namespace {

Error cut_off(const std::string& name, std::uint64_t offset, std::uint64_t wanted,
              std::uint64_t there) {
  return {ErrorCode::corrupt, fmt::format("{}: byte {}: {} bytes should be here, the file has {}; "
                                          "it is cut off or damaged",
                                          name, offset, wanted, there)};
}

std::uint64_t left_from(std::uint64_t offset, std::uint64_t size) {
  return offset < size ? size - offset : 0;
}

class FileAccess : public RandomAccess {
 public:
  FileAccess(int descriptor, std::uint64_t size, std::string name)
      : descriptor_(descriptor), size_(size), name_(std::move(name)) {}
  FileAccess(const FileAccess&) = delete;
  FileAccess& operator=(const FileAccess&) = delete;
  ~FileAccess() override { ::close(descriptor_); }

  std::uint64_t size() const override { return size_; }
  const std::string& name() const override { return name_; }

  Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t size) const override {
    if (const std::uint64_t left = left_from(offset, size_); size > left) {
      return cut_off(name_, offset, size, left);
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t got = ::pread(descriptor_, bytes.data() + done, bytes.size() - done,
                                  static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) {
        return Error{ErrorCode::io, fmt::format("{}: cannot read: {}", name_,
                                                std::generic_category().message(errno))};
      }
      if (got == 0) return cut_off(name_, offset, size, done);  // became shorter meanwhile
      done += static_cast<std::size_t>(got);
    }
    return bytes;
  }

 private:
  int descriptor_;
  std::uint64_t size_;
  std::string name_;
};

class MemoryAccess : public RandomAccess {
 public:
  MemoryAccess(std::vector<std::byte> bytes, std::string name)
      : bytes_(std::move(bytes)), name_(std::move(name)) {}

  std::uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }

  Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t size) const override {
    if (const std::uint64_t left = left_from(offset, bytes_.size()); size > left) {
      return cut_off(name_, offset, size, left);
    }
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
    return std::vector<std::byte>(begin, begin + static_cast<std::ptrdiff_t>(size));
  }

 private:
  std::vector<std::byte> bytes_;
  std::string name_;
};

}  // namespace

Result<std::shared_ptr<const RandomAccess>> open_random_access(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return Error{errno == ENOENT ? ErrorCode::not_found : ErrorCode::io,
                 fmt::format("{}: cannot open: {}", path, std::generic_category().message(errno))};
  }
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return Error{ErrorCode::invalid_argument,
                 fmt::format("{}: not a regular file; parts of it cannot be read in any order, "
                             "save it to a file first",
                             path)};
  }
  return std::shared_ptr<const RandomAccess>(
      std::make_shared<FileAccess>(descriptor, static_cast<std::uint64_t>(status.st_size), path));
}

std::shared_ptr<const RandomAccess> random_access_of(std::vector<std::byte> bytes,
                                                     std::string name) {
  return std::make_shared<MemoryAccess>(std::move(bytes), std::move(name));
}

}  // namespace curlidar
