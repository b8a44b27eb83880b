// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/finish.hpp"

#include <algorithm>
#include <string>

#include "base/try.hpp"
#include "reconstruct/attributes.hpp"
#include "reconstruct/normals.hpp"

namespace curlidar {
namespace {

/// Puts an attribute behind the others, in place of one of its name.
template <class T>
void set_attribute(Cloud& cloud, const char* name, std::vector<T> values) {
  std::erase_if(cloud.attributes, [&](const Attribute& a) { return a.name == name; });
  cloud.attributes.push_back({name, 1, std::move(values)});
}

void add_normals(const View& view, Cloud& cloud) {
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

/// `more` behind a column of the same type; another type is left alone.
void append(Column& column, const Column& more) {
  std::visit(
      [&](auto& values) {
        const auto* added = std::get_if<std::decay_t<decltype(values)>>(&more);
        if (added != nullptr) values.insert(values.end(), added->begin(), added->end());
      },
      column);
}

}  // namespace

Cloud coded_cloud(const DecodedScan& scan, bool organised) {
  if (scan.cloud && !organised) return *scan.cloud;
  Cloud cloud;
  cloud.metadata = scan.metadata;
  if (!organised) {
    cloud.positions = scan.points;
    cloud.attributes = scan.attributes;
    cloud.width = static_cast<std::uint32_t>(scan.points.size());
    return cloud;
  }
  const std::vector<std::uint32_t> numbers = number_returns(*scan.field);
  cloud.positions.reserve(numbers.size());
  for (const std::uint32_t number : numbers) {
    cloud.positions.push_back(number < scan.points.size() ? scan.points[number] : kNoPoint);
  }
  for (const Attribute& attribute : scan.attributes) {
    cloud.attributes.push_back(gather(attribute, numbers));
  }
  cloud.width = scan.field->lattice().columns();
  cloud.height = scan.field->lattice().rows();
  return cloud;
}

void add_extras(const View& view, Cloud& coded) {
  const ReconstructSettings& settings = view.settings();
  std::vector<float> sure;
  std::vector<std::uint8_t> original;
  for (const Vec3& p : coded.positions) {
    sure.push_back(is_return(p) ? 1.0F : 0.0F);
    original.push_back(is_return(p) ? 1 : 0);
  }
  if (settings.confidence) set_attribute(coded, "confidence", std::move(sure));
  if (settings.original) set_attribute(coded, "original", std::move(original));
  if (settings.normals) add_normals(view, coded);
}

Cloud finish(const View& view, Samples samples) {
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

Status check_kept(const ReconstructSettings& settings) {
  if (!settings.keep_originals || !settings.organised) return {};
  return Error{ErrorCode::invalid_argument,
               "the original returns lie beside the cells of an organised grid: keep them, or the "
               "grid"};
}

Result<Cloud> kept_originals(const DecodedScan& scan, std::size_t threads) {
  Cloud coded;
  if (scan.cloud || !scan.points.empty()) {
    coded = coded_cloud(scan, false);
  } else {
    CURLIDAR_TRY_ASSIGN(plain, reconstruct(scan, {.threads = threads}));
    coded = std::move(plain);
  }
  std::vector<std::uint32_t> returns;
  for (std::uint32_t i = 0; i < coded.size(); ++i) {
    if (is_return(coded.positions[i])) returns.push_back(i);
  }
  return select(coded, returns);
}

Cloud behind(Cloud originals, const Cloud& invented) {
  originals.positions.insert(originals.positions.end(), invented.positions.begin(),
                             invented.positions.end());
  for (Attribute& attribute : originals.attributes) {
    const Attribute* more = invented.find(attribute.name);
    if (more != nullptr) append(attribute.values, more->values);
  }
  std::erase_if(originals.attributes, [&](const Attribute& a) {
    return size_of(a.values) != originals.size() * a.components;
  });
  originals.width = static_cast<std::uint32_t>(originals.size());
  originals.height = 1;
  return originals;
}

}  // namespace curlidar
