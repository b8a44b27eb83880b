// SPDX-License-Identifier: BSD-3-Clause
// Parts of a file, wherever they lie in it; parts of bytes in memory likewise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "curlidar/result.hpp"

namespace curlidar {

/// Something of a known size whose bytes can be read in any order, by many threads at once.
class RandomAccess {
 public:
  virtual ~RandomAccess() = default;
  virtual std::uint64_t size() const = 0;
  /// What messages call it.
  virtual const std::string& name() const = 0;
  /// Exactly `size` bytes from `offset`. Corrupt if there are fewer, which takes no memory; io if
  /// the system refuses.
  virtual Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t size) const = 0;
};

/// A regular file, open until the last holder is gone: replacing it by another does no harm.
/// Errors: not_found, io; invalid_argument for pipes and devices.
Result<std::shared_ptr<const RandomAccess>> open_random_access(const std::string& path);
/// Bytes that the result holds.
std::shared_ptr<const RandomAccess> random_access_of(std::vector<std::byte> bytes,
                                                     std::string name);

}  // namespace curlidar
