// SPDX-License-Identifier: BSD-3-Clause
// Options of the compact profile.
#pragma once

#include <string>
#include <vector>

#include "common_options.hpp"
#include "common_report.hpp"
#include "curlidar/codec.hpp"

namespace curlidar::app {

/// --error, --error-nn, --step, --bits, --max-error, --lossless, --any-order, --effort, --no-index,
/// --segments. The object must live as long as the
/// CLI::App.
class CompactOptions {
 public:
  void add(CLI::App& app);

  /// Writes target, effort, index and segments to `settings`. Failure(kExitUsage) if two targets
  /// are given or a value makes no sense.
  void apply(CompactSettings& settings) const;
  /// The first of these options that was given; "" if none was.
  std::string first_given() const;
  /// Whether parts were asked for that can be decoded alone.
  bool asks_for_segments() const { return segments_ != "auto"; }

 private:
  struct Target {
    CompactTarget kind;
    double value = 0;
    CLI::Option* option = nullptr;
  };
  void add_target(CLI::App& app, const char* name, CompactTarget kind, double most,
                  const char* help);

  std::vector<Target> targets_;
  std::uint32_t effort_ = CompactSettings{}.effort;
  bool no_index_ = false, any_order_ = false;
  std::string segments_ = "auto";
  std::vector<CLI::Option*> others_;
};

Json breakdown_json(const CompactBreakdown& breakdown);
Json statistics_json(const CompactStatistics& statistics);
/// Aligned lines: bits per return and share of each part.
std::string breakdown_text(const CompactBreakdown& breakdown, std::size_t returns);
/// How exactly a file says that its points come back.
std::string promise_text(const RecordPromise& promise);
/// Leaves by size and layers, layers by functions.
std::string statistics_text(const CompactStatistics& statistics);

}  // namespace curlidar::app
