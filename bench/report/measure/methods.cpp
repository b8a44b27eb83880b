// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/methods.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "curlidar/dense.hpp"
#include "report/measure/codecs.hpp"

namespace curlidar::bench {
namespace {

constexpr double kCompactError_m = 0.05;
constexpr double kCompactBits = 1;
constexpr double kClose_m = 0.05;

/// The method of a file: encoded, decoded, or the reason why not.
Method coded_method(std::string name, std::string setting, const Cloud& cloud,
                    const EncodeSettings& settings) {
  Method method;
  method.name = std::move(name);
  method.setting = std::move(setting);
  const Result<Encoded> encoded = encode(cloud, settings);
  if (!encoded) {
    method.skipped = encoded.error().message;
    return method;
  }
  Result<DecodedScan> decoded = decode(encoded->bytes);
  if (!decoded) {
    method.skipped = decoded.error().message;
    return method;
  }
  if (decoded->records && decoded->records->lattice == RecordLattice::none) {
    method.skipped = "the points were coded one after the other, without a field";
    return method;
  }
  if (settings.profile == Profile::compact) decoded->field = dense_field(decoded->field);
  method.bytes = encoded->bytes.size();
  method.bits_per_point = encoded->report.bits_per_point;
  method.cp_paper_percent = encoded->report.cp_paper_percent;
  method.sampler = std::make_shared<FieldSampler>(std::move(*decoded));
  return method;
}

Method sample_method(std::string name, const std::shared_ptr<const RingSamples>& samples,
                     Mixing mixing) {
  Method method;
  method.name = std::move(name);
  method.setting = "raw samples";
  method.sampler = std::make_shared<RingSampler>(samples, mixing);
  return method;
}

}  // namespace

Json Method::header() const {
  Json json{{"method", name}, {"setting", setting}};
  if (!skipped.empty()) {
    json["skipped"] = skipped;
    return json;
  }
  if (bytes > 0) json["bytes"] = bytes, json["bits_per_point"] = bits_per_point;
  if (cp_paper_percent > 0) json["cp_paper_percent"] = cp_paper_percent;
  return json;
}

std::vector<Method> paper_methods(const Cloud& cloud, EncodeSettings settings) {
  std::vector<Method> methods;
  for (const auto& [rows, columns] : {std::pair{1u, 1u}, {2u, 1u}, {2u, 2u}}) {
    settings.paper.upsample_rows = rows;
    settings.paper.upsample_columns = columns;
    methods.push_back(
        coded_method("paper", fmt::format("S {}x{}", rows, columns), cloud, settings));
  }
  return methods;
}

Method baseline_method(const Cloud& cloud, EncodeSettings settings) {
  settings.profile = Profile::paper_global;
  return coded_method("baseline", paper_setting(settings.profile), cloud, settings);
}

std::vector<Method> make_methods(const MethodInput& input) {
  std::vector<Method> methods = paper_methods(*input.cloud, input.paper);
  for (const auto& [target, value, setting] :
       {std::tuple{CompactTarget::error, kCompactError_m, "5 cm"},
        {CompactTarget::bits_per_point, kCompactBits, "1 bit a point"}}) {
    EncodeSettings settings = compact_of_scan(target, value);
    settings.sensor = input.compact_sensor;
    methods.push_back(coded_method("compact", setting, *input.cloud, settings));
  }
  const auto samples = std::make_shared<const RingSamples>(
      input.cloud->positions, input.ring_of_point, input.ring_elevations, input.columns);
  methods.push_back(sample_method("linear", samples, Mixing::linear));
  methods.push_back(sample_method("edge-aware", samples, Mixing::edge_aware));
  return methods;
}

void RayTally::add(double told_m, std::optional<double> true_m) {
  const bool told = limits_.hold(told_m);
  if (true_m && limits_.hold(*true_m)) {
    ++wanted_;
    found_ += told ? 1 : 0;
  }
  if (!told) return;
  if (true_m) {
    errors_m_.push_back(std::abs(told_m - *true_m));
  } else {
    ++no_surface_;
  }
}

RayErrors RayTally::errors() const {
  const auto share = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
  };
  const auto close = static_cast<std::size_t>(std::count_if(
      errors_m_.begin(), errors_m_.end(), [](double error) { return error < kClose_m; }));
  RayErrors errors;
  errors.points = errors_m_.size() + no_surface_;
  errors.stats = summarise(errors_m_);
  errors.within_5cm = share(close, errors_m_.size());
  errors.completeness = share(found_, wanted_);
  errors.no_surface = no_surface_;
  return errors;
}

Json to_json(const RayErrors& errors) {
  return {{"points", errors.points},         {"mean", errors.stats.mean},
          {"rms", errors.stats.rms},         {"p50", errors.stats.p50},
          {"p95", errors.stats.p95},         {"max", errors.stats.max},
          {"within_5cm", errors.within_5cm}, {"completeness", errors.completeness},
          {"no_surface", errors.no_surface}};
}

}  // namespace curlidar::bench
