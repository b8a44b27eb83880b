// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_inputs.hpp"
#include "decode_output.hpp"
#include "decode_plan.hpp"
#include "decode_sequence.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar decode scan.curl                        the scan as it was, in scan.decoded.pcd
  curlidar decode scan.curl --rows 8 -o dense.ply  8 times denser from top to bottom
  curlidar decode scan.curl --rows 1.5 --cols 0.5 -o other.npy
  curlidar decode scan.curl --density 400 -o even.ply    a point every 5 cm on every surface
  curlidar decode scan.curl --sensor os1-128 -o os1.pcd  as an OS-1-128 would have seen it
  curlidar decode scan.curl --directions rays.npy -o hits.npy
  curlidar decode scan.curl --rows 4 --mesh -o surface.obj
  curlidar decode vlp16.curl --preset sparse --confidence -o dense.pcd
  curlidar decode out/*.curl -o back/ --format bin --attributes intensity
  curlidar decode scan.curl --rings 16:48 --azimuth -45:45 -o ahead.pcd
  curlidar decode drive.curl --scan 12 -o one.pcd  a scan of a sequence, counted from 0
  curlidar decode drive.curl --scan 10:20 -o back/ scans 10 to 19; without --scan all of them
  curlidar decode cut.curl --allow-truncated       as far as the file goes
The format follows the extension of -o, or --format. KITTI .bin and nuScenes files hold fixed
attributes: choose them with --attributes. Depth images give the coded returns, one for one.)";

/// Says what helps if a file is refused only because its end is missing.
DecodedScan load(const Job& job, DecodeOptions decoding) {
  try {
    return load_curl(job.input, decoding);
  } catch (const Failure& failure) {
    if (decoding.allow_truncated || failure.code() != kExitInput || job.input == "-") throw;
    decoding.allow_truncated = true;
    if (!decode(need(read_file(job.input)), decoding)) throw;
    throw Failure({ErrorCode::corrupt,
                   fmt::format("{}; --allow-truncated decodes what is there", failure.what())},
                  kExitInput);
  }
}

/// One line, however much is missing.
std::string missing_text(const std::string& input, const std::vector<std::string>& missing) {
  constexpr std::size_t kNamed = 3;
  std::string text = fmt::format("{} is cut off and lacks {}", input, missing.front());
  for (std::size_t i = 1; i < std::min(missing.size(), kNamed); ++i) text += "; " + missing[i];
  if (missing.size() > kNamed) {
    text += fmt::format("; and {} more parts, see --json", missing.size() - kNamed);
  }
  return text;
}

int run(const DecodeCommand& command) {
  const DecodePlan plan(command);
  SequenceJobs sequences(command, plan);
  const std::vector<Job> jobs = sequences.plan_jobs();
  const auto decode_one = [&](const Job& job, const ProgressCallback& progress) {
    const auto start = DecodeClock::now();
    if (job.scan) {
      return write_decoded(job, sequences.decode(job), plan, start, progress);
    }
    const DecodedScan scan = load(job, plan.decoding());
    if (!scan.missing.empty()) print_warning(missing_text(job.input, scan.missing));
    return write_decoded(job, scan, plan, start, progress);
  };
  const int code = for_each_job(command.common, jobs, decode_one);
  const int whole = sequences.finish();
  return code != kExitOk ? code : whole;
}

}  // namespace

Command add_decode(CLI::App& root) {
  CLI::App* app = root.add_subcommand("decode", "Get clouds of any density back from .curl files");
  app->footer(kFooter);
  const auto command = std::make_shared<DecodeCommand>();
  add_decode_options(*app, *command);
  return {app, [command] { return run(*command); }};
}

}  // namespace curlidar::app
