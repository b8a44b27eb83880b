// SPDX-License-Identifier: BSD-3-Clause
// What commands tell: aligned tables for people, JSON for programs, a progress bar on terminals.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "curlidar/progress.hpp"

namespace curlidar::app {

using Json = nlohmann::ordered_json;

/// Rows of cells under aligned columns; the first column left, the others right.
class Table {
 public:
  explicit Table(std::size_t indent = 2) : indent_(indent) {}
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text() const;

 private:
  std::size_t indent_;
  std::vector<std::vector<std::string>> rows_;
};

/// 122627 -> "122,627".
/// "  key    value" lines with the values below each other.
std::string lines_text(const std::vector<std::pair<std::string, std::string>>& lines);

std::string count_text(std::uint64_t count);
/// "917 B", "13.5 kB", "2.3 MB".
std::string bytes_text(std::uint64_t bytes);
/// "812 um", "3.3 mm", "45.1 cm", "1.204 m".
std::string length_text(double metres);
std::string milliseconds_text(double ms);

/// JSON text with a newline; not-a-number becomes null, bytes that are not UTF-8 are replaced.
std::string json_text(const Json& json);

/// Draws "label [=====>   ] 42 % stage" on standard error, if that is a terminal, once the work
/// has taken a second. Removes itself.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Input `index` (0 based) of `count` is at `fraction` of its way.
  void update(std::size_t index, std::size_t count, std::string_view stage, double fraction);
  /// Removes the bar, before something else is printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_draw_{};
};

}  // namespace curlidar::app
