// SPDX-License-Identifier: BSD-3-Clause
// The paper's parameter table as command-line options, with what every profile shares.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "common_options.hpp"
#include "curlidar/codec.hpp"

namespace curlidar::app {

/// Options that make up EncodeSettings. Preset first, then what the profile changes, then the
/// options given one by one. The object must live as long as the CLI::App.
class PaperOptions {
 public:
  /// --preset, --sensor, the grid, range limits, outlier filter. `prefix` goes before rows and
  /// cols.
  void add_grid(CLI::App& app, const std::string& prefix = "");
  /// --upsample RxC.
  void add_upsample(CLI::App& app);
  /// Cliffs and refused triangles.
  void add_cliffs(CLI::App& app);
  /// --profile (by default `profile`), --attributes and everything about patches and degrees.
  void add_fit(CLI::App& app, const char* profile);

  /// The settings for a scan. Failure(kExitUsage) if a value makes no sense, or if an option of the
  /// paper's profiles is given with another.
  EncodeSettings settings(const Cloud& cloud, std::size_t threads) const;
  /// The same failures before any scan is read.
  void check() const { settings({}, 1); }
  Profile profile() const;
  /// Name of the preset that settings() takes for a scan.
  std::string preset(const Cloud& cloud) const;

 private:
  using Override = std::function<void(PaperSettings&)>;
  /// Notes that an option means nothing to Profile::compact.
  CLI::Option* paper_only(CLI::Option* option);
  void refuse_paper_options() const;
  /// A number of the table: its default is read from, and its value written to, `field`.
  template <class T>
  CLI::Option* add_number(CLI::App& app, const std::string& name, T& (*field)(PaperSettings&),
                          const char* help);

  std::string profile_ = "paper", preset_ = "auto", sensor_ = "auto", attributes_ = "all";
  std::vector<Override> overrides_;
  std::vector<const CLI::Option*> paper_only_;
  bool uniform_rows_ = false;  ///< --rows asked for something else than rings
  CompactSettings compact_;    ///< what shared options say
};

}  // namespace curlidar::app
