// SPDX-License-Identifier: BSD-3-Clause
#include "decode_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace curlidar::app {
namespace fs = std::filesystem;
namespace {

std::size_t parse_number(const std::string& text, const std::string& whole) {
  std::size_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc() && stop == end) return number;
  usage_error(
      fmt::format("--scan '{}': give a scan, counted from 0, or BEGIN:END, such as 10:20 "
                  "for scans 10 to 19",
                  whole));
}

/// "000012.pcd" for ".decoded.pcd".
std::string numbered(std::size_t scan, const std::string& suffix) {
  constexpr std::string_view kDecoded = ".decoded";
  return fmt::format("{:06}{}", scan,
                     suffix.starts_with(kDecoded) ? suffix.substr(kDecoded.size()) : suffix);
}

}  // namespace

ScanInterval parse_scans(const std::string& text, std::size_t scans, const std::string& path) {
  if (text.empty()) return {0, scans};
  const std::size_t colon = text.find(':');
  ScanInterval interval;
  if (colon == std::string::npos) {
    interval.begin = parse_number(text, text);
    interval.end = interval.begin + 1;
  } else {
    const std::string begin = text.substr(0, colon), end = text.substr(colon + 1);
    interval.begin = begin.empty() ? 0 : parse_number(begin, text);
    interval.end = end.empty() ? std::max(scans, interval.begin) : parse_number(end, text);
    if (!end.empty() && interval.begin >= interval.end) {
      usage_error(
          fmt::format("--scan '{}': the end is not included, so that it must be beyond the "
                      "beginning",
                      text));
    }
  }
  if (interval.begin < scans && interval.end <= scans) return interval;
  throw Failure({ErrorCode::invalid_argument,
                 fmt::format("{}: --scan {}: it has {} scans, counted from 0", path, text, scans)},
                kExitInput);
}

SequenceFile& SequenceJobs::file(const std::string& path) {
  if (!open_ || open_path_ != path) {
    SequenceReadOptions options;
    options.threads = command_.common.threads;
    options.allow_truncated = command_.allow_truncated;
    Result<SequenceFile> opened = SequenceFile::open(path, options);
    if (!opened && !command_.allow_truncated) {
      options.allow_truncated = true;
      if (SequenceFile::open(path, options)) {
        throw Failure(
            {ErrorCode::corrupt,
             fmt::format("{}; --allow-truncated decodes what is there", opened.error().message)},
            kExitInput);
      }
    }
    open_.emplace(need(std::move(opened)));
    open_path_ = path;
  }
  return *open_;
}

void SequenceJobs::plan_scans(const std::string& path, std::vector<Job>& jobs) {
  const SequenceFile& sequence = file(path);
  for (const std::string& missing : sequence.missing()) {
    missing_.push_back(fmt::format("{}: {}", path, missing));
  }
  const ScanInterval scans = parse_scans(command_.scan, sequence.scans(), path);
  const bool one = !command_.scan.empty() && command_.scan.find(':') == std::string::npos;
  const std::string& output = command_.output;
  if (one && command_.inputs.size() == 1 && !is_directory(output)) {
    const std::string beside =
        (fs::path(path).parent_path() /
         fmt::format("{}.{:06}{}", stem_of(path), scans.begin, plan_.suffix()))
            .string();
    jobs.push_back({path, output.empty() ? beside : output, scans.begin});
    return;
  }
  std::error_code error;
  if (output == "-" || (!output.empty() && fs::exists(output, error) && !is_directory(output))) {
    usage_error(fmt::format("-o {}: several scans need a directory to go to", output));
  }
  fs::path folder = fs::path(path).parent_path() / (stem_of(path) + ".decoded");
  if (!output.empty()) {
    folder = command_.inputs.size() == 1 ? fs::path(output) : fs::path(output) / stem_of(path);
  }
  for (std::size_t k = scans.begin; k < scans.end; ++k) {
    jobs.push_back({path, (folder / numbered(k, plan_.suffix())).string(), k});
  }
}

std::vector<Job> SequenceJobs::plan_jobs() {
  const auto count = static_cast<std::size_t>(
      std::count_if(command_.inputs.begin(), command_.inputs.end(),
                    [](const std::string& path) { return path != "-" && is_sequence_file(path); }));
  if (count == 0) {
    if (!command_.scan.empty()) {
      usage_error(
          fmt::format("--scan chooses from a sequence, and {} is none", command_.inputs.front()));
    }
    return app::plan_jobs(command_.inputs, command_.output, plan_.suffix());
  }
  if (count != command_.inputs.size()) {
    usage_error("decode sequences and files of one scan apart from each other");
  }
  std::vector<Job> jobs;
  for (const std::string& path : command_.inputs) plan_scans(path, jobs);
  check_jobs(jobs);
  std::string made;
  for (const Job& job : jobs) {
    const std::string folder = fs::path(job.output).parent_path().string();
    const bool named =
        jobs.size() == 1 && !command_.output.empty() && !is_directory(command_.output);
    if (folder.empty() || folder == made || named) continue;
    make_directory(folder);
    made = folder;
  }
  return jobs;
}

DecodedScan SequenceJobs::decode(const Job& job) {
  Result<DecodedScan> scan = file(job.input).decode(*job.scan, plan_.decoding());
  if (!scan) {
    throw Failure({scan.error().code,
                   fmt::format("{}: scan {}: {}", job.input, *job.scan, scan.error().message)},
                  exit_code_of(scan.error().code));
  }
  return *std::move(scan);
}

int SequenceJobs::finish() const {
  for (const std::string& missing : missing_) print_warning(missing);
  return missing_.empty() ? kExitOk : kExitInput;
}

}  // namespace curlidar::app
