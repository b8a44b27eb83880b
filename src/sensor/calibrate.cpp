// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/parallel.hpp"
#include "base/try.hpp"
#include "sensor/angles.hpp"
#include "sensor/calibrate_azimuth.hpp"
#include "sensor/calibrate_range.hpp"
#include "sensor/calibrate_refine.hpp"
#include "sensor/calibrate_sample.hpp"
#include "sensor/calibrate_shifts.hpp"

namespace curlidar {
namespace {

using calibration::Misfit;
using calibration::RefineSettings;
using calibration::ScanSample;

/// Returns that least squares works on: of all scans together, of one.
constexpr std::size_t kMostReturns = 240000, kMostReturnsOfScan = 40000,
                      kLeastReturnsOfScan = 10000;
/// Cones as thin as this were not bent by a motion.
constexpr double kExact_m = 2e-5;
/// A motion must shrink the misfit of the cones at least this much to be believed.
constexpr double kLeastGain = 0.75;
/// Rings wider than this are not made by beams.
constexpr double kWidestCone_m = 0.03;

Status check(std::span<const RingedScan> scans) {
  if (scans.empty()) {
    return Error{ErrorCode::invalid_argument, "calibration needs at least one scan"};
  }
  const std::size_t rings = scans.front().rings->sensor.rings.size();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Detection& found = *scans[i].rings;
    if (found.ring_of_point.size() != scans[i].cloud->size()) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("scan {}: the rings are not those of its cloud", i)};
    }
    if (found.sensor.rings.size() != rings) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("scan {} has {} rings but scan 0 has {}: calibrate scans of one "
                               "sensor together",
                               i, found.sensor.rings.size(), rings)};
    }
  }
  return {};
}

/// Further digits are noise; without them a beam that is said to look 15 degrees up does.
void round_off(BeamModel& model) {
  const auto angle = [](double radians) {
    return radians_of(std::round(degrees_of(radians) * 1e6) / 1e6 + 0.0);
  };
  const auto length = [](double metres) { return std::round(metres * 1e7) / 1e7 + 0.0; };
  for (Beam& beam : model.beams) {
    beam.elevation = angle(beam.elevation);
    beam.azimuth_offset = angle(beam.azimuth_offset);
    beam.height_m = length(beam.height_m);
    beam.lateral_m = length(beam.lateral_m);
    beam.range_phase_m = length(beam.range_phase_m);
  }
}

/// The state that the steps below hand on.
class Calibrator {
 public:
  Calibrator(std::span<const RingedScan> scans, const CalibrateSettings& settings)
      : scans_(scans), settings_(settings) {
    const std::size_t share =
        std::clamp(kMostReturns / scans.size(), kLeastReturnsOfScan, kMostReturnsOfScan);
    for (const RingedScan& scan : scans) {
      all_.push_back(calibration::all_returns(scan));
      samples_.push_back(calibration::thin(all_.back(), ring_count(), share));
    }
    for (const Ring& ring : scans.front().rings->sensor.rings) {
      model_.beams.push_back({ring.elevation, 0, ring.vertical_offset_m, 0, 0});
    }
  }

  std::optional<Calibration> run() {
    report("cones", 0);
    if (!fit_cones()) return std::nullopt;
    report("encoder", 0.3);
    if (!fit_encoder()) return std::nullopt;
    report("beams", 0.6);
    refine_all();
    report("firings and range unit", 0.9);
    return finish();
  }

 private:
  std::size_t ring_count() const { return scans_.front().rings->sensor.rings.size(); }

  void report(const char* stage, double fraction) const {
    if (settings_.progress) settings_.progress(stage, fraction);
  }

  /// Elevations and heights, and all of the motions but their yaw.
  bool fit_cones() {
    RefineSettings still;
    still.threads = settings_.threads;
    misfit_ = refine(samples_, model_, still);
    if (settings_.motion && misfit_.up_m > kExact_m) {
      const BeamModel unmoved = model_;
      RefineSettings moving = still;
      moving.motion = true;
      moving.most_steps = 24;
      const Misfit with_motion = refine(samples_, model_, moving);
      moving_ = with_motion.up_m < kLeastGain * misfit_.up_m;
      if (moving_) {
        misfit_ = with_motion;
      } else {
        model_ = unmoved;
        for (ScanSample& sample : samples_) sample.motion = {};
      }
    }
    return misfit_.up_m < kWidestCone_m;
  }

