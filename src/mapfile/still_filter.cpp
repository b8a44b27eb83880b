// SPDX-License-Identifier: BSD-3-Clause
#include "mapfile/still_filter.hpp"

#include <fmt/format.h>
#include <sys/types.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "base/try.hpp"

namespace curlidar {
namespace {

Error file_error(const char* what) {
  return {
      ErrorCode::io,
      fmt::format("cannot {} the temporary file of what scans saw ({}): it takes 196 kB a scan; "
                  "make room, or build without the filter of moving things",
                  what, std::strerror(errno))};
}

/// The box of all points, to leave out scans that reach none of them.
struct PointBox {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  explicit PointBox(std::span<const Vec3> points) {
    for (const Vec3& p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  double distance(const Vec3& p) const {
    return norm({std::max({low.x - p.x, 0.0, p.x - high.x}),
                 std::max({low.y - p.y, 0.0, p.y - high.y}),
                 std::max({low.z - p.z, 0.0, p.z - high.z})});
  }
};

}  // namespace

Status StillFilter::add_scan(std::span<const Vec3> points, const RigidMotion& T_map_sensor) {
  if (!images_) images_.reset(std::tmpfile());
  if (!images_) return file_error("make");
  const std::vector<std::byte> bytes = SightImage(points).bytes();
  const auto place = static_cast<off_t>(scans_.size()) * static_cast<off_t>(bytes.size());
  if (::fseeko(images_.get(), place, SEEK_SET) != 0 ||
      std::fwrite(bytes.data(), 1, bytes.size(), images_.get()) != bytes.size() ||
      std::fflush(images_.get()) != 0) {
    return file_error("write");
  }
  scans_.push_back(T_map_sensor);
  return {};
}

Result<SightImage> StillFilter::read_image(std::size_t scan) const {
  std::vector<std::byte> bytes(SightImage::kBytes);
  const auto place = static_cast<off_t>(scan) * static_cast<off_t>(bytes.size());
  if (::fseeko(images_.get(), place, SEEK_SET) != 0 ||
      std::fread(bytes.data(), 1, bytes.size(), images_.get()) != bytes.size()) {
    return file_error("read");
  }
  return SightImage(std::span<const std::byte, SightImage::kBytes>(bytes));
}

Result<std::vector<std::uint8_t>> StillFilter::moved(std::span<const Vec3> points) const {
  std::vector<std::uint32_t> passed(points.size(), 0), there(points.size(), 0);
  const PointBox box(points);
  for (std::size_t scan = 0; scan < scans_.size(); ++scan) {
    const RigidMotion& pose = scans_[scan];
    if (box.distance(pose.move) > settings_.reach_m) continue;
    CURLIDAR_TRY_ASSIGN(image, read_image(scan));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 place = pose.undo(points[i]);
      if (dot(place, place) > settings_.reach_m * settings_.reach_m) continue;
      const Sight sight = image.of(place);
      passed[i] += sight == Sight::passed ? 1 : 0;
      there[i] += sight == Sight::there ? 1 : 0;
    }
  }
  std::vector<std::uint8_t> moved(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool often =
        passed[i] >= settings_.least_passed && passed[i] > settings_.passed_to_there * there[i];
    moved[i] = often ? 1 : 0;
  }
  return moved;
}

}  // namespace curlidar
