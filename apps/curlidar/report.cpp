// SPDX-License-Identifier: BSD-3-Clause
// The report is made by Python programs that are installed beside the command; this finds and
// starts them.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"

namespace curlidar::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  curlidar report --quick                     minutes; without --quick much longer
  curlidar report -o mine scans/*.bin         only these scans, and the simulated scenes
  curlidar report --quick --simulated --check is every table complete and sane?
Writes index.html (one file, pictures inside), report.md, tables/*.csv, data/*.csv and what was
measured. The same command goes on where it was stopped. Needs python3 with numpy and matplotlib.
Real scans are looked for in the folder that CURLIDAR_DATA names. In a checkout run ./dev report,
which builds all it needs.)";

struct Options {
  std::vector<std::string> scans;
  std::string output = "report", sections;
  bool quick = false, simulated = false, all = false, check = false;
};

fs::path own_path() {
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/exe", error);
  if (error) {
    throw Failure({ErrorCode::io, "where this command lies cannot be told: " + error.message()},
                  kExitFile);
  }
  return path;
}

/// The folder with report.py: what CURLIDAR_REPORT_DIR names, or where it is installed.
fs::path programs_folder(const fs::path& own) {
  const char* named = std::getenv("CURLIDAR_REPORT_DIR");
  const fs::path folder = named != nullptr
                              ? fs::path(named)
                              : (own.parent_path() / CURLIDAR_REPORT_DATA).lexically_normal();
  std::error_code ignored;
  if (fs::is_regular_file(folder / "report.py", ignored)) return folder;
  throw Failure({ErrorCode::io,
                 fmt::format("the programs of the report are not in {}: they are installed with "
                             "builds that have CURLIDAR_BUILD_BENCH on; in a checkout run ./dev "
                             "report, or name bench/report in CURLIDAR_REPORT_DIR",
                             folder.string())},
                kExitFile);
}

/// The measuring programs are installed apart, or lie beside this command in a build tree.
void tell_where_programs_lie(const fs::path& own) {
  const fs::path apart = (own.parent_path() / CURLIDAR_REPORT_PROGRAMS).lexically_normal();
  std::error_code ignored;
  if (fs::is_regular_file(apart / "report_measure", ignored)) {
    setenv("CURLIDAR_REPORT_BIN", apart.c_str(), 0);
  }
  setenv("CURLIDAR", own.c_str(), 1);
  setenv("CURLIDAR_REPORT_NAME", "curlidar report", 1);
}

std::vector<std::string> command_line(const Options& options, const fs::path& folder) {
  std::vector<std::string> words{"python3", "-B", (folder / "report.py").string(), "--out",
                                 options.output};
  const auto add = [&](bool given, const char* name) {
    if (given) words.emplace_back(name);
  };
  add(options.quick, "--quick");
  add(options.simulated, "--simulated");
  add(options.all, "--all");
  add(options.check, "--check");
  if (!options.sections.empty()) words.insert(words.end(), {"--sections", options.sections});
  words.emplace_back("--");
  words.insert(words.end(), options.scans.begin(), options.scans.end());
  return words;
}

/// Becomes python3; comes back only with an error.
int run(const Options& options) {
  const fs::path own = own_path();
  std::vector<std::string> words = command_line(options, programs_folder(own));
  tell_where_programs_lie(own);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
  throw Failure({ErrorCode::io, fmt::format("python3, which makes the report, cannot be run: {}",
                                            std::strerror(errno))},
                kExitFile);
}

}  // namespace

Command add_report(CLI::App& root) {
  CLI::App* app = root.add_subcommand(
      "report", "Measure everything, beside other codecs, as one report with pictures");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("scans", options->scans,
                  "Scans, or folders of them; default one of every dataset and sensor in "
                  "CURLIDAR_DATA");
  app->add_option("-o,--out", options->output, "Directory of the report")->capture_default_str();
  app->add_flag("--quick", options->quick,
                "Three simulated scenes and at most one real scan, fewer settings");
  app->add_flag("--simulated", options->simulated, "No real scans");
  app->add_flag("--all", options->all, "Every scan of CURLIDAR_DATA");
  app->add_option("--sections", options->sections, "Only these, such as metrics,pictures");
  app->add_flag("--check", options->check,
                "Also check that the tables are complete and sane; exit code 1 if not");
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
