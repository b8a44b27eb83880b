// SPDX-License-Identifier: BSD-3-Clause
// Where seeds are written to, and how they are put together.
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.hpp"

namespace curlidar::fuzz {

using Bytes = std::vector<std::byte>;

class Seeds {
 public:
  explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void write(const std::string& target, const std::string& name, const Bytes& bytes) const {
    std::filesystem::create_directories(folder_ / target);
    std::ofstream file(folder_ / target / ("seed-" + name), std::ios::binary);
    for (const std::byte b : bytes) file.put(static_cast<char>(b));
  }

 private:
  std::filesystem::path folder_;
};

inline void append(Bytes& to, ByteSpan bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}
inline void append(Bytes& to, std::initializer_list<std::size_t> numbers) {
  for (const std::size_t number : numbers) to.push_back(static_cast<std::byte>(number & 0xff));
}
/// Predicted scans, tiles, maps and sequences.
void write_drive_seeds(const Seeds& seeds);

}  // namespace curlidar::fuzz