  /// The slots that the scan's profile states, else all usual ones and its columns.
  std::vector<std::vector<std::uint32_t>> candidates() const {
    const SensorProfile& sensor = scans_.front().rings->sensor;
    std::vector<std::vector<std::uint32_t>> out;
    if (sensor.slots != 0) out.push_back({sensor.slots});
    std::vector<std::uint32_t> hints;
    for (const RingedScan& scan : scans_) hints.push_back(scan.rings->sensor.columns);
    out.push_back(calibration::slot_candidates(hints));
    return out;
  }

  /// Slots, and where they are: from the first scan that shows them.
  bool fit_encoder() {
    std::optional<calibration::Encoder> encoder;
    std::size_t first = 0;
    for (const auto& slots : candidates()) {
      for (first = 0; first < std::min<std::size_t>(3, samples_.size()) && !encoder; ++first) {
        all_[first].motion = samples_[first].motion;
        encoder = find_encoder(all_[first], ring_count(), slots, moving_);
      }
      if (encoder) break;
    }
    if (!encoder) return false;
    std::swap(samples_[0], samples_[first - 1]);
    std::swap(all_[0], all_[first - 1]);
    swapped_ = first - 1;
    model_.slots = encoder->slots;
    samples_[0].motion.turn.z = encoder->yaw;
    start_azimuths(samples_[0], model_);
    RefineSettings settings;
    settings.azimuth = true;
    settings.motion = moving_;
    refine(std::span(samples_).first(1), model_, settings);
    if (!moving_) return true;
    parallel_for(samples_.size() - 1, settings_.threads, [&](std::size_t i) {
      ScanSample& sample = samples_[i + 1];
      const auto yaw = find_yaw(sample, model_);
      if (yaw) sample.motion.turn.z = yaw->yaw;
    });
    return true;
  }

  void refine_all() {
    RefineSettings settings;
    settings.threads = settings_.threads;
    settings.azimuth = true;
    settings.motion = moving_;
    settings.most_steps = 16;
    settings.start_scale_m = 0.05;
    misfit_ = refine(samples_, model_, settings);
  }

  Calibration finish() {
    for (std::size_t i = 0; i < all_.size(); ++i) all_[i].motion = samples_[i].motion;
    Calibration out;
    out.range_resultant = find_range_unit(samples_, model_);
    align_firings(all_, model_);
    round_off(model_);
    std::swap(samples_[0], samples_[swapped_]);
    for (const ScanSample& sample : samples_) out.motions.push_back(sample.motion);
    out.model = std::move(model_);
    out.up_median_m = misfit_.up_m;
    out.across_median_m = misfit_.across_m;
    report("done", 1);
    return out;
  }

  std::span<const RingedScan> scans_;
  const CalibrateSettings& settings_;
  std::vector<ScanSample> all_, samples_;
  BeamModel model_;
  bool moving_ = false;
  std::size_t swapped_ = 0;  // the scan that changed places with the first
  Misfit misfit_;
};

}  // namespace

Result<std::optional<Calibration>> calibrate(std::span<const RingedScan> scans,
                                             const CalibrateSettings& settings) {
  CURLIDAR_TRY(check(scans));
  if (scans.front().rings->source == RingSource::uniform) return std::optional<Calibration>();
  std::vector<RingedScan> chosen;
  const std::size_t count = std::min(scans.size(), kMaxCalibrationScans);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(scans[i * scans.size() / count]);
  return Calibrator(chosen, settings).run();
}

Result<SensorProfile> profile_of(const BeamModel& model, const SensorProfile& nominal,
                                 const std::string& name) {
  SensorProfile profile = nominal;
  profile.name = name;
  profile.rings.clear();
  for (const Beam& beam : model.beams) {
    profile.rings.push_back(
        {beam.elevation, beam.azimuth_offset, beam.height_m, beam.lateral_m, beam.range_phase_m});
  }
  profile.slots = model.slots;
  profile.range_unit_m = model.range_unit_m;
  profile.beam_origin_radius_m = 0;
  profile.fov_up = profile.rings.front().elevation;
  profile.fov_down = profile.rings.back().elevation;
  if (Status status = validate(profile); !status) {
    return Error{ErrorCode::unsupported,
                 "the calibrated beams make no profile: " + status.error().message};
  }
  return profile;
}

}  // namespace curlidar
