// SPDX-License-Identifier: BSD-3-Clause
// What prediction saves: codes scans one by one and each from the one before, at the same mean
// error, and prints bytes, bits a return, errors and CPU time of both.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/predicted.hpp"
#include "given_scan.hpp"

namespace curlidar {
namespace {

struct Options {
  std::vector<std::string> scans;
  double error_m = 0.05;
  std::uint32_t effort = 4, group = 10, columns = 0;
  bool still = false, parts = false;
};

struct Measured {
  double bytes = 0, error_m = 0, seconds = 0;
  CompactBreakdown parts;
  DecodedScan scan;
};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

EncodeSettings settings_of(const Options& options) {
  EncodeSettings settings;
  settings.attributes.emplace();
  settings.compact.target = CompactTarget::error;
  settings.compact.target_value = options.error_m;
  settings.compact.effort = options.effort;
  settings.compact.index = false;
  if (options.columns > 0) settings.compact.columns = options.columns;
  return settings;
}

std::optional<Measured> take(const Result<Encoded>& encoded, double start,
                             const std::shared_ptr<const PredictionReference>& reference) {
  if (!encoded) {
    fmt::print(stderr, "{}\n", encoded.error().message);
    return std::nullopt;
  }
  Measured out;
  out.seconds = cpu_seconds() - start;
  out.bytes = static_cast<double>(encoded->bytes.size());
  out.error_m = encoded->report.compact->mean_error_m;
  out.parts = encoded->report.compact->breakdown;
  DecodeOptions decoding;
  decoding.reference = reference;
  Result<DecodedScan> scan = decode(encoded->bytes, decoding);
  if (!scan) {
    fmt::print(stderr, "{}\n", scan.error().message);
    return std::nullopt;
  }
  out.scan = *std::move(scan);
  return out;
}

void print_parts(const char* what, const CompactBreakdown& b) {
  fmt::print(
      "    {:<10} header {:.0f}, mask {:.0f}, partition {:.0f}, modes {:.0f}, coefficients "
      "{:.0f}, labels {:.0f}, residual {:.0f}, records {:.0f} B\n",
      what, b.header / 8, b.mask / 8, b.partition / 8, b.modes / 8, b.coefficients / 8,
      b.labels / 8, b.residual / 8, b.records / 8);
}

int run(const Options& options) {
  const EncodeSettings settings = settings_of(options);
  std::shared_ptr<const PredictionReference> reference;
  Measured single, sequence, later_single, later_sequence;
  double returns = 0;
  const auto add = [](Measured& sum, const Measured& one) {
    sum.bytes += one.bytes;
    sum.error_m += one.error_m;
    sum.seconds += one.seconds;
  };
  std::uint32_t number = 0;
  for (const std::string& path : options.scans) {
    Result<Cloud> cloud = bench::given_scan(path);
    if (!cloud) {
      fmt::print(stderr, "{}: {}\n", path, cloud.error().message);
      return 3;
    }
    returns += static_cast<double>(count_returns(*cloud));
    double start = cpu_seconds();
    auto alone = take(encode(*cloud, settings), start, nullptr);
    if (!alone) return 1;
    add(single, *alone);
    Measured* best = &*alone;
    std::optional<Measured> predicted;
    if (number++ % options.group != 0) {
      start = cpu_seconds();
      predicted = take(encode_predicted(*cloud, settings, reference, {options.still, {}}), start,
                       reference);
      if (!predicted) return 1;
      best = &*predicted;
      add(later_single, *alone);
      add(later_sequence, *predicted);
    }
    add(sequence, *best);
    fmt::print("{}: {:.0f} B, {:.4f} m, {:.2f} s", path, alone->bytes, alone->error_m,
               alone->seconds);
    if (predicted) {
      fmt::print("; predicted {:.0f} B ({:+.1f} %), {:.4f} m, {:.2f} s", predicted->bytes,
                 100 * (predicted->bytes / alone->bytes - 1), predicted->error_m,
                 predicted->seconds);
    }
    fmt::print("\n");
    if (options.parts) {
      print_parts("alone", alone->parts);
      if (predicted) print_parts("predicted", predicted->parts);
    }
    auto next = PredictionReference::of(best->scan);
    if (!next) return 1;
    reference = *next;
  }
  const auto count = static_cast<double>(options.scans.size());
  fmt::print(
      "all: {:.0f} B = {:.4f} b a return, {:.5f} m; as a sequence {:.0f} B = {:.4f} b a "
      "return ({:+.1f} %), {:.5f} m\n",
      single.bytes, 8 * single.bytes / returns, single.error_m / count, sequence.bytes,
      8 * sequence.bytes / returns, 100 * (sequence.bytes / single.bytes - 1),
      sequence.error_m / count);
  if (later_single.bytes > 0) {
    fmt::print("predicted ones: {:+.1f} % bytes, {:.2f} x the time\n",
               100 * (later_sequence.bytes / later_single.bytes - 1),
               later_sequence.seconds / later_single.seconds);
  }
  return 0;
}

}  // namespace
}  // namespace curlidar

int main(int argc, char** argv) {
  curlidar::Options options;
  CLI::App app("What prediction from scan to scan saves");
  app.add_option("scans", options.scans,
                 "Scans in their order: files, or sim:SCENE:SENSOR:NUMBER:X_M:YAW_DEG")
      ->required();
  app.add_option("--error", options.error_m, "Mean error, metres");
  app.add_option("--effort", options.effort, "1..9");
  app.add_option("--group", options.group, "Scans of which only the first is coded alone");
  app.add_option("--cols", options.columns, "A grid of so many columns; 0 = every return");
  app.add_flag("--still", options.still, "The sensor does not move");
  app.add_flag("--parts", options.parts, "Bytes by what they are spent on");
  CLI11_PARSE(app, argc, argv);
  return curlidar::run(options);
}
