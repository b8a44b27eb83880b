// SPDX-License-Identifier: BSD-3-Clause
// What `curlidar encode` tells of a file it has made.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "common_inputs.hpp"
#include "curlidar/codec.hpp"

namespace curlidar::app {

Json encode_json(const EncodeReport& report, Profile profile, const std::string& preset);
/// Everything, of a single file.
std::string encode_text(const Job& job, const EncodeReport& report, Profile profile,
                        const std::string& preset);
/// One line, of one of many.
std::string encode_line(const Job& job, const EncodeReport& report);

}  // namespace curlidar::app
