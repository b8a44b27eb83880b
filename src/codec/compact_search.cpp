// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "format/container.hpp"
#include "records/grid.hpp"

namespace curlidar {
namespace {

constexpr std::uint32_t kMostTrials = 14;
/// Efforts from here on, and predicted scans, which are quick, come nearer to the target, for files
/// some 2 % smaller.
constexpr std::uint32_t kPatientEffort = 7;
/// Of the logarithm of the error over that of the step; of bits, the same downwards.
constexpr double kUsualSlope = 0.75;
/// Where to aim between the target and the least that is good enough.
constexpr double kAim = 0.45;

/// Bits per return at some mean errors, on HDL-64E scans: where to start.
struct RatePoint {
  double error_m, bits;
};
constexpr std::array<RatePoint, 7> kUsualRates{{{0.0005, 6.8},
                                                {0.002, 4.8},
                                                {0.005, 3.3},
                                                {0.01, 2.3},
                                                {0.02, 1.4},
                                                {0.05, 0.65},
                                                {0.2, 0.3}}};

double usual_error_at(double bits) {
  std::size_t i = 0;
  while (i + 2 < kUsualRates.size() && kUsualRates[i + 1].bits > bits) ++i;
  const RatePoint &a = kUsualRates[i], &b = kUsualRates[i + 1];
  const double share = std::log(bits / a.bits) / std::log(b.bits / a.bits);
  return std::clamp(a.error_m * std::exp(share * std::log(b.error_m / a.error_m)), 1e-5, 10.0);
}

std::int64_t to_units(double metres) {
  return std::max<std::int64_t>(1, std::llround(metres * compact::kRangeUnit));
}

compact::Steps steps_of_step(double metres) {
  return compact::steps_for_step(static_cast<std::int32_t>(to_units(metres)));
}

Result<double> worse_direction(const CompactJob& job, const std::vector<Vec3>& points) {
  Cloud original, back;
  for (const Vec3& p : job.cloud.positions) {
    const double range = norm(p);
    const bool counts =
        job.loose || (range >= job.scan.min_range_m && range <= job.scan.max_range_m);
    if (is_return(p) && counts) original.positions.push_back(p);
  }
  back.positions = points;
  if (job.loose) back.positions.insert(back.positions.end(), job.loose->begin(), job.loose->end());
  return worse_mean_distance(original, back, job.threads);
}

/// The natural logarithm of what a trial reached over what is wanted.
double miss_of(const CompactTrial& trial, const CompactSettings& settings) {
  double reached = trial.errors.mean;
  if (settings.target == CompactTarget::error_nn) reached = trial.error_nn_m;
  if (settings.target == CompactTarget::bits_per_point) reached = trial.bits_per_point;
  return std::log(std::max(reached, 1e-9) / settings.target_value);
}

/// One place where the search has looked.
struct Probe {
  double at = 0;    ///< logarithm of the scale
  double miss = 0;  ///< see miss_of
};

/// Finds the scale at which a noisy, otherwise steady function misses by a little less than 0.
class Secant {
 public:
  Secant(double slope, double aim) : slope_(slope), aim_(aim) {}

  void add(const Probe& probe) {
    std::optional<Probe>& side = probe.miss <= 0 ? inside_ : outside_;
    if (last_) learn_slope(*last_, probe);
    side = probe;
    last_ = probe;
  }
  double next() const {
    const double guess = last_->at + (aim_ - last_->miss) / slope_;
    if (!inside_ || !outside_) return guess;
    const double low = std::min(inside_->at, outside_->at);
    const double high = std::max(inside_->at, outside_->at);
    const double margin = 0.05 * (high - low);
    return guess > low + margin && guess < high - margin ? guess : (low + high) / 2;
  }

 private:
  /// Noise must not turn the slope round or make it flat.
  void learn_slope(const Probe& a, const Probe& b) {
    if (std::abs(b.at - a.at) < 1e-4) return;
    const double seen = (b.miss - a.miss) / (b.at - a.at);
    const double sign = slope_ > 0 ? 1 : -1;
    slope_ = sign * std::clamp(seen * sign, 0.3, 1.5);
  }

