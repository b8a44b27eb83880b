// SPDX-License-Identifier: BSD-3-Clause
#include "common_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <new>
#include <nlohmann/json.hpp>

#include "curlidar/map.hpp"
#include "curlidar/sequence.hpp"
#include "one_scan.hpp"

namespace curlidar::app {
namespace fs = std::filesystem;
namespace {

std::string normal(const std::string& path) {
  std::error_code error;
  const fs::path full = fs::weakly_canonical(path, error);
  return error ? path : full.string();
}

struct Failed {
  std::string message;
  ExitCode code;
};

/// Runs the body; whatever goes wrong becomes a message and a code.
std::optional<Failed> run_job(const JobBody& body, const Job& job, const ProgressCallback& progress,
                              Outcome& outcome) {
  const char* name = job.input == "-" ? "standard input" : job.input.c_str();
  try {
    outcome = body(job, progress);
    return std::nullopt;
  } catch (const Failure& failure) {
    const std::string message = failure.what();
    const bool named = message.find(name) != std::string::npos ||
                       (!job.output.empty() && message.find(job.output) != std::string::npos);
    return Failed{named ? message : fmt::format("{}: {}", name, message), failure.code()};
  } catch (const std::bad_alloc&) {
    return Failed{fmt::format("{}: not enough memory for this input", name), kExitInternal};
  }
}

}  // namespace

void make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw Failure(
        {ErrorCode::io, fmt::format("{}: cannot make this directory: {}", path, error.message())},
        kExitFile);
  }
}

void check_jobs(const std::vector<Job>& jobs) {
  std::map<std::string, const Job*> made;
  for (const Job& job : jobs) {
    if (job.output == "-") continue;
    const auto [place, first] = made.emplace(normal(job.output), &job);
    if (!first) {
      usage_error(
          fmt::format("{} and {} would both become {}: give them different names or "
                      "run them apart",
                      place->second->input, job.input, job.output));
    }
  }
  for (const Job& job : jobs) {
    if (job.input == "-") continue;
    const auto place = made.find(normal(job.input));
    if (place != made.end()) {
      usage_error(fmt::format("the output {} would replace the input {}: give another one with -o",
                              place->second->output, job.input));
    }
  }
}

bool is_directory(const std::string& path) {
  std::error_code error;
  return path.ends_with('/') || fs::is_directory(path, error);
}

std::string stem_of(const std::string& path) {
  if (path == "-") return "stdin";
  fs::path stem = fs::path(path).filename().stem();
  if (path.ends_with(".pcd.bin")) stem = stem.stem();
  return stem.string();
}

void refuse_same_file(const std::string& input, const std::string& output) {
  if (input == "-" || output == "-" || normal(input) != normal(output)) return;
  usage_error(fmt::format("the output {} would replace the input: give another name", output));
}

std::vector<Job> plan_jobs(const std::vector<std::string>& inputs, const std::string& output,
                           const std::string& suffix) {
  const bool directory = !output.empty() && output != "-" && is_directory(output);
  if (inputs.size() > 1 && !output.empty() && !directory) {
    std::error_code error;
    if (output == "-" || fs::exists(output, error)) {
      usage_error(fmt::format("-o {}: several inputs need a directory to go to", output));
    }
  }
  const bool into_directory = directory || (inputs.size() > 1 && !output.empty());
  std::vector<Job> jobs;
  for (const std::string& input : inputs) {
    const std::string name = stem_of(input) + suffix;
    if (output.empty()) {
      const std::string beside = (fs::path(input).parent_path() / name).string();
      jobs.push_back({input, input == "-" ? "-" : beside});
    } else if (into_directory) {
      jobs.push_back({input, (fs::path(output) / name).string()});
    } else {
      jobs.push_back({input, output});
    }
  }
  check_jobs(jobs);
  if (into_directory) make_directory(output);
  return jobs;
}

std::vector<Job> plan_jobs(const std::vector<std::string>& inputs) {
  std::vector<Job> jobs;
  for (const std::string& input : inputs) jobs.push_back({input, ""});
  return jobs;
}

int for_each_job(const CommonOptions& common, const std::vector<Job>& jobs, const JobBody& body) {
  const auto to_stdout = [](const Job& job) { return job.output == "-"; };
  const bool data_on_stdout = std::any_of(jobs.begin(), jobs.end(), to_stdout);
  if (data_on_stdout) refuse_mixed_stdout(common, "-");
  ProgressBar bar(!common.quiet);
  Json reports = Json::array();
  int code = kExitOk;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const ProgressCallback progress = [&](std::string_view stage, double fraction) {
      bar.update(i, jobs.size(), stage, fraction);
    };
    progress(jobs[i].input, 0);
    Outcome outcome;
    const std::optional<Failed> failed = run_job(body, jobs[i], progress, outcome);
    bar.clear();
    Json report = {{"input", jobs[i].input}};
    if (jobs[i].scan) report["scan"] = *jobs[i].scan;
    if (failed) {
      print_error(failed->message);
      if (code == kExitOk) code = failed->code;
      report["error"] = failed->message;
    } else {
      if (!jobs[i].output.empty()) report["output"] = jobs[i].output;
      report.update(outcome.json);
      if (code == kExitOk) code = outcome.code;
      if (!common.json) print_text(common, outcome.text, data_on_stdout);
    }
    reports.push_back(std::move(report));
  }
  if (common.json) {
    std::fputs(json_text(reports.size() == 1 ? reports.front() : reports).c_str(), stdout);
  }
  return code;
}

