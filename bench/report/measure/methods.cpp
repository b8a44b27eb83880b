// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/methods.hpp"

#include <utility>

#include <fmt/format.h>

#include "curlidar/dense.hpp"
#include "dense/density_profile.hpp"
#include "report/measure/codecs.hpp"

namespace curlidar::bench {
namespace {

constexpr double kCompactBits = 1;
constexpr double kFineError_m = 0.005;

/// The method of a file, encoded and decoded, with the field as it is; or the reason why not.
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
  method.bytes = encoded->bytes.size();
  method.bits_per_point = encoded->report.bits_per_point;
  method.cp_paper_percent = encoded->report.cp_paper_percent;
  if (encoded->report.compact) method.step_m = encoded->report.compact->step_m;
  method.field = decoded->field;
  method.sampler = std::make_shared<FieldSampler>(decoded->field);
  return method;
}

Method compact_field(const MethodInput& input, EncodeSettings settings, std::string name,
                     std::string setting) {
  settings.sensor = input.compact_sensor;
  return coded_method(std::move(name), std::move(setting), *input.cloud, settings);
}

/// `profile` with the confidence of another.
std::shared_ptr<const DensityProfile> with_confidence(
    const std::shared_ptr<const DensityProfile>& profile,
    const std::shared_ptr<const DensityProfile>& confidence) {
  if (!profile || !confidence) return profile ? profile : confidence;
  auto both = std::make_shared<DensityProfile>(*profile);
  both->confidence = confidence->confidence;
  return both;
}

/// A field made dense, without and with a profile.
std::vector<Method> dense_methods(const MethodInput& input, const Method& field,
                                  const std::string& name) {
  const auto dense = [&](const std::string& called,
                         const std::shared_ptr<const DensityProfile>& profile) {
    Method method = field;
    method.name = called;
    if (!field.field) return method;
    method.field = dense_field(field.field, {.profile = with_confidence(profile, input.confidence),
                                             .rows_of_profile = profile != nullptr});
    method.sampler = std::make_shared<FieldSampler>(method.field);
    return method;
  };
  std::vector<Method> methods{dense(name, nullptr)};
  if (!input.profile) return methods;
  methods.push_back(dense(name + "-profile", input.profile));
  if (!field.field) return methods;
  if (const Status fits = check_density_profile(*input.profile, *field.field); !fits) {
    methods.back().skipped = fits.error().message;
    methods.back().sampler = nullptr;
  }
  return methods;
}

std::shared_ptr<const SampledRings> samples_of(const MethodInput& input) {
  return std::make_shared<const SampledRings>(SampledRings{
      input.cloud->positions, input.ring_of_point, input.ring_elevations, input.columns});
}

Method sample_method(std::string name, const std::shared_ptr<const SampledRings>& samples,
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
  if (step_m > 0) json["step_m"] = step_m;
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

std::vector<Method> compact_methods(const MethodInput& input) {
  const EncodeSettings settings = compact_of_scan(CompactTarget::bits_per_point, kCompactBits);
  Method field = compact_field(input, settings, "compact-field", "1 bit a point");
  std::vector<Method> methods = dense_methods(input, field, "compact");
  methods.push_back(std::move(field));
  return methods;
}

std::vector<Method> fine_methods(const MethodInput& input) {
  const EncodeSettings settings = compact_of_scan(CompactTarget::error, kFineError_m);
  return dense_methods(input,
                       compact_field(input, settings, "compact-fine", error_setting(kFineError_m)),
                       "compact-fine");
}

Method edge_aware_method(const MethodInput& input) {
  return sample_method("edge-aware", samples_of(input), Mixing::edge_aware);
}

std::vector<Method> make_methods(const MethodInput& input) {
  std::vector<Method> methods = paper_methods(*input.cloud, input.paper);
  for (Method& method : compact_methods(input)) methods.push_back(std::move(method));
  const auto samples = samples_of(input);
  methods.push_back(sample_method("linear", samples, Mixing::linear));
  methods.push_back(sample_method("edge-aware", samples, Mixing::edge_aware));
  return methods;
}

}  // namespace curlidar::bench