  double slope_, aim_;
  std::optional<Probe> inside_, outside_, last_;
};

Error out_of_reach(const CompactJob& job, double reached) {
  const CompactSettings& s = job.settings;
  if (s.target == CompactTarget::bits_per_point) {
    return {ErrorCode::invalid_argument,
            fmt::format("{:.3g} bits per point are out of reach: this scan takes {:.3g} at the "
                        "coarsest; ask for more (--bits), or for an error",
                        s.target_value, reached)};
  }
  const CellOffsets beside = cell_offsets(job.cloud, job.scan, job.model.table);
  std::string reason = fmt::format("an error of {:.4g} m is out of reach: {:.4g} m is the least",
                                   s.target_value, reached);
  if (beside.across > beside.along && beside.across > 0.2 * s.target_value) {
    const double wanted = job.scan.columns * beside.across / (0.5 * s.target_value);
    const double columns = std::exp2(std::ceil(std::log2(wanted)));
    reason += fmt::format(
        " with {} columns, whose middles lie {:.3g} m beside the returns; take {} (--cols {}) or a "
        "larger error",
        job.scan.columns, beside.across, columns <= 65536 ? "more columns" : "the most columns",
        static_cast<std::uint32_t>(std::min(columns, 65536.0)));
  } else if (beside.along > 0.2 * s.target_value) {
    reason += fmt::format(
        ", because the returns lie {:.3g} m above or below their rings; take a larger error",
        beside.along);
  } else {
    reason += "; ranges are coded to 1/65536 m; take a larger error";
  }
  return {ErrorCode::invalid_argument, reason};
}

/// The part of the wanted error that is left for ranges beside what directions take.
double range_share(const CompactJob& job, double error_m) {
  const double directions =
      own_errors(job.cloud, job.scan, points_of(job.model, job.model.image)).mean;
  return std::sqrt(std::max(error_m * error_m - directions * directions, 0.01 * error_m * error_m));
}

/// A wanted error for which steps_for_error lays fine residuals on a coarse field.
constexpr double kFineResiduals_m =
    0.97 * static_cast<double>(compact::kCoarseFieldBelow) / compact::kRangeUnit;

/// Wanted errors between which either kind of field may need fewer bits.
constexpr std::array<double, 2> kBothKinds_m{0.003, 0.025};

bool is_patient(const CompactJob& job) {
  return job.settings.effort >= kPatientEffort ||
         (job.predicted != nullptr && job.settings.effort >= compact::kDefaultEffort);
}

/// Looks for the steps that reach a job's target.
class TargetSearch {
 public:
  explicit TargetSearch(const CompactJob& job)
      : job_(job),
        bits_(job.settings.target == CompactTarget::bits_per_point),
        good_(std::log(is_patient(job)                                           ? 0.985
                       : bits_ || job.settings.effort >= compact::kDefaultEffort ? 0.97
                                                                                 : 0.95)) {}

  /// Searches over the scale of the steps for a mean error of `error_m`, which decides what kind of
  /// coding is used.
  Status run(double error_m, compact::FieldKind kind, double start = 0) {
    Secant secant(bits_ ? -kUsualSlope : kUsualSlope, good_ * kAim);
    double at = start;
    std::optional<compact::Steps> last;
    for (std::uint32_t i = 0; i < kMostTrials; ++i) {
      const compact::Steps steps = compact::steps_for_error(
          to_units(error_m), std::max<std::int64_t>(1, std::llround(65536 * std::exp(at))), kind);
      if (last && last->step == steps.step && last->residual_step == steps.residual_step) break;
      last = steps;
      CURLIDAR_TRY_ASSIGN(miss, take(steps));
      if (best_ && best_miss_ > good_) break;
      if (bits_ && i < 2 && at == 0 && std::abs(miss) > 0.3) {
        // Far off: the guess of the error was wrong, and with it the kind of coding.
        error_m = std::clamp(error_m * std::exp(miss / kUsualSlope), 1e-5, 100.0);
        continue;
      }
      if (!bits_ && miss > 0 && at < kHopeless) break;
      secant.add({at, miss});
      at = std::clamp(secant.next(), -9.0, 9.0);
    }
    return {};
  }

