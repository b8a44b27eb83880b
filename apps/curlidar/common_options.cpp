// SPDX-License-Identifier: BSD-3-Clause
#include "common_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace curlidar::app {
namespace {

template <class T>
bool parse_whole_text(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

template <class T>
RowsByColumns<T> parse_pair(const std::string& text, const char* option, const char* kind) {
  RowsByColumns<T> pair;
  const std::size_t cross = text.find('x');
  const std::string_view rows = std::string_view(text).substr(0, cross);
  const std::string_view columns =
      cross == std::string::npos ? rows : std::string_view(text).substr(cross + 1);
  // Infinity fails the upper bound, NaN both.
  const bool good = parse_whole_text(rows, pair.rows) && parse_whole_text(columns, pair.columns) &&
                    pair.rows > 0 && pair.columns > 0 && pair.rows <= 65536 &&
                    pair.columns <= 65536;
  if (!good) {
    usage_error(
        fmt::format("{} '{}': give ROWSxCOLUMNS, two {} above 0, such as 2x2", option, text, kind));
  }
  return pair;
}

class WrappingFormatter : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::size_t width = 100 - get_column_width();
    std::string wrapped;
    std::size_t line = 0;
    std::istringstream words(CLI::Formatter::make_option_desc(option));
    for (std::string word; words >> word; line += word.size()) {
      if (line == 0) {
        wrapped += word;
      } else if (line + 1 + word.size() <= width) {
        wrapped += ' ' + word;
        ++line;
      } else {
        wrapped += '\n' + word;
        line = 0;
      }
    }
    return wrapped;
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() {
  const auto formatter = std::make_shared<WrappingFormatter>();
  formatter->column_width(30);
  return formatter;
}

CLI::Validator number_in(double min, double max) {
  const auto check = [min, max](const std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= min && value <= max) return {};
    return fmt::format("'{}' is not a number from {:g} to {:g}", text, min, max);
  };
  return CLI::Validator(check, "");
}

void add_common_options(CLI::App& app, CommonOptions& common) {
  app.add_flag("--json", common.json, "Machine-readable report on standard output, nothing else")
      ->group("Common");
  app.add_option("--threads", common.threads, "Threads; 0 = all cores. Never changes the result")
      ->capture_default_str()
      ->check(number_in(0, 1024))
      ->group("Common");
  app.add_flag("-q,--quiet", common.quiet, "No report and no progress, only errors")
      ->group("Common");
}

ExitCode exit_code_of(ErrorCode code) {
  return code == ErrorCode::io || code == ErrorCode::not_found ? kExitFile : kExitInput;
}

void need(Status status) {
  if (!status) throw Failure(status.error(), exit_code_of(status.error().code));
}

void need_option(Status status) {
  if (!status) throw Failure(status.error(), kExitUsage);
}

void usage_error(std::string message) {
  throw Failure({ErrorCode::invalid_argument, std::move(message)}, kExitUsage);
}

void print_error(std::string_view message) {
  const std::string line = fmt::format("curlidar: error: {}\n", message);
  std::fputs(line.c_str(), stderr);
}

void print_warning(std::string_view message) {
  const std::string line = fmt::format("curlidar: warning: {}\n", message);
  std::fputs(line.c_str(), stderr);
}

RowsByColumns<std::uint32_t> parse_whole_factors(const std::string& text, const char* option) {
  return parse_pair<std::uint32_t>(text, option, "whole numbers");
}

RowsByColumns<double> parse_factors(const std::string& text, const char* option) {
  return parse_pair<double>(text, option, "numbers");
}

RangeLimit parse_range_limit(const std::string& text, const char* option) {
  RangeLimit limit;
  if (text == "max") return limit;
  const bool percentile = !text.empty() && text.front() == 'p';
  double value = 0;
  const bool good = parse_whole_text(std::string_view(text).substr(percentile ? 1 : 0), value) &&
                    value > 0 && value <= (percentile ? 100 : 1e6);
  if (!good) {
    usage_error(
        fmt::format("{} '{}': give metres (80), a percentile of range (p90) or max", option, text));
  }
  (percentile ? limit.percentile : limit.metres) = value;
  return limit;
}

std::optional<std::vector<std::string>> parse_attribute_list(const std::string& text) {
  if (text == "all") return std::nullopt;
  std::vector<std::string> names;
  if (text == "none") return names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    if (comma == start) {
      usage_error(
          fmt::format("--attributes '{}': give all, none, or names such as intensity,ring", text));
    }
    names.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return names;
}

RowChoice parse_rows(const std::string& text, const char* option) {
  RowChoice choice;
  if (text == "uniform") return choice;
  if (text == "rings") {
    choice.rule = RowRule::rings;
    return choice;
  }
  if (!parse_whole_text(text, choice.rows) || choice.rows == 0 || choice.rows > 65536) {
    usage_error(fmt::format("{} '{}': give uniform, rings or a number of rows", option, text));
  }
  return choice;
}

std::optional<SensorProfile> parse_sensor(const std::string& text) {
  if (text == "auto") return std::nullopt;
  return need_option(load_sensor(text));
}

std::optional<CloudFormat> parse_format(const std::string& name) {
  if (name.empty()) return std::nullopt;
  return need_option(cloud_format_by_name(name));
}

Encoding parse_encoding(const std::string& name) {
  if (name == "ascii") return Encoding::ascii;
  if (name == "binary") return Encoding::binary;
  if (name == "binary_compressed") return Encoding::binary_compressed;
  if (name == "binary_big_endian") return Encoding::binary_big_endian;
  usage_error(fmt::format(
      "--encoding '{}': give ascii, binary, binary_compressed (PCD) or binary_big_endian (PLY)",
      name));
}

}  // namespace curlidar::app
