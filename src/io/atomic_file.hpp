// SPDX-License-Identifier: BSD-3-Clause
// A file that is written piece by piece and appears whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "curlidar/result.hpp"

namespace curlidar {

/// Writes to a hidden name beside the target, which commit() renames; without it nothing is left.
/// What cannot be replaced by renaming ("-", pipes, devices) is written as the pieces come.
class AtomicFile {
 public:
  /// Errors: not_found, io (no such directory, no permission, a directory).
  static Result<AtomicFile> create(const std::string& path);
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) noexcept;
  ~AtomicFile();

  Status write(std::span<const std::byte> bytes);
  std::uint64_t size() const;  ///< bytes written
  /// The file appears, in place of an older one of that name, whose permissions it takes.
  Status commit();

 private:
  struct State;
  explicit AtomicFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace curlidar
