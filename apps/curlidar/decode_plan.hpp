// SPDX-License-Identifier: BSD-3-Clause
// What the options of `curlidar decode` mean together, and for one file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/io.hpp"
#include "curlidar/reconstruct.hpp"
#include "decode_options.hpp"

namespace curlidar::app {

/// Rows that a sparse scan is brought to.
inline constexpr double kSparseRows = 64;
/// Below it the rows that a sparse scan lacks are too often wrong: 16 rings of a simulated street
/// at 64 rows keep four fifths of their points and lose half of their 95th percentile of error.
inline constexpr double kSparseConfidence = 0.2;

/// What the command line asks for, read and checked once for all inputs; Failure(kExitUsage) for
/// what makes no sense together.
class DecodePlan {
 public:
  explicit DecodePlan(const DecodeCommand& command);

  const DecodeOptions& decoding() const { return decoding_; }
  const WriteOptions& writing() const { return writing_; }
  const char* suffix() const;
  bool mesh() const { return command_.mesh; }
  std::optional<MeshFormat> mesh_format() const { return mesh_format_; }
  bool keeps_empty() const { return command_.organised || directions_; }

  /// The settings for one file: presets look at its rows, profiles must fit them. Failure for what
  /// this file cannot do.
  ReconstructSettings settings(const DecodedScan& scan) const;
  Cloud cloud(const DecodedScan& scan, const ReconstructSettings& settings,
              const ProgressCallback& progress) const;

 private:
  /// Whether points are invented, and not only the returns given.
  bool invents(const ReconstructSettings& settings) const;
  /// The attributes that were asked for by options of their own are kept beside those listed.
  void keep_wanted(Cloud& cloud) const;

  const DecodeCommand& command_;
  DecodeOptions decoding_;
  WriteOptions writing_;
  std::optional<MeshFormat> mesh_format_;
  std::optional<std::vector<std::string>> attributes_;
  std::optional<DenseStrategy> strategy_;
  std::shared_ptr<const DensityProfile> profile_;
  std::optional<Cloud> directions_;
  std::optional<SensorProfile> sensor_;
};

}  // namespace curlidar::app
