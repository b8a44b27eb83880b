// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "codec/verify_slots.hpp"

namespace curlidar {
namespace {

bool same_bits(const Vec3& a, const Vec3& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

/// NaN slots are the same whatever their payloads.
bool same_empty(const Vec3& a, const Vec3& b) {
  const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

bool same_column(const Column& a, const Column& b) {
  if (a.index() != b.index()) return false;
  return std::visit(
      [&](const auto& left) {
        const auto& right = std::get<std::decay_t<decltype(left)>>(b);
        return left.size() == right.size() &&
               (left.empty() ||
                std::memcmp(left.data(), right.data(), left.size() * sizeof(left[0])) == 0);
      },
      a);
}

void compare_points(const Cloud& back, const Cloud& cloud, Verification& out) {
  double sum = 0, squares = 0;
  out.bit_exact = true;
  out.order = back.size() == cloud.size();
  for (std::size_t i = 0; i < cloud.size() && i < back.size(); ++i) {
    const Vec3 &a = back.positions[i], &b = cloud.positions[i];
    const bool is_point = is_return(b);
    out.points += is_point ? 1 : 0;
    if (is_point != is_return(a) || (!is_point && !same_empty(a, b))) {
      if (out.order) out.failures.push_back(fmt::format("slot {} is another kind of point", i));
      out.order = false;
      continue;
    }
    if (!is_point) continue;
    out.bit_exact = out.bit_exact && same_bits(a, b);
    const double distance = norm(a - b);
    sum += distance;
    squares += distance * distance;
    out.max_error_m = std::max(out.max_error_m, distance);
  }
  if (back.size() != cloud.size()) {
    out.points = count_returns(cloud);
    out.failures.push_back(fmt::format("the file has {} points and empty slots, the cloud {}",
                                       back.size(), cloud.size()));
  }
  const auto n = static_cast<double>(std::max<std::size_t>(out.points, 1));
  out.mean_error_m = sum / n;
  out.rms_error_m = std::sqrt(squares / n);
}

void compare_attributes(const Cloud& back, const Cloud& cloud, Verification& out) {
  out.attributes = true;
  for (const Attribute& attribute : back.attributes) {
    const Attribute* original = cloud.find(attribute.name);
    const bool same = original != nullptr && original->components == attribute.components &&
                      same_column(original->values, attribute.values);
    if (same) continue;
    out.attributes = false;
    out.failures.push_back(fmt::format("the attribute '{}' is not the cloud's", attribute.name));
  }
  for (const Attribute& attribute : cloud.attributes) {
    if (back.find(attribute.name) == nullptr) out.attributes_left_out.push_back(attribute.name);
  }
}

/// The returns alone, with the attributes that `names` has.
Cloud returns_of(const Cloud& cloud, const std::vector<Attribute>& names) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) slots.push_back(i);
  }
  Cloud chosen;
  chosen.positions = cloud.positions;
  for (const Attribute& attribute : names) {
    if (const Attribute* found = cloud.find(attribute.name)) chosen.attributes.push_back(*found);
  }
  return select(chosen, slots);
}

/// Of every point the bytes of its coordinates, if wanted, and attributes; sorted.
std::vector<std::string> sorted_points(const Cloud& cloud, bool positions, bool attributes) {
  std::vector<std::string> points(cloud.size());
  const auto append = [&](std::size_t i, const void* bytes, std::size_t size) {
    points[i].append(static_cast<const char*>(bytes), size);
  };
  for (std::size_t i = 0; positions && i < cloud.size(); ++i) {
    append(i, &cloud.positions[i], sizeof(Vec3));
  }
  for (const Attribute& attribute : cloud.attributes) {
    if (!attributes) break;
    std::visit(
        [&](const auto& values) {
          for (std::size_t i = 0; i < cloud.size(); ++i) {
            append(i, &values[i * attribute.components], attribute.components * sizeof(values[0]));
          }
        },
        attribute.values);
  }
  std::sort(points.begin(), points.end());
  return points;
}

bool same_attribute_types(const Cloud& a, const Cloud& b) {
  const auto same = [](const Attribute& x, const Attribute& y) {
    return x.components == y.components && x.values.index() == y.values.index();
  };
  return std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(),
                    b.attributes.end(), same);
}

