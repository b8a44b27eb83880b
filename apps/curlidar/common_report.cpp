// SPDX-License-Identifier: BSD-3-Clause
#include "common_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace curlidar::app {

std::string Table::text() const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string text;
  for (const auto& row : rows_) {
    text.append(indent_, ' ');
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += c == 0 ? fmt::format("{:<{}}", row[c], widths[c])
                     : fmt::format("  {:>{}}", row[c], widths[c]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

std::string lines_text(const std::vector<std::pair<std::string, std::string>>& lines) {
  std::size_t width = 0;
  for (const auto& [key, value] : lines) width = std::max(width, key.size());
  std::string text;
  for (const auto& [key, value] : lines) text += fmt::format("  {:<{}}  {}\n", key, width, value);
  return text;
}

std::string count_text(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, 1, ',');
  return text;
}

std::string bytes_text(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (bytes < 1000) return fmt::format("{} B", bytes);
  if (value < 1e6) return fmt::format("{:.1f} kB", value / 1e3);
  if (value < 1e9) return fmt::format("{:.2f} MB", value / 1e6);
  return fmt::format("{:.2f} GB", value / 1e9);
}

std::string length_text(double metres) {
  const double size = std::abs(metres);
  if (!std::isfinite(metres)) return "-";
  if (size == 0) return "0 m";
  if (size < 1e-3) return fmt::format("{:.3g} um", metres * 1e6);
  if (size < 0.1) return fmt::format("{:.1f} mm", metres * 1e3);
  if (size < 1) return fmt::format("{:.1f} cm", metres * 1e2);
  return fmt::format("{:.2f} m", metres);
}

std::string milliseconds_text(double ms) {
  return ms < 10000 ? fmt::format("{:.1f} ms", ms) : fmt::format("{:.1f} s", ms / 1000);
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

ProgressBar::ProgressBar(bool wanted) : enabled_(wanted && isatty(STDERR_FILENO) != 0) {}

void ProgressBar::update(std::size_t index, std::size_t count, std::string_view stage,
                         double fraction) {
  if (!enabled_) return;
  const Clock::time_point now = Clock::now();
  if (now - start_ < std::chrono::seconds(1)) return;
  if (now - last_draw_ < std::chrono::milliseconds(100)) return;
  last_draw_ = now;
  constexpr std::size_t kWidth = 30;
  const double share = (static_cast<double>(index) + std::clamp(fraction, 0.0, 1.0)) /
                       static_cast<double>(std::max<std::size_t>(count, 1));
  const auto filled = static_cast<std::size_t>(share * kWidth);
  std::string line = fmt::format("\r\033[K[{}{}] {:3.0f} %", std::string(filled, '='),
                                 std::string(kWidth - filled, ' '), share * 100);
  if (count > 1) line += fmt::format("  {}/{}", index + 1, count);
  line += fmt::format("  {}", stage);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace curlidar::app
