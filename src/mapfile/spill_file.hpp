// SPDX-License-Identifier: BSD-3-Clause
// A temporary file without a name: gone with the process, however that ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// Bytes put aside one after the other, and read again from anywhere. The file is made when the
/// first bytes come, in the folder of temporary files.
class SpillFile {
 public:
  SpillFile() = default;
  SpillFile(SpillFile&& other) noexcept;
  SpillFile& operator=(SpillFile&& other) noexcept;
  ~SpillFile();

  /// Where the bytes begin. Errors: io.
  Result<std::uint64_t> append(ByteSpan bytes);
  Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t size) const;
  std::uint64_t size() const { return size_; }

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace curlidar