namespace {

DecodedScan load_scan_of_sequence(const std::string& path, DecodeOptions options,
                                  const std::optional<std::size_t>& scan) {
  SequenceReadOptions reading;
  reading.threads = options.threads;
  SequenceFile sequence = need(SequenceFile::open(path, reading));
  if (!scan) {
    throw Failure({ErrorCode::unsupported,
                   fmt::format("{} is a sequence of {} scans, and one is wanted: --scan K chooses "
                               "it, or 'curlidar decode {} --scan K' makes a cloud of it",
                               path, sequence.scans(), path)},
                  kExitInput);
  }
  Result<DecodedScan> decoded = sequence.decode(*scan, options);
  if (!decoded) {
    throw Failure({decoded.error().code, fmt::format("{}: {}", path, decoded.error().message)},
                  exit_code_of(decoded.error().code));
  }
  return *std::move(decoded);
}

}  // namespace

void refuse_many(const std::string& path, std::span<const std::byte> bytes) {
  const std::string name = path == "-" ? "standard input" : path;
  if (is_map(bytes)) {
    throw Failure({ErrorCode::unsupported,
                   fmt::format("{}: this is a map, not a scan: 'curlidar map extract' makes a "
                               "cloud of it, 'curlidar map --help' tells what else",
                               name)},
                  kExitInput);
  }
  if (is_sequence(bytes)) {
    throw Failure({ErrorCode::unsupported,
                   fmt::format("{}: this is a sequence, which is read from a file only", name)},
                  kExitInput);
  }
}

DecodedScan load_curl(const std::string& path, const DecodeOptions& options,
                      const std::optional<std::size_t>& scan) {
  if (path != "-" && is_sequence_file(path)) return load_scan_of_sequence(path, options, scan);
  const std::vector<std::byte> bytes = need(read_file(path));
  refuse_many(path, bytes);
  return need(decode(bytes, options));
}

Cloud load_cloud(const std::string& path, const std::optional<CloudFormat>& format,
                 const ReconstructSettings& reconstruct_settings,
                 const std::optional<std::size_t>& scan) {
  if (!format && path != "-" && is_sequence_file(path)) {
    return need(reconstruct(load_scan_of_sequence(path, {}, scan), reconstruct_settings));
  }
  const std::vector<std::byte> bytes = need(read_file(path));
  if (!format && is_curl(bytes)) {
    refuse_many(path, bytes);
    return need(reconstruct(need(decode(bytes)), reconstruct_settings));
  }
  ReadOptions options;
  options.format = format;
  return need(parse_cloud(bytes, path == "-" ? "standard input" : path, options));
}

void check_scan_choice(const std::optional<std::size_t>& scan,
                       const std::vector<std::string>& paths) {
  const auto is_one = [](const std::string& path) { return path != "-" && is_sequence_file(path); };
  if (!scan || std::any_of(paths.begin(), paths.end(), is_one)) return;
  usage_error(fmt::format("--scan chooses from a sequence, and {} is none", paths.front()));
}

void save_cloud(const std::string& path, const Cloud& cloud, WriteOptions options,
                const char* hint) {
  if (path == "-" && !options.format) options.format = CloudFormat::pcd;
  Status status = write_cloud(path, cloud, options);
  if (!status && status.error().code == ErrorCode::unsupported) {
    status = Error{ErrorCode::unsupported, status.error().message + hint};
  }
  need(status);
}

void keep_attributes(Cloud& cloud, const std::optional<std::vector<std::string>>& names) {
  if (!names) return;
  std::vector<Attribute> kept;
  for (const std::string& name : *names) {
    const Attribute* attribute = cloud.find(name);
    if (attribute == nullptr) {
      std::string known;
      for (const Attribute& a : cloud.attributes) known += (known.empty() ? "" : ", ") + a.name;
      throw Failure(
          {ErrorCode::invalid_argument, fmt::format("no attribute '{}'; this cloud has {}", name,
                                                    known.empty() ? "none" : known)},
          kExitInput);
    }
    kept.push_back(*attribute);
  }
  cloud.attributes = std::move(kept);
}

Detection detect(const Cloud& cloud, const std::optional<SensorProfile>& sensor) {
  return need(sensor ? assign_rings(cloud, *sensor) : detect_sensor(cloud));
}

void print_text(const CommonOptions& common, const std::string& text, bool to_stderr) {
  if (!common.quiet) std::fputs(text.c_str(), to_stderr ? stderr : stdout);
}

void print_result(const CommonOptions& common, const Outcome& outcome, bool to_stderr) {
  if (common.json) {
    std::fputs(json_text(outcome.json).c_str(), stdout);
  } else {
    print_text(common, outcome.text, to_stderr);
  }
}

void refuse_mixed_stdout(const CommonOptions& common, const std::string& output) {
  if (common.json && output == "-") {
    usage_error("--json reports on standard output: give the data another place with -o");
  }
}

}  // namespace curlidar::app
