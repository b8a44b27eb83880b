// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "encode_plan.hpp"
#include "encode_report.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar encode scan.pcd                        makes scan.curl beside it, 5 cm mean error
  curlidar encode scans/*.bin -o out/ --error 0.02
  curlidar encode scan.pcd --max-error 0.02      every point within 2 cm, as 'verify' proves
  curlidar encode scan.pcd --lossless
  curlidar encode scan.bin --sensor hdl64e-kitti --attributes none --bits 1 --effort 9
  curlidar encode - --format pcd <scan.pcd >scan.curl
  curlidar encode scans/*.bin --sequence -o drive.curl --times times.txt
  curlidar encode room.pcd --profile paper --preset indoor --upsample 1x1 -o room.curl
Every return is kept, in its place, with its attributes, unless --cols, --min-range or --max-range
ask for a depth image.
With --attributes none the file holds geometry only, and no metadata but those of --meta.
The order is: preset, then what the profile changes, then the options given here.)";

int run(const EncodeCommand& command) {
  encode_settings(command, {});  // wrong usage shows before a scan is read
  if (command.sequence.sequence) return run_encode_sequence(command);
  refuse_poses(command.sequence.poses);
  const auto metadata = parse_metadata(command.metadata);
  const auto format = parse_format(command.format);
  refuse_coded(command.inputs);
  const std::vector<Job> jobs = plan_jobs(command.inputs, command.output, ".curl");
  return for_each_job(command.common, jobs, [&](const Job& job, const ProgressCallback& progress) {
    ReadOptions read_options;
    read_options.format = format;
    Cloud cloud = need(read_cloud(job.input, read_options));
    const EncodeSettings settings = encode_settings(command, cloud);
    set_metadata(metadata, settings, job.input, cloud);
    const std::string preset = command.paper.preset(cloud);
    const Encoded encoded = need(encode(cloud, settings, progress));
    need(write_file(job.output, encoded.bytes));
    return Outcome{encode_json(encoded.report, settings.profile, preset),
                   jobs.size() == 1 ? encode_text(job, encoded.report, settings.profile, preset)
                                    : encode_line(job, encoded.report)};
  });
}

}  // namespace

Command add_encode(CLI::App& root) {
  CLI::App* app = root.add_subcommand("encode", "Code scans into small continuous .curl files");
  app->footer(kFooter);
  const auto command = std::make_shared<EncodeCommand>();
  add_encode_options(*app, *command);
  return {app, [command] { return run(*command); }};
}

}  // namespace curlidar::app
