// SPDX-License-Identifier: BSD-3-Clause
// The methods that are compared between the rows, and what is said of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "curlidar/dense.hpp"
#include "report/measure/json.hpp"
#include "report/measure/sampler.hpp"

namespace curlidar::bench {

struct Method {
  std::string name, setting;
  std::string skipped;  ///< why there is no sampler
  std::shared_ptr<const Sampler> sampler;
  std::shared_ptr<const Field> field;  ///< as decoded; none of raw samples
  std::size_t bytes = 0;               ///< of its file; 0: raw samples
  double bits_per_point = 0;
  double cp_paper_percent = 0;  ///< of the paper's methods
  double step_m = 0;            ///< of the compact codec

  Json header() const;
};

/// What the methods are made of.
struct MethodInput {
  const Cloud* cloud = nullptr;
  EncodeSettings paper;                         ///< of Profile::paper, upsampling left open
  std::optional<SensorProfile> compact_sensor;  ///< for the compact codec; else it finds its own
  /// For interpolation: rings, their elevations as seen from the origin, columns of a turn.
  std::vector<std::uint16_t> ring_of_point;
  std::vector<double> ring_elevations;
  std::uint32_t columns = 0;
  /// Adds "compact-profile": the compact codec's field asked with it.
  std::shared_ptr<const DensityProfile> profile{};
  /// What tells confidence instead of what the library carries.
  std::shared_ptr<const DensityProfile> confidence{};
};

/// The paper's S = 1x1, 2x1, 2x2, with the other settings as given.
std::vector<Method> paper_methods(const Cloud& cloud, EncodeSettings settings);
/// The paper's baseline, one expansion of the whole scan.
Method baseline_method(const Cloud& cloud, EncodeSettings settings);
/// The compact codec at 1 bit a point with every return: what is told between its samples, and
/// what its field says by itself.
std::vector<Method> compact_methods(const MethodInput& input);
/// The same at a mean error of 5 mm, "compact-fine" and "compact-fine-profile": what is between the
/// samples whatever coding loses.
std::vector<Method> fine_methods(const MethodInput& input);
/// Edge-aware interpolation of the raw samples.
Method edge_aware_method(const MethodInput& input);
/// The paper's; compact; linear and edge-aware interpolation.
std::vector<Method> make_methods(const MethodInput& input);

}  // namespace curlidar::bench
