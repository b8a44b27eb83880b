// SPDX-License-Identifier: BSD-3-Clause
// Many inputs at once: where outputs go, how inputs are loaded, the loop around each of them.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common_options.hpp"
#include "common_report.hpp"
#include "curlidar/cloud.hpp"
#include "curlidar/reconstruct.hpp"

namespace curlidar::app {

/// One input and the file made from it (empty for commands that make none).
struct Job {
  std::string input, output;
  std::optional<std::size_t> scan{};  ///< of an input that is a sequence
};

/// Names the output of every input. `output` is what -o said: empty = beside the input, a
/// directory (existing, or ending in '/', or needed for several inputs; it is made), a file name,
/// or "-". The name is the input's with `suffix` (".curl", ".decoded.pcd") for its extension.
/// Failure(kExitUsage) if two inputs would make the same file or an output would replace an input.
std::vector<Job> plan_jobs(const std::vector<std::string>& inputs, const std::string& output,
                           const std::string& suffix);
/// Jobs of a command that makes no files.
std::vector<Job> plan_jobs(const std::vector<std::string>& inputs);

/// The same failures for jobs that were named otherwise.
void check_jobs(const std::vector<Job>& jobs);
/// Makes a folder and those above it; Failure(kExitFile).
void make_directory(const std::string& path);

/// Whether a name is that of a directory, existing or, by its last '/', to be made.
bool is_directory(const std::string& path);
/// "scans/0001.pcd.bin" -> "0001".
std::string stem_of(const std::string& path);
/// Failure(kExitUsage) if both names are one existing file; `output` must not replace `input`.
void refuse_same_file(const std::string& input, const std::string& output);

/// What an input gave: JSON for programs, text for people.
struct Outcome {
  Json json;
  std::string text;
  int code = 0;  ///< exit code that it means for the command
};
using JobBody = std::function<Outcome(const Job&, const ProgressCallback&)>;

/// Runs the body on each job, one after the other; an input that fails is reported and the others
/// go on. Prints text, or the JSON (an object for one input, an array for several) at the end.
/// Returns the exit code of the first failure.
int for_each_job(const CommonOptions& common, const std::vector<Job>& jobs, const JobBody& body);

/// A cloud file, or a .curl file decoded at rows x columns times its own lattice. Of a sequence the
/// given scan; Failure without one. `scan` means nothing to other files.
Cloud load_cloud(const std::string& path, const std::optional<CloudFormat>& format,
                 const ReconstructSettings& reconstruct_settings = {},
                 const std::optional<std::size_t>& scan = {});
/// A .curl file; of a sequence the given scan.
DecodedScan load_curl(const std::string& path, const DecodeOptions& options = {},
                      const std::optional<std::size_t>& scan = {});
/// Failure(kExitUsage) if a scan is chosen and none of the files is a sequence.
void check_scan_choice(const std::optional<std::size_t>& scan,
                       const std::vector<std::string>& paths);
inline constexpr const char* kScanHelp = "Of a sequence: which scan, counted from 0";

/// Writes a cloud; "-" without a format is PCD. `hint` is what to do when the format cannot hold
/// it.
void save_cloud(const std::string& path, const Cloud& cloud, WriteOptions options,
                const char* hint = "");
inline constexpr const char* kAttributesHint = " (--attributes none, or the names to keep)";

/// Keeps the named attributes only (nullopt: all). A name that the cloud lacks is a Failure.
void keep_attributes(Cloud& cloud, const std::optional<std::vector<std::string>>& names);

/// The given profile's rings, or the detected ones.
Detection detect(const Cloud& cloud, const std::optional<SensorProfile>& sensor);

/// Text that a command prints when all is done, honouring --quiet. `to_stderr` when data went to
/// standard output.
void print_text(const CommonOptions& common, const std::string& text, bool to_stderr = false);
/// The report of a command that has one result, not one for each input.
void print_result(const CommonOptions& common, const Outcome& outcome, bool to_stderr = false);
/// Failure(kExitUsage) if both data and the JSON report would go to standard output.
void refuse_mixed_stdout(const CommonOptions& common, const std::string& output);

}  // namespace curlidar::app
