// SPDX-License-Identifier: BSD-3-Clause
// Ranges along any direction from the origin of a scan, whatever tells them.
#pragma once

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
  /// What is told along unit directions, one estimate for each. Confidences rank what a method
  /// tells; only those of a field are meant as probabilities.
  virtual std::vector<RangeEstimate> tell(std::span<const Vec3> directions) const = 0;
};

/// A decoded field; one thread.
class FieldSampler final : public Sampler {
 public:
  explicit FieldSampler(std::shared_ptr<const Field> field) : field_(std::move(field)) {}

  std::vector<RangeEstimate> tell(std::span<const Vec3> directions) const override;

 private:
  std::shared_ptr<const Field> field_;
};

/// Interpolation of raw samples, trusted by how near the ranges on the ring above and below are to
/// each other.
class RingSampler final : public Sampler {
 public:
  RingSampler(std::shared_ptr<const RingSamples> samples, Mixing mixing)
      : samples_(std::move(samples)), mixing_(mixing) {}

  std::vector<RangeEstimate> tell(std::span<const Vec3> directions) const override;

 private:
  std::shared_ptr<const RingSamples> samples_;
  Mixing mixing_;
};

}  // namespace curlidar::bench
