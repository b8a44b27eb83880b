// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/finish.hpp"

#include <algorithm>
#include <string>

#include "reconstruct/attributes.hpp"
#include "reconstruct/coded.hpp"
#include "reconstruct/normals.hpp"

namespace curlidar {
namespace {

/// Puts an attribute behind the others, in place of one of its name.
template <class T>
void set_attribute(Cloud& cloud, const char* name, std::vector<T> values) {
  std::erase_if(cloud.attributes, [&](const Attribute& a) { return a.name == name; });
  cloud.attributes.push_back({name, 1, std::move(values)});
}

}  // namespace

void add_normals(const ScanView& view, Cloud& cloud) {
  const std::vector<Vec3> normals = normals_at(view, cloud.positions, view.settings().threads);
  std::vector<float> x, y, z;
  for (const Vec3& normal : normals) {
    x.push_back(static_cast<float>(normal.x));
    y.push_back(static_cast<float>(normal.y));
    z.push_back(static_cast<float>(normal.z));
  }
  set_attribute(cloud, "normal_x", std::move(x));
  set_attribute(cloud, "normal_y", std::move(y));
  set_attribute(cloud, "normal_z", std::move(z));
}

void mark_coded(const ReconstructSettings& settings, Cloud& coded) {
  std::vector<float> sure;
  std::vector<std::uint8_t> original;
  for (const Vec3& p : coded.positions) {
    sure.push_back(is_return(p) ? 1.0F : 0.0F);
    original.push_back(is_return(p) ? 1 : 0);
  }
  if (settings.confidence) set_attribute(coded, "confidence", std::move(sure));
  if (settings.original) set_attribute(coded, "original", std::move(original));
}

Cloud finish(const ScanView& view, Samples samples) {
  const ReconstructSettings& settings = view.settings();
  Cloud cloud;
  cloud.metadata = view.scan().metadata;
  cloud.positions = std::move(samples.points);
  cloud.width = samples.width;
  cloud.height = samples.height;
  cloud.attributes = attributes_at(view.scan(), view.field(), cloud.positions, settings.threads);
  if (!samples.ring.empty()) set_attribute(cloud, "ring", std::move(samples.ring));
  if (settings.confidence) set_attribute(cloud, "confidence", std::move(samples.confidence));
  if (settings.original) {
    set_attribute(cloud, "original", std::vector<std::uint8_t>(cloud.size(), 0));
  }
  if (settings.normals) add_normals(view, cloud);
  return cloud;
}

Cloud finish_behind(const ScanView& view, Cloud coded, Samples samples) {
  mark_coded(view.settings(), coded);
  if (view.settings().normals) add_normals(view, coded);
  return behind(std::move(coded), finish(view, std::move(samples)));
}

Status check_kept(const ReconstructSettings& settings) {
  if (!settings.keep_originals || !settings.organised) return {};
  return Error{ErrorCode::invalid_argument,
               "the original returns lie beside the cells of an organised grid: keep them, or the "
               "grid"};
}

}  // namespace curlidar
