// SPDX-License-Identifier: BSD-3-Clause
// What every command shares: common options, exit codes, errors on their way up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "curlidar/io.hpp"
#include "curlidar/project.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"

namespace CLI {
class App;
class FormatterBase;
class Option;
class Validator;
}  // namespace CLI

namespace curlidar::app {

/// What the process returns; every --help names them.
enum ExitCode : int {
  kExitOk = 0,
  kExitInternal = 1,  ///< out of memory, a defect
  kExitUsage = 2,     ///< the command line makes no sense
  kExitInput = 3,     ///< an input is damaged, not supported, or does not fit the request
  kExitFile = 4,      ///< a file is missing, or cannot be read or written
};

/// Options of every command.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::size_t threads = 0;  ///< 0 = all cores
};
void add_common_options(CLI::App& app, CommonOptions& common);

/// Help with descriptions wrapped to 100 columns.
std::shared_ptr<CLI::FormatterBase> help_formatter();
/// Accepts numbers of [min, max]; unlike CLI::Range it refuses NaN and leaves the help short.
CLI::Validator number_in(double min, double max);

/// A subcommand and what it does; run() returns the exit code.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

/// The library returns its errors as values. Above it they travel as this one exception, which is
/// caught in two places only: around each input, and in main.
class Failure : public std::runtime_error {
 public:
  Failure(Error error, ExitCode code) : std::runtime_error(error.message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// The exit code of an error met while working on an input.
ExitCode exit_code_of(ErrorCode code);

/// The value, or Failure.
template <class T>
T need(Result<T> result) {
  if (!result) throw Failure(result.error(), exit_code_of(result.error().code));
  return *std::move(result);
}
void need(Status status);

/// The value of something said on the command line, or Failure with kExitUsage.
template <class T>
T need_option(Result<T> result) {
  if (!result) throw Failure(result.error(), kExitUsage);
  return *std::move(result);
}
void need_option(Status status);
[[noreturn]] void usage_error(std::string message);

/// One line "curlidar: error: ..." on stderr.
void print_error(std::string_view message);
/// One line "curlidar: warning: ..." on stderr.
void print_warning(std::string_view message);

/// "2x4" or "2" (both the same). Whole numbers only if T is one. Values above zero.
template <class T>
struct RowsByColumns {
  T rows = 1, columns = 1;
};
RowsByColumns<std::uint32_t> parse_whole_factors(const std::string& text, const char* option);
RowsByColumns<double> parse_factors(const std::string& text, const char* option);

/// A positive number of metres, or "p90" for a percentile of range, or "max" for the sensor's own.
RangeLimit parse_range_limit(const std::string& text, const char* option);

/// "all" -> nullopt, "none" -> empty, "intensity,ring" -> those.
std::optional<std::vector<std::string>> parse_attribute_list(const std::string& text);

/// "uniform", "rings", or a number of uniform rows.
struct RowChoice {
  RowRule rule = RowRule::uniform;
  std::uint32_t rows = 0;  ///< 0 = the sensor's ring count
};
RowChoice parse_rows(const std::string& text, const char* option);

/// "auto" -> nullopt, otherwise a built-in name or the path of a profile.
std::optional<SensorProfile> parse_sensor(const std::string& text);
inline constexpr const char* kSensorHelp =
    "Sensor: auto, a built-in name (see 'curlidar sensors'), or a .toml or Ouster .json file";

/// Empty -> nullopt.
std::optional<CloudFormat> parse_format(const std::string& name);
inline constexpr const char* kFormatNames = "pcd, ply, kitti, nuscenes, npy or csv";

/// "ascii", "binary", "binary_compressed" or "binary_big_endian".
Encoding parse_encoding(const std::string& name);

}  // namespace curlidar::app
