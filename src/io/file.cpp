// SPDX-License-Identifier: BSD-3-Clause
// Whole files in and out. Outputs appear whole or not at all.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/try.hpp"
#include "curlidar/io.hpp"

namespace curlidar {
namespace {

Error system_error(const std::string& name, const char* doing, int number) {
  const ErrorCode code = number == ENOENT ? ErrorCode::not_found : ErrorCode::io;
  return {code,
          fmt::format("{}: cannot {}: {}", name, doing, std::generic_category().message(number))};
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }
  /// Closes now; some file systems report a failed write only here.
  bool close() {
    const int number = number_;
    number_ = -1;
    return ::close(number) == 0;
  }

 private:
  int number_;
};

Result<std::vector<std::byte>> read_all(int descriptor, const std::string& name) {
  struct stat status {};
  std::size_t expected = 0;
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    expected = static_cast<std::size_t>(status.st_size);
  }
  std::vector<std::byte> bytes(expected + 1);  // one more, so that the end is seen at once
  std::size_t size = 0;
  for (;;) {
    const ssize_t got = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return system_error(name, "read", errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    if (size == bytes.size()) bytes.resize(2 * size + 65536);
  }
  bytes.resize(size);
  return bytes;
}

Status write_all(int descriptor, const std::string& name, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return system_error(name, "write", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return {};
}

/// Pipes and devices cannot be replaced by renaming.
Status write_in_place(const std::string& path, std::span<const std::byte> bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0) return system_error(path, "open for writing", errno);
  return write_all(file.get(), path, bytes);
}

/// A name that no other output of this machine uses, beside the target.
std::string temporary_beside(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name = fmt::format(".curlidar-{}-{}.tmp", ::getpid(), counter.fetch_add(1));
  return (target.parent_path() / name).string();
}

Status write_temporary(const std::string& temporary, const std::string& path,
                       const std::filesystem::path& target, bool exists,
                       std::span<const std::byte> bytes) {
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) return system_error(path, "create a file in its directory", errno);
  struct stat status {};
  if (exists && ::stat(target.c_str(), &status) == 0) {
    // A replaced file keeps its permissions where the system lets us; the content matters more.
    [[maybe_unused]] const int ignored = ::fchmod(file.get(), status.st_mode & 07777);
  }
  CURLIDAR_TRY(write_all(file.get(), path, bytes));
  if (!file.close()) return system_error(path, "write", errno);
  return {};
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::string& path) {
  if (path == "-") return read_all(STDIN_FILENO, "standard input");
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return system_error(path, "open", errno);
  return read_all(file.get(), path);
}

Status write_file(const std::string& path, std::span<const std::byte> bytes) {
  namespace fs = std::filesystem;
  if (path == "-") return write_all(STDOUT_FILENO, "standard output", bytes);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const bool exists = fs::exists(status);
  if (fs::is_directory(status)) return system_error(path, "write", EISDIR);
  if (exists && !fs::is_regular_file(status)) return write_in_place(path, bytes);

  // A link stays a link: what it points to is replaced.
  fs::path target = path;
  if (exists && fs::is_symlink(fs::symlink_status(path, error))) {
    target = fs::canonical(path, error);
    if (error) return system_error(path, "resolve the link", error.value());
  }
  const std::string temporary = temporary_beside(target);
  Status written = write_temporary(temporary, path, target, exists, bytes);
  if (written && ::rename(temporary.c_str(), target.c_str()) != 0) {
    written = system_error(path, "rename the finished file", errno);
  }
  if (!written) ::unlink(temporary.c_str());
  return written;
}

}  // namespace curlidar