  bool found() const { return best_.has_value(); }
  double least_miss() const { return least_miss_; }
  CompactTrial best() && {
    best_->encodings = encodings_;
    return *std::move(best_);
  }

 private:
  /// Steps an eighth of the usual ones that do not reach an error will not get there.
  static constexpr double kHopeless = -2.1;

  /// Encodes once; gives how far that is from the target.
  Result<double> take(const compact::Steps& steps) {
    CURLIDAR_TRY_ASSIGN(trial, try_steps(job_, steps, job_.settings.effort));
    const double miss = miss_of(trial, job_.settings);
    least_miss_ = encodings_ == 0 ? miss : std::min(least_miss_, miss);
    ++encodings_;
    if (job_.progress) job_.progress("search", std::min(encodings_ / 8.0, 0.9));
    if (miss <= 0 && (!best_ || miss > best_miss_)) {
      best_ = std::move(trial);
      best_miss_ = miss;
    }
    return miss;
  }

  const CompactJob& job_;
  bool bits_;
  double good_;  ///< misses above it, up to 0, are what is wanted
  std::optional<CompactTrial> best_;
  double best_miss_ = 0, least_miss_ = 0;
  std::uint32_t encodings_ = 0;
};

/// The usual steps for the target times exp(`log_scale`).
compact::Steps scaled_steps(const CompactJob& job, double log_scale) {
  const double error_m = first_error_guess(job.settings);
  const bool bits = job.settings.target == CompactTarget::bits_per_point;
  const auto scale = std::max<std::int64_t>(1, std::llround(65536 * std::exp(log_scale)));
  return compact::steps_for_error(to_units(bits ? error_m : range_share(job, error_m)), scale,
                                  job.kind);
}

/// The chunk of the model's offsets for ranges as decoded.
std::vector<std::byte> encode_offsets(const CompactModel& model, const compact::Image& decoded) {
  std::vector<std::uint8_t> occupied;
  std::vector<std::int32_t> ranges;
  occupied.reserve(decoded.range.size());
  for (const std::int32_t range : decoded.range) {
    occupied.push_back(range > 0 ? 1 : 0);
    if (range > 0) ranges.push_back(range);
  }
  const CellGrid grid{decoded.rows, decoded.columns, occupied, 0};
  return encode_directions(grid, ranges, model.offsets, model.direction_step).bytes;
}

}  // namespace

Result<CompactTrial> try_steps(const CompactJob& job, const compact::Steps& steps,
                               std::uint32_t effort) {
  compact::ScanSettings settings;
  settings.steps = steps;
  settings.effort = effort;
  settings.index = job.settings.index;
  settings.bands = job.settings.bands;
  settings.sectors = job.settings.sectors;
  settings.threads = job.threads;
  settings.max_error = job.max_error;
  if (job.predicted != nullptr) {
    settings.prediction = &job.predicted->prediction;
    settings.header = &job.predicted->header;
  }
  CURLIDAR_TRY_ASSIGN(encoded, encode_scan(job.model.image, job.model.table, settings));
  CompactTrial trial;
  trial.steps = steps;
  const std::vector<Vec3> points = points_of(job.model, encoded.decoded);
  trial.errors = own_errors(job.cloud, job.scan, points);
  ContainerWriter writer;
  for (const compact::ScanChunk& chunk : encoded.chunks) {
    writer.add(static_cast<ChunkType>(chunk.part), chunk.payload);
  }
  if (job.model.direction_step > 0) {
    trial.directions = encode_offsets(job.model, encoded.decoded);
    writer.add(ChunkType::directions, trial.directions);
  }
  trial.bits_per_point =
      (8.0 * static_cast<double>(std::move(writer).finish().size()) + job.beside_bits) /
      static_cast<double>(job.scan.counts.kept + (job.loose ? job.loose->size() : 0));
  if (job.settings.target == CompactTarget::error_nn) {
    CURLIDAR_TRY_ASSIGN(distance, worse_direction(job, points));
    trial.error_nn_m = distance;
  }
  trial.encoded = std::move(encoded);
  return trial;
}

compact::Steps usual_steps(const CompactJob& job) {
  if (job.settings.target == CompactTarget::step) return steps_of_step(job.settings.target_value);
  return scaled_steps(job, 0);
}

Status choose_kind(CompactJob& job) {
  const double error_m = first_error_guess(job.settings);
  if (job.settings.effort < compact::kDefaultEffort || job.settings.target == CompactTarget::step ||
      error_m < kBothKinds_m.front() || error_m > kBothKinds_m.back()) {
    return {};
  }
  std::optional<CompactTrial> best;
  compact::FieldKind best_kind = job.kind;
  double best_start = 0;
  for (const compact::FieldKind kind : {compact::FieldKind::close, compact::FieldKind::coarse}) {
    job.kind = kind;
    CURLIDAR_TRY_ASSIGN(first, try_steps(job, usual_steps(job), compact::kDefaultEffort));
    // Which kind is the better one changes quickly with the error: compare near the wanted one.
    const double at = start_after(first, job.settings, compact::kDefaultEffort);
    CURLIDAR_TRY_ASSIGN(trial, try_steps(job, scaled_steps(job, at), compact::kDefaultEffort));
    if (best && !is_cheaper(trial, *best)) continue;
    best_kind = kind;
    best_start = at + start_after(trial, job.settings, compact::kDefaultEffort);
    best = std::move(trial);
  }
  job.start = best_start;
  job.kind = best_kind;
  return {};
}

bool is_cheaper(const CompactTrial& a, const CompactTrial& b) {
  // Halving the error costs a bit a return where residuals carry the range, and a share of the
  // bits where surfaces do.
  const double bits = (a.bits_per_point + b.bits_per_point) / 2;
  const double exponent = std::min(0.8, std::numbers::log2e / bits);
  return std::log(a.bits_per_point / b.bits_per_point) <
         exponent * std::log(b.errors.mean / a.errors.mean);
}

double start_after(const CompactTrial& quick, const CompactSettings& settings,
                   std::uint32_t effort) {
  // What an effort finds that a quick encoding does not, in errors or bits.
  constexpr double kGainAnEffort = 0.03;
  const double miss = miss_of(quick, settings) - kGainAnEffort * (settings.effort - effort);
  const bool bits = settings.target == CompactTarget::bits_per_point;
  if (bits && std::abs(miss) > 0.3) return 0;
  const double aim = kAim * std::log(0.95);
  return std::clamp((aim - miss) / (bits ? -kUsualSlope : kUsualSlope), -1.5, 1.5);
}

double first_error_guess(const CompactSettings& settings) {
  switch (settings.target) {
    case CompactTarget::error:
      return settings.target_value;
    case CompactTarget::error_nn:
      return 1.2 * settings.target_value;
    case CompactTarget::step:
      return settings.target_value / 6;
    case CompactTarget::bits_per_point:
      return usual_error_at(settings.target_value);
    case CompactTarget::max_error:
      return 0.35 * settings.target_value;
    case CompactTarget::lossless:
      return 1e-4;
  }
  return settings.target_value;
}

Result<CompactTrial> search_target(const CompactJob& job) {
  const CompactSettings& s = job.settings;
  if (s.target == CompactTarget::step) {
    return try_steps(job, steps_of_step(s.target_value), s.effort);
  }
  TargetSearch search(job);
  CURLIDAR_TRY(search.run(s.target == CompactTarget::bits_per_point
                              ? first_error_guess(s)
                              : range_share(job, first_error_guess(s)),
                          job.kind, job.start));
  // Little effort may leave surfaces that no step brings near enough: residuals always do.
  if (!search.found() && s.target != CompactTarget::bits_per_point &&
      first_error_guess(s) > kFineResiduals_m) {
    CURLIDAR_TRY(search.run(kFineResiduals_m, compact::FieldKind::coarse));
  }
  if (!search.found()) return out_of_reach(job, s.target_value * std::exp(search.least_miss()));
  return std::move(search).best();
}

}  // namespace curlidar
