// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/verify.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_compact.hpp"
#include "common_inputs.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar encode scan.pcd --max-error 0.02 && curlidar verify scan.curl scan.pcd
  curlidar verify scan.curl scan.pcd --json
Every return of SCAN is compared with its own decoded one, in the order of the file; so are empty
slots, shape and the attributes that FILE holds. FILE keeps what it was promised to hold: a bound
on every point, or the same bits. Of files made with --any-order the returns are compared as sets,
each with the nearest of the other, and attributes by their values.
Exit code 3 if anything is not as promised.)";

struct Options {
  CommonOptions common;
  std::string file, scan, format;
};

Json verification_json(const Options& options, const Verification& v) {
  return {{"file", options.file},
          {"scan", options.scan},
          {"ok", v.ok},
          {"points", v.points},
          {"max_error_m", v.max_error_m},
          {"mean_error_m", v.mean_error_m},
          {"rms_error_m", v.rms_error_m},
          {"bound_m", v.promise.bound_m > 0 ? Json(v.promise.bound_m) : Json()},
          {"bit_exact_promised", v.promise.bit_exact},
          {"bit_exact", v.bit_exact},
          {"order", v.order},
          {"order_promised", !v.promise.any_order},
          {"shape", v.shape},
          {"attributes", v.attributes},
          {"attributes_left_out", v.attributes_left_out},
          {"failures", v.failures}};
}

std::string verification_text(const Options& options, const Verification& v) {
  const auto yes = [](bool value) { return value ? "yes" : "NO"; };
  const auto in_order = [&](bool value) {
    return v.promise.any_order ? "given up when encoding" : yes(value);
  };
  Table table;
  table.add({"points", count_text(v.points)});
  table.add({"promise", promise_text(v.promise)});
  table.add({"largest error", length_text(v.max_error_m)});
  table.add({"mean error", length_text(v.mean_error_m)});
  table.add({"same bits", v.bit_exact ? "yes" : "no"});
  table.add({"order kept", in_order(v.order)});
  table.add({"shape kept", in_order(v.shape)});
  table.add({"attributes kept", yes(v.attributes)});
  std::string text = fmt::format("{} against {}\n{}", options.file, options.scan, table.text());
  for (const std::string& name : v.attributes_left_out) {
    text += fmt::format("The file was made without the attribute '{}'.\n", name);
  }
  for (const std::string& failure : v.failures) text += "FAILED: " + failure + "\n";
  return text + (v.ok ? "ok\n" : "");
}

int run(const Options& options) {
  if (options.file == "-" && options.scan == "-") usage_error("only one of them can be '-'");
  ReadOptions read_options;
  read_options.format = parse_format(options.format);
  const Cloud cloud = need(read_cloud(options.scan, read_options));
  const auto bytes = need(read_file(options.file));
  Result<Verification> result = verify(bytes, cloud, options.common.threads);
  if (!result) {
    throw Failure({result.error().code, options.file + ": " + result.error().message}, kExitInput);
  }
  print_result(options.common,
               {verification_json(options, *result), verification_text(options, *result)}, false);
  return result->ok ? kExitOk : kExitInput;
}

}  // namespace

Command add_verify(CLI::App& root) {
  CLI::App* app = root.add_subcommand("verify", "Prove that a file gives a scan back as promised");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("FILE", options->file, ".curl file with every return; - is standard input")
      ->required();
  app->add_option("SCAN", options->scan, "The scan that it was made of")->required();
  app->add_option("--format", options->format,
                  fmt::format("Format of the scan: {}; default by content", kFormatNames));
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
