// SPDX-License-Identifier: BSD-3-Clause
// What the options of `curlidar encode` mean, for one scan and for a sequence.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common_compact.hpp"
#include "common_inputs.hpp"
#include "common_paper.hpp"
#include "common_scans.hpp"

namespace curlidar::app {

/// Options of a sequence; none of them means anything without the first.
struct SequenceOptions {
  bool sequence = false, still = false;
  std::uint32_t group = 0;  ///< 0: the library's
  PoseOptions poses;
};

struct EncodeCommand {
  CommonOptions common;
  PaperOptions paper;
  CompactOptions compact;
  SequenceOptions sequence;
  std::vector<std::string> inputs, metadata;
  std::string output, format;
};

void add_encode_options(CLI::App& app, EncodeCommand& command);
/// Failure(kExitUsage) if poses or times are given for scans that become files of their own.
void refuse_poses(const PoseOptions& poses);

/// The settings for a scan; Failure(kExitUsage) for what makes no sense.
EncodeSettings encode_settings(const EncodeCommand& command, const Cloud& cloud);
/// Refuses inputs that are coded already.
void refuse_coded(const std::vector<std::string>& inputs);
std::map<std::string, std::string> parse_metadata(const std::vector<std::string>& pairs);
/// The metadata that a file of this scan is to hold. `name` is the file that it comes from.
void set_metadata(const std::map<std::string, std::string>& metadata,
                  const EncodeSettings& settings, const std::string& name, Cloud& cloud);

/// encode --sequence: all inputs into one file.
int run_encode_sequence(const EncodeCommand& command);

}  // namespace curlidar::app
