// SPDX-License-Identifier: BSD-3-Clause
// Rounding to single precision that really happens.
#pragma once

namespace curlidar {

/// The float32 next to `value`, which must be within its range. gcc 12 drops the conversion there
/// and back where it vectorises several of them (-ftree-slp-vectorize, on from -O2:
/// `Vec3{float(p.x), float(p.y), float(p.z)}` keeps its doubles), hence the detour through memory.
inline double round_to_float32(double value) {
  volatile float rounded = static_cast<float>(value);
  return static_cast<double>(rounded);
}

}  // namespace curlidar
