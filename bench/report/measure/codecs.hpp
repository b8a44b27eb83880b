// SPDX-License-Identifier: BSD-3-Clause
// The codecs that verbs measure, and how tables name their settings.
#pragma once

#include <array>
#include <string>

#include "curlidar/codec.hpp"

namespace curlidar::bench {

/// Mean errors that the compact codec is asked for, metres.
inline constexpr std::array kCompactErrors{0.005, 0.02, 0.05};

inline constexpr const char* kNoPcl = "PCL was not found when this was built";

/// The gridded cloud, which is an image, by the compact codec at a mean error; one thread.
EncodeSettings compact_of_image(double error_m);
/// Every return by the compact codec at the target; one thread, no attributes, no index.
EncodeSettings compact_of_scan(CompactTarget target, double value);

std::string paper_setting(Profile profile);  ///< "degree 64", "S 2x2, P_r 4", "S 1x1, P_r 4"
std::string error_setting(double error_m);   ///< "5 mm", "2 cm"

}  // namespace curlidar::bench
