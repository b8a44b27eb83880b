// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace curlidar {

/// Called by long operations with the name of the running stage and its share done in [0, 1].
/// May be empty. Called from one thread at a time, never from inside a parallel section.
using ProgressCallback = std::function<void(std::string_view stage, double fraction)>;

/// Wall time of one stage, milliseconds.
struct StageTime {
  std::string stage;
  double ms = 0;
};

}  // namespace curlidar
