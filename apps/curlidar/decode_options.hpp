// SPDX-License-Identifier: BSD-3-Clause
// What `curlidar decode` is asked for: which part of a file, which points of it, in what form.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common_inputs.hpp"
#include "curlidar/reconstruct.hpp"

namespace curlidar::app {

struct DecodeCommand {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string output, format, encoding = "binary", attributes = "all";
  std::string rings, azimuth, region;
  bool field_only = false, allow_truncated = false;

  std::optional<double> rows, columns;
  std::optional<double> density;
  std::string directions, sensor;
  bool mesh = false;

  std::string preset, strategy, density_profile;
  std::optional<double> min_confidence;
  bool no_masks = false, organised = false;
  bool confidence = false, normals = false, keep_originals = false, original = false;
  std::uint64_t max_points = 1ull << 28;
};

void add_decode_options(CLI::App& app, DecodeCommand& command);

/// What the command line asks for, read and checked once for all inputs; Failure(kExitUsage) for
/// what makes no sense together.
class DecodePlan {
 public:
  explicit DecodePlan(const DecodeCommand& command);

  const DecodeOptions& decoding() const { return decoding_; }
  const WriteOptions& writing() const { return writing_; }
  const char* suffix() const;
  bool mesh() const { return command_.mesh; }
  bool keeps_empty() const { return command_.organised || directions_; }

  /// The settings for one file: presets look at its rows, profiles must fit them.
  ReconstructSettings settings(const DecodedScan& scan) const;
  Cloud cloud(const DecodedScan& scan, const ProgressCallback& progress) const;

 private:
  /// The attributes that were asked for by options of their own are kept beside those listed.
  void keep_wanted(Cloud& cloud) const;

  const DecodeCommand& command_;
  DecodeOptions decoding_;
  WriteOptions writing_;
  std::optional<std::vector<std::string>> attributes_;
  std::optional<DenseStrategy> strategy_;
  std::shared_ptr<const DensityProfile> profile_;
  std::optional<Cloud> directions_;
  std::optional<SensorProfile> sensor_;
};

}  // namespace curlidar::app
