// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "commands.hpp"
#include "curlidar/io.hpp"
#include "curlidar/version.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Try it:
  curlidar demo                            simulates a street and shows all of it in demo-out/
  curlidar encode scan.pcd                 makes scan.curl
  curlidar decode scan.curl --rows 8 -o dense.ply
  curlidar verify scan.curl scan.pcd       proves that the file keeps what it promises
  curlidar compare scan.pcd scan.curl      how far apart they are, both ways
  curlidar map build scans/ --poses poses.txt -o street.curl
                                           the surface that many scans have seen, in one file

'-' reads standard input or writes standard output. 'curlidar COMMAND --help' says more.
Exit codes: 0 done, 1 internal failure (out of memory), 2 wrong usage, 3 an input is damaged,
unsupported or does not fit the request, 4 a file is missing or cannot be read or written.
With several inputs the others are still done; the code is that of the first failure.)";

std::vector<Command> add_commands(CLI::App& root) {
  std::vector<Command> commands;
  for (auto* add : {add_encode, add_decode, add_verify, add_info, add_compare, add_render,
                    add_convert, add_project, add_mesh, add_upsample, add_simulate, add_sensors,
                    add_calibrate, add_demo, add_register, add_map, add_report}) {
    commands.push_back(add(root));
  }
  return commands;
}

/// A first word that is no command deserves to be named: CLI11 only says that a command is missing.
void refuse_unknown_command(const std::vector<Command>& commands, const std::string& word) {
  const auto has_name = [&](const Command& command) { return command.app->get_name() == word; };
  if (word.starts_with('-') || std::any_of(commands.begin(), commands.end(), has_name)) return;
  usage_error(fmt::format("'{}' is no command (see 'curlidar --help')", word));
}

int parse_and_run(int argc, char** argv) {
  CLI::App root{"Continuous, compact representation of LiDAR scans", "curlidar"};
  root.set_version_flag("--version", std::string("curlidar ") + version());
  root.require_subcommand(1);
  root.formatter(help_formatter());
  root.footer(kFooter);
  const std::vector<Command> commands = add_commands(root);
  if (argc < 2) {
    std::fputs(root.help().c_str(), stderr);
    return kExitUsage;
  }
  refuse_unknown_command(commands, argv[1]);
  const Command* chosen = nullptr;
  try {
    root.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return root.exit(error);  // --help, --version
    const std::vector<CLI::App*> parsed = root.get_subcommands();
    const std::string name = parsed.empty() ? "" : parsed.front()->get_name() + " ";
    print_error(fmt::format("{} (see 'curlidar {}--help')", error.what(), name));
    return kExitUsage;
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) chosen = &command;
  }
  return chosen != nullptr ? chosen->run() : kExitUsage;
}

/// Everything that can be thrown ends here, as one line and an exit code.
int guarded(int argc, char** argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const Failure& failure) {
    print_error(failure.what());
    return failure.code();
  } catch (const std::bad_alloc&) {
    print_error("not enough memory");
  } catch (const std::exception& error) {
    print_error(fmt::format("internal failure: {}", error.what()));
  }
  return kExitInternal;
}

}  // namespace
}  // namespace curlidar::app

int main(int argc, char** argv) {
  curlidar::remove_temporary_files_on_signals();
  const int code = curlidar::app::guarded(argc, argv);
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (!written && code == 0) {
    curlidar::app::print_error("standard output could not be written (disk full?)");
    return curlidar::app::kExitFile;
  }
  return code;
}
