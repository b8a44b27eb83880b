// SPDX-License-Identifier: BSD-3-Clause
// Which points of a map are of things that moved: some scans saw a return there, and the beams of
// others passed through.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "curlidar/motion.hpp"
#include "curlidar/result.hpp"
#include "curlidar/vec3.hpp"
#include "mapfile/sight_image.hpp"

namespace curlidar {

struct StillSettings {
  /// Scans from farther away than this are not asked: their beams are too far apart.
  double reach_m = 30;
  /// Moved is what at least so many scans looked through, and so many times more than saw it there.
  std::size_t least_passed = 2;
  double passed_to_there = 1;
};

/// Remembers how far every scan saw. 120 bytes a scan in memory; its image, 196 kB, in a temporary
/// file without a name, which goes when the program ends, however it does.
class StillFilter {
 public:
  explicit StillFilter(const StillSettings& settings = {}) : settings_(settings) {}

  /// Points in the sensor's frame. io: the temporary file cannot be written; says what to do.
  Status add_scan(std::span<const Vec3> points, const RigidMotion& T_map_sensor);
  std::size_t scans() const { return scans_.size(); }

  /// For each point of the map, 1 if what was seen there has moved. To be asked when all scans near
  /// to the points are in, for a tile at once: reads the image of every scan within reach of any of
  /// them, one at a time. The same answers in any order of scans and points. .1 us for each point
  /// and scan within reach of it; 8 bytes a point and one image in memory.
  Result<std::vector<std::uint8_t>> moved(std::span<const Vec3> points) const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  Result<SightImage> read_image(std::size_t scan) const;

  StillSettings settings_;
  std::vector<RigidMotion> scans_;  ///< T_map_sensor
  std::unique_ptr<std::FILE, CloseFile> images_;
};

}  // namespace curlidar
