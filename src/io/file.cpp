// SPDX-License-Identifier: BSD-3-Clause
// Whole files in and out.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "io/atomic_file.hpp"

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

}  // namespace

Result<std::vector<std::byte>> read_file(const std::string& path) {
  if (path == "-") return read_all(STDIN_FILENO, "standard input");
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return system_error(path, "open", errno);
  return read_all(file.get(), path);
}

Status write_file(const std::string& path, std::span<const std::byte> bytes) {
  CURLIDAR_TRY_ASSIGN(file, AtomicFile::create(path));
  CURLIDAR_TRY(file.write(bytes));
  return file.commit();
}

}  // namespace curlidar
