// SPDX-License-Identifier: BSD-3-Clause
// The paper's parameter table as command-line options.
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
  /// --profile, --attributes and everything about patches and degrees.
  void add_fit(CLI::App& app);

  /// The settings for a scan. Failure(kExitUsage) if a value makes no sense.
  EncodeSettings settings(const Cloud& cloud, std::size_t threads) const;
  /// The same failures before any scan is read.
  void check() const { settings({}, 1); }
  /// Name of the preset that settings() takes for a scan.
  std::string preset(const Cloud& cloud) const;

 private:
  using Override = std::function<void(PaperSettings&)>;
  /// A number of the table: its default is read from, and its value written to, `field`.
  template <class T>
  CLI::Option* add_number(CLI::App& app, const std::string& name, T& (*field)(PaperSettings&),
                          const char* help);

  std::string profile_ = "paper", preset_ = "auto", sensor_ = "auto", attributes_ = "all";
  std::vector<Override> overrides_;
};

}  // namespace curlidar::app
