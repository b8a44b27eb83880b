// SPDX-License-Identifier: BSD-3-Clause
// Where the real scans are: not part of the repository, so tests that need them may have to skip.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace curlidar::test {

/// $CURLIDAR_DATA, else shared/data beside the project or one of its parents. Nothing if absent.
inline std::optional<std::filesystem::path> data_directory() {
  namespace fs = std::filesystem;
  const auto is_data = [](const fs::path& path) {
    std::error_code error;
    return fs::exists(path / "MANIFEST.tsv", error);
  };
  if (const char* given = std::getenv("CURLIDAR_DATA"); given != nullptr && *given != '\0') {
    return is_data(given) ? std::optional<fs::path>(given) : std::nullopt;
  }
  for (fs::path at = fs::path(__FILE__).parent_path(); at.has_relative_path();
       at = at.parent_path()) {
    if (is_data(at / "shared" / "data")) return at / "shared" / "data";
  }
  return std::nullopt;
}

}  // namespace curlidar::test
