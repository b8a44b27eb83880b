// SPDX-License-Identifier: BSD-3-Clause
#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/try.hpp"
#include "curlidar/io.hpp"

namespace curlidar {
namespace {

namespace fs = std::filesystem;

Error write_error(const std::string& name, const char* doing, int number) {
  const ErrorCode code = number == ENOENT ? ErrorCode::not_found : ErrorCode::io;
  return {code,
          fmt::format("{}: cannot {}: {}", name, doing, std::generic_category().message(number))};
}

/// Names that a signal handler removes: memory of its own, because handlers may not allocate.
struct TemporaryName {
  std::atomic<int> state{0};  ///< 0 free, 1 being filled, 2 in use
  std::array<char, PATH_MAX> path{};
};
std::array<TemporaryName, 16> temporary_names;

/// Where the name is kept, or null if all places are taken.
TemporaryName* remember(const std::string& path) {
  if (path.size() >= PATH_MAX) return nullptr;
  for (TemporaryName& name : temporary_names) {
    int free = 0;
    if (!name.state.compare_exchange_strong(free, 1)) continue;
    std::memcpy(name.path.data(), path.c_str(), path.size() + 1);
    name.state = 2;
    return &name;
  }
  return nullptr;
}

void forget(TemporaryName* name) {
  if (name != nullptr) name->state = 0;
}

extern "C" void remove_temporaries_and_end(int signal) {
  for (TemporaryName& name : temporary_names) {
    if (name.state == 2) ::unlink(name.path.data());
  }
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

/// A name that no other output of this machine uses, beside the target.
std::string temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name = fmt::format(".curlidar-{}-{}.tmp", ::getpid(), counter.fetch_add(1));
  return (target.parent_path() / name).string();
}

}  // namespace

struct AtomicFile::State {
  std::string path;       ///< as the caller names it
  fs::path target;        ///< what the links of `path` lead to
  std::string temporary;  ///< empty: written in place
  TemporaryName* remembered = nullptr;
  int descriptor = -1;
  std::uint64_t size = 0;

  ~State() {
    if (descriptor >= 0 && descriptor != STDOUT_FILENO) ::close(descriptor);
    if (!temporary.empty()) ::unlink(temporary.c_str());
    forget(remembered);
  }
};

AtomicFile::AtomicFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;
AtomicFile& AtomicFile::operator=(AtomicFile&&) noexcept = default;
AtomicFile::~AtomicFile() = default;

Result<AtomicFile> AtomicFile::create(const std::string& path) {
  auto state = std::make_unique<State>();
  state->path = path == "-" ? "standard output" : path;
  if (path == "-") {
    state->descriptor = STDOUT_FILENO;
    return AtomicFile(std::move(state));
  }
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const bool exists = fs::exists(status);
  if (fs::is_directory(status)) return write_error(path, "write", EISDIR);
  if (exists && !fs::is_regular_file(status)) {  // pipes and devices cannot be replaced
    state->descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (state->descriptor < 0) return write_error(path, "open for writing", errno);
    return AtomicFile(std::move(state));
  }
  // A link stays a link: what it points to is replaced.
  state->target = path;
  if (exists && fs::is_symlink(fs::symlink_status(path, error))) {
    state->target = fs::canonical(path, error);
    if (error) return write_error(path, "resolve the link", error.value());
  }
  const std::string temporary = temporary_beside(state->target);
  state->remembered = remember(temporary);
  state->descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (state->descriptor < 0) return write_error(path, "create a file in its directory", errno);
  state->temporary = temporary;
  struct stat old {};
  if (exists && ::stat(state->target.c_str(), &old) == 0) {
    // A replaced file keeps its permissions where the system lets us; the content matters more.
    [[maybe_unused]] const int ignored = ::fchmod(state->descriptor, old.st_mode & 07777);
  }
  return AtomicFile(std::move(state));
}

Status AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(state_->descriptor, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return write_error(state_->path, "write", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    state_->size += static_cast<std::uint64_t>(put);
  }
  return {};
}

std::uint64_t AtomicFile::size() const {
  return state_->size;
}

Status AtomicFile::commit() {
  if (state_->temporary.empty()) return {};
  // Some file systems report a failed write only when the file is closed.
  if (::close(std::exchange(state_->descriptor, -1)) != 0) {
    return write_error(state_->path, "write", errno);
  }
  if (::rename(state_->temporary.c_str(), state_->target.c_str()) != 0) {
    return write_error(state_->path, "rename the finished file", errno);
  }
  state_->temporary.clear();
  return {};
}

void remove_temporary_files_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // Who starts this program to outlive a terminal has these signals ignored: they stay so.
    if (std::signal(signal, remove_temporaries_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace curlidar
