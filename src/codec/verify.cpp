// SPDX-License-Identifier: BSD-3-Clause
#include "curlidar/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/try.hpp"

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

}  // namespace

Result<Verification> verify(std::span<const std::byte> bytes, const Cloud& cloud,
                            std::size_t threads) {
  DecodeOptions options;
  options.threads = threads;
  options.limits = {UINT64_MAX, UINT64_MAX};
  CURLIDAR_TRY_ASSIGN(scan, decode(bytes, options));
  if (!scan.cloud) {
    return Error{ErrorCode::unsupported,
                 "the file does not hold every return in its place (it is of the paper's profiles "
                 "or an image): encode the scan without --cols and limits of range"};
  }
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
  if (out.promise.bit_exact && !out.bit_exact) {
    out.failures.push_back(
        fmt::format("coordinates are not bit for bit the cloud's; the largest distance is {} m",
                    out.max_error_m));
  }
  if (out.promise.bound_m > 0 && !(out.max_error_m <= out.promise.bound_m)) {
    out.failures.push_back(fmt::format("a point lies {} m from its original, the bound is {} m",
                                       out.max_error_m, out.promise.bound_m));
  }
  out.ok = out.failures.empty();
  return out;
}

}  // namespace curlidar