/// Distances to the nearest, both ways; those of both clouds have returns.
Status measure_nearest(const Cloud& back, const Cloud& cloud, std::size_t threads,
                       Verification& out) {
  CURLIDAR_TRY_ASSIGN(there, distances_to_nearest(cloud, back, threads));
  CURLIDAR_TRY_ASSIGN(here, distances_to_nearest(back, cloud, threads));
  double sum = 0, squares = 0;
  for (const double distance : there) {
    sum += distance;
    squares += distance * distance;
    out.max_error_m = std::max(out.max_error_m, distance);
  }
  for (const double distance : here) out.max_error_m = std::max(out.max_error_m, distance);
  const auto n = static_cast<double>(there.size());
  out.mean_error_m = sum / n;
  out.rms_error_m = std::sqrt(squares / n);
  return {};
}

/// Compares the returns of both clouds as sets.
Status compare_sets(const Cloud& decoded, const Cloud& original, std::size_t threads,
                    Verification& out) {
  const Cloud back = returns_of(decoded, decoded.attributes);
  const Cloud cloud = returns_of(original, decoded.attributes);
  out.points = cloud.size();
  for (const Attribute& attribute : original.attributes) {
    if (back.find(attribute.name) == nullptr) out.attributes_left_out.push_back(attribute.name);
  }
  if (!cloud.positions.empty() && !back.positions.empty()) {
    CURLIDAR_TRY(measure_nearest(back, cloud, threads, out));
  }
  if (back.size() != cloud.size()) {
    out.failures.push_back(
        fmt::format("the file has {} returns, the cloud {}", back.size(), cloud.size()));
    return {};
  }
  const auto same = [&](bool positions, bool attributes) {
    return sorted_points(back, positions, attributes) ==
           sorted_points(cloud, positions, attributes);
  };
  out.bit_exact = same(true, false);
  out.attributes = same_attribute_types(back, cloud) && same(out.bit_exact, true);
  if (!out.attributes) out.failures.push_back("the attributes are not the cloud's");
  return {};
}

void check_promise(Verification& v) {
  if (v.promise.bit_exact && !v.bit_exact) {
    v.failures.push_back(
        fmt::format("coordinates are not bit for bit the cloud's; the largest distance is {} m",
                    v.max_error_m));
  }
  if (v.promise.bound_m > 0 && !(v.max_error_m <= v.promise.bound_m)) {
    v.failures.push_back(fmt::format("a point lies {} m from its original, the bound is {} m",
                                     v.max_error_m, v.promise.bound_m));
  }
  v.ok = v.failures.empty();
}

Result<DecodedScan> decode_all(ByteSpan bytes, std::size_t threads,
                               const std::shared_ptr<const PredictionReference>& reference) {
  DecodeOptions options;
  options.reference = reference;
  options.threads = threads;
  options.limits = {UINT64_MAX, UINT64_MAX};
  return decode(bytes, options);
}

Status check_every_return(const DecodedScan& scan) {
  if (scan.cloud) return {};
  return Error{ErrorCode::unsupported,
               "the file does not hold every return in its place (it is of the paper's profiles "
               "or an image): encode the scan without --cols and limits of range"};
}

Verification compare_slots(const DecodedScan& scan, const Cloud& cloud) {
  Verification out;
  out.promise = scan.records->promise;
  compare_points(*scan.cloud, cloud, out);
  compare_attributes(*scan.cloud, cloud, out);
  out.shape = scan.cloud->width == cloud.width && scan.cloud->height == cloud.height;
  if (!out.shape) {
    out.failures.push_back(fmt::format("the file's cloud is {} x {}, the given one {} x {}",
                                       scan.cloud->width, scan.cloud->height, cloud.width,
                                       cloud.height));
  }
  check_promise(out);
  return out;
}

}  // namespace

Result<Verification> verify_slots(ByteSpan bytes, const Cloud& cloud, std::size_t threads,
                                  const std::shared_ptr<const PredictionReference>& reference) {
  CURLIDAR_TRY_ASSIGN(scan, decode_all(bytes, threads, reference));
  CURLIDAR_TRY(check_every_return(scan));
  return compare_slots(scan, cloud);
}

Result<Verification> verify(ByteSpan bytes, const Cloud& cloud, std::size_t threads) {
  CURLIDAR_TRY_ASSIGN(scan, decode_all(bytes, threads, {}));
  return verify(scan, cloud, threads);
}

Result<Verification> verify(const DecodedScan& scan, const Cloud& cloud, std::size_t threads) {
  CURLIDAR_TRY(check_every_return(scan));
  if (!scan.records->promise.any_order) return compare_slots(scan, cloud);
  Verification out;
  out.promise = scan.records->promise;
  CURLIDAR_TRY(compare_sets(*scan.cloud, cloud, threads, out));
  check_promise(out);
  return out;
}

}  // namespace curlidar
