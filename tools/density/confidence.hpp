// SPDX-License-Identifier: BSD-3-Clause
// What confidence is learnt from, and whether it is right.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "dense/density_profile.hpp"
#include "density/asked_scan.hpp"
#include "density/boost.hpp"

namespace curlidar::density {

/// Adds what the rules say at every place of a scan, and whether it is within 5 cm of a surface.
void add_answers(const AskedScan& scan, Samples& samples);
/// The same of what rows of a profile measure, where it fits the scan and places are on its rows.
void add_row_answers(const AskedScan& scan, const std::shared_ptr<const DensityProfile>& profile,
                     Samples& samples);

/// Shares of answers within 5 cm by what the trees said of them.
struct Calibration {
  static constexpr std::size_t kBins = 10;
  std::array<double, kBins> said{}, right{}, count{};  ///< sums

  void add(double said_probability, bool was_right);
  /// The largest difference of said and right shares of bins with `least` answers or more.
  double worst(double least) const;
};

Calibration check(const ObliviousTrees& confidence, const Samples& samples);

}  // namespace curlidar::density
