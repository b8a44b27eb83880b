// SPDX-License-Identifier: BSD-3-Clause
// Ranges between the coded rows, whatever tells them.
#pragma once

#include <memory>
#include <vector>

#include "curlidar/codec.hpp"
#include "report/measure/ring_samples.hpp"

namespace curlidar::bench {

/// A unit direction with the range told there, metres; NaN: no point.
struct RayRange {
  Vec3 direction;
  double range_m = 0;
};

class Sampler {
 public:
  virtual ~Sampler() = default;
  /// Rows of one's own grid made `factor` times denser, those on a coded row left out.
  virtual Result<std::vector<RayRange>> between_rows(double factor) const = 0;
  /// Range along a unit direction, metres; NaN where there is no point.
  virtual double range(const Vec3& direction) const = 0;
};

/// A decoded file: what `reconstruct` gives, and its field in any direction. Points see their own
/// direction from the origin, which is not that of the lattice where beams start elsewhere.
class FieldSampler final : public Sampler {
 public:
  explicit FieldSampler(DecodedScan scan) : scan_(std::move(scan)) {}

  Result<std::vector<RayRange>> between_rows(double factor) const override;
  double range(const Vec3& direction) const override;

 private:
  DecodedScan scan_;
};

/// Interpolation of raw samples; its grid is that of the rings and columns.
class RingSampler final : public Sampler {
 public:
  RingSampler(std::shared_ptr<const RingSamples> samples, Mixing mixing)
      : samples_(std::move(samples)), mixing_(mixing) {}

  Result<std::vector<RayRange>> between_rows(double factor) const override;
  double range(const Vec3& direction) const override { return samples_->range(direction, mixing_); }

 private:
  std::shared_ptr<const RingSamples> samples_;
  Mixing mixing_;
};

}  // namespace curlidar::bench
