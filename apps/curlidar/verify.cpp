// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/verify.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "common_compact.hpp"
#include "common_inputs.hpp"
#include "common_scans.hpp"
#include "decode_sequence.hpp"
#include "one_scan.hpp"

namespace curlidar::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  curlidar encode scan.pcd --max-error 0.02 && curlidar verify scan.curl scan.pcd
  curlidar verify scan.curl scan.pcd --json
  curlidar verify drive.curl scans/              every scan of a sequence
Every return of SCAN is compared with its own decoded one, in the order of the file; so are empty
slots, shape and the attributes that FILE holds. FILE keeps what it was promised to hold: a bound
on every point, or the same bits. Of files made with --any-order the returns are compared as sets,
each with the nearest of the other, and attributes by their values.
Exit code 3 if anything is not as promised.)";

struct Options {
  CommonOptions common;
  std::string file, format, chosen;
  std::vector<std::string> scans;
};

Json verification_json(const std::string& file, const std::string& scan, const Verification& v) {
  return {{"file", file},
          {"scan", scan},
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

std::string verification_text(const std::string& file, const std::string& scan,
                              const Verification& v) {
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
  std::string text = fmt::format("{} against {}\n{}", file, scan, table.text());
  for (const std::string& name : v.attributes_left_out) {
    text += fmt::format("The file was made without the attribute '{}'.\n", name);
  }
  for (const std::string& failure : v.failures) text += "FAILED: " + failure + "\n";
  return text + (v.ok ? "ok\n" : "");
}

int verify_file(const Options& options, const ReadOptions& reading) {
  const std::string& scan = options.scans.front();
  if (options.scans.size() > 1) {
    usage_error(fmt::format("{} is a file of one scan: give that one", options.file));
  }
  if (!options.chosen.empty()) {
    usage_error(fmt::format("--scan chooses from a sequence, and {} is none", options.file));
  }
  if (options.file == "-" && scan == "-") usage_error("only one of them can be '-'");
  const Cloud cloud = need(read_cloud(scan, reading));
  const auto bytes = need(read_file(options.file));
  refuse_many(options.file, bytes);
  Result<Verification> result = verify(bytes, cloud, options.common.threads);
  if (!result) {
    throw Failure({result.error().code, options.file + ": " + result.error().message}, kExitInput);
  }
  print_result(options.common,
               {verification_json(options.file, scan, *result),
                verification_text(options.file, scan, *result)},
               false);
  return result->ok ? kExitOk : kExitInput;
}

/// A scan of a sequence that nobody could decode is one that does not come back.
Verification verify_scan(SequenceFile& sequence, std::size_t number, const Cloud& cloud,
                         std::size_t threads) {
  const auto decoded = sequence.decode(number);
  if (decoded) {
    if (auto result = verify(*decoded, cloud, threads)) return *std::move(result);
  }
  Verification lost;
  lost.failures.push_back(decoded ? verify(*decoded, cloud, threads).error().message
                                  : decoded.error().message);
  return lost;
}

/// Each scan against its own; they are read and decoded one after the other.
int verify_sequence(const Options& options, const ReadOptions& reading) {
  SequenceReadOptions opening;
  opening.threads = options.common.threads;
  SequenceFile sequence = need(SequenceFile::open(options.file, opening));
  const ScanInterval chosen = parse_scans(options.chosen, sequence.scans(), options.file);
  const std::vector<std::string> scans = list_scans(options.scans);
  if (scans.size() != chosen.end - chosen.begin) {
    throw Failure({ErrorCode::invalid_argument,
                   fmt::format("{} scans are to be compared with {} of {}: give as many, or choose "
                               "with --scan",
                               scans.size(), chosen.end - chosen.begin, options.file)},
                  kExitInput);
  }
  Json reports = Json::array();
  Table table;
  table.add(
      {"scan", "points", "largest error", "mean error", "same bits", "order", "attributes", ""});
  std::string failures;
  bool ok = true;
  ProgressBar bar(!options.common.quiet);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    bar.update(i, scans.size(), scans[i], 0);
    const std::size_t number = chosen.begin + i;
    const Verification v =
        verify_scan(sequence, number, need(read_cloud(scans[i], reading)), options.common.threads);
    ok = ok && v.ok;
    Json report = verification_json(options.file, scans[i], v);
    report["number"] = number;
    reports.push_back(std::move(report));
    const auto yes = [](bool value) { return value ? "yes" : "no"; };
    table.add({std::to_string(number), count_text(v.points), length_text(v.max_error_m),
               length_text(v.mean_error_m), yes(v.bit_exact),
               v.promise.any_order ? "given up" : yes(v.order), yes(v.attributes),
               v.ok ? "ok" : "FAILED"});
    for (const std::string& failure : v.failures) {
      failures += fmt::format("FAILED: scan {}, {}: {}\n", number, scans[i], failure);
    }
  }
  bar.clear();
  print_result(options.common,
               {Json{{"file", options.file}, {"ok", ok}, {"scans", std::move(reports)}},
                fmt::format("{} against {} scans\n{}{}{}", options.file, scans.size(), table.text(),
                            failures, ok ? "ok\n" : "")},
               false);
  return ok ? kExitOk : kExitInput;
}

int run(const Options& options) {
  ReadOptions reading;
  reading.format = parse_format(options.format);
  return options.file != "-" && is_sequence_file(options.file) ? verify_sequence(options, reading)
                                                               : verify_file(options, reading);
}

}  // namespace

Command add_verify(CLI::App& root) {
  CLI::App* app = root.add_subcommand("verify", "Prove that a file gives a scan back as promised");
  app->footer(kFooter);
  const auto options = std::make_shared<Options>();
  app->add_option("FILE", options->file, ".curl file with every return; - is standard input")
      ->required();
  app->add_option("SCAN", options->scans,
                  "The scan that it was made of; of a sequence all its scans, or their folder")
      ->required();
  app->add_option("--scan", options->chosen, "Of a sequence: scan K, or scans BEGIN .. END-1")
      ->type_name("K|BEGIN:END");
  app->add_option("--format", options->format,
                  fmt::format("Format of the scan: {}; default by content", kFormatNames));
  add_common_options(*app, options->common);
  return {app, [options] { return run(*options); }};
}

}  // namespace curlidar::app
