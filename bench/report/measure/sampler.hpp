// SPDX-License-Identifier: BSD-3-Clause
// Ranges along lines of sight, whatever tells them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "curlidar/field.hpp"
#include "report/measure/ring_samples.hpp"

namespace curlidar::bench {

class Sampler {
 public:
  virtual ~Sampler() = default;
  /// What is told along the lines, whose directions are of length 1; one estimate for each.
  /// Confidences rank what a method tells; only those of a field are meant as probabilities.
  virtual std::vector<RangeEstimate> along(std::span<const Sightline> lines) const = 0;
  /// The same from the origin.
  std::vector<RangeEstimate> tell(std::span<const Vec3> directions) const;
};

/// A decoded field; one thread.
class FieldSampler final : public Sampler {
 public:
  explicit FieldSampler(std::shared_ptr<const Field> field) : field_(std::move(field)) {}

  std::vector<RangeEstimate> along(std::span<const Sightline> lines) const override;

 private:
  std::shared_ptr<const Field> field_;
};

/// Raw samples on their rings: what RingSamples is made of.
struct SampledRings {
  std::vector<Vec3> positions;
  std::vector<std::uint16_t> ring_of_point;
  std::vector<double> elevations;
  std::uint32_t columns = 0;
};

/// Interpolation of raw samples as they are seen from where each line starts, trusted by how near
/// the ranges on the ring above and below are to each other. O(samples) for every such viewpoint.
class RingSampler final : public Sampler {
 public:
  RingSampler(std::shared_ptr<const SampledRings> rings, Mixing mixing)
      : rings_(std::move(rings)), mixing_(mixing) {}

  std::vector<RangeEstimate> along(std::span<const Sightline> lines) const override;

 private:
  std::shared_ptr<const SampledRings> rings_;
  Mixing mixing_;
};

}  // namespace curlidar::bench
