// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/try.hpp"

namespace curlidar {
namespace {

/// Both have nothing to say where masks decide.
Status check_told(bool wanted, const char* what) {
  if (!wanted) return {};
  return Error{
      ErrorCode::invalid_argument,
      fmt::format("masks tell nothing of {}: ask with strategy best (--strategy best)", what)};
}

}  // namespace

DenseStrategy usual_strategy(const DecodedScan& scan) {
  return scan.profile == Profile::compact ? DenseStrategy::best : DenseStrategy::masks;
}

std::shared_ptr<const Field> continuous_field(
    const DecodedScan& scan, std::optional<DenseStrategy> strategy,
    std::shared_ptr<const DensityProfile> density_profile) {
  return dense_field(scan.field,
                     {strategy.value_or(usual_strategy(scan)), std::move(density_profile)});
}

Status check_bounds(const ReconstructSettings& settings) {
  const auto is_factor = [](double f) { return f >= kLeastFactor && f <= kMostFactor; };
  if (!is_factor(settings.rows) || !is_factor(settings.columns)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("the factors {} x {} do not lie between {} and {}", settings.rows,
                             settings.columns, kLeastFactor, kMostFactor)};
  }
  if (!(settings.min_confidence >= 0 && settings.min_confidence <= 1)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("the least confidence {} is not a probability from 0 to 1",
                             settings.min_confidence)};
  }
  return {};
}

Status check_settings(const DecodedScan& scan, const ReconstructSettings& settings) {
  CURLIDAR_TRY(check_bounds(settings));
  const DenseStrategy strategy = settings.strategy.value_or(usual_strategy(scan));
  if (settings.field || strategy != DenseStrategy::masks) return {};
  CURLIDAR_TRY(check_told(settings.confidence || settings.min_confidence > 0, "confidence"));
  return check_told(settings.density_profile != nullptr, "density profiles");
}

void Samples::append(const Samples& other) {
  points.insert(points.end(), other.points.begin(), other.points.end());
  confidence.insert(confidence.end(), other.confidence.begin(), other.confidence.end());
  ring.insert(ring.end(), other.ring.begin(), other.ring.end());
}

void Samples::drop_empty() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(points[i].x)) continue;
    points[kept] = points[i];
    confidence[kept] = confidence[i];
    if (!ring.empty()) ring[kept] = ring[i];
    ++kept;
  }
  resize(kept);
  if (!ring.empty()) ring.resize(kept);
  width = static_cast<std::uint32_t>(kept);
  height = 1;
}

View::View(const DecodedScan& scan, const ReconstructSettings& settings)
    : scan_(&scan),
      settings_(settings),
      field_(settings.field ? settings.field
                            : continuous_field(scan, settings.strategy, settings.density_profile)) {
}

Result<View> View::make(const DecodedScan& scan, const ReconstructSettings& settings) {
  CURLIDAR_TRY(check_settings(scan, settings));
  if (scan.records && scan.records->lattice == RecordLattice::none) {
    return Error{ErrorCode::invalid_argument,
                 "the file holds its points one after the other, without a field: it gives them as "
                 "they are, without other rows, columns or a grid"};
  }
  return View(scan, settings);
}

bool View::holds(const Vec3& point) const {
  if (!settings_.region) return true;
  const double turn = 2 * std::numbers::pi;
  const double width = settings_.region->azimuth_end - settings_.region->azimuth_begin;
  if (width >= turn) return true;
  double from_begin = std::fmod(azimuth_of(point) - settings_.region->azimuth_begin, turn);
  if (from_begin < 0) from_begin += turn;
  return from_begin < width;
}

void View::look(std::span<const Sightline> lines, std::span<Vec3> points,
                std::span<float> confidence, std::size_t threads) const {
  std::vector<RangeEstimate> estimates(lines.size());
  field_->range_along(lines, estimates, threads);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const RangeEstimate& estimate = estimates[i];
    confidence[i] = estimate.confidence;
    points[i] = kNoPoint;
    if (settings_.masks ? !estimate.valid() : std::isnan(estimate.range_m)) continue;
    if (!sure(estimate.confidence)) continue;
    const Vec3& d = lines[i].direction;
    const Vec3 point = lines[i].origin + d * (estimate.range_m / norm(d));
    if (holds(point)) points[i] = point;
  }
}

void View::look_along_row(double row, std::span<const double> columns, std::span<Vec3> points,
                          std::span<float> confidence) const {
  std::vector<double> ranges(columns.size());
  field_->evaluate_row(row, columns, settings_.masks, ranges);
  field_->place_row(row, columns, ranges, points);
  std::fill(confidence.begin(), confidence.end(), 0.0F);
  const bool all_the_same = !settings_.confidence && settings_.min_confidence == 0;
  std::vector<Sightline> lines;
  if (!all_the_same) lines = lines_of_row(*field_, row, columns);
  std::vector<RangeEstimate> estimates(lines.size());
  field_->range_along(lines, estimates);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const bool found = !std::isnan(ranges[i]) && holds(points[i]);
    if (!all_the_same) confidence[i] = estimates[i].confidence;
    if (!found || !sure(confidence[i])) points[i] = kNoPoint;
  }
}

std::vector<Sightline> lines_of_row(const Field& field, double row,
                                    std::span<const double> columns) {
  constexpr double kHere_m = 16, kThere_m = 32;
  std::vector<double> ranges(columns.size(), kHere_m);
  std::vector<Vec3> here(columns.size()), there(columns.size());
  field.place_row(row, columns, ranges, here);
  std::fill(ranges.begin(), ranges.end(), kThere_m);
  field.place_row(row, columns, ranges, there);
  std::vector<Sightline> lines(columns.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Vec3 step = there[i] - here[i];
    lines[i].direction = step * (1 / norm(step));
    lines[i].origin = here[i] - step * (kHere_m / (kThere_m - kHere_m));
  }
  return lines;
}

Status check_points(std::uint64_t rows, std::uint64_t columns, const char* what,
                    const ReconstructSettings& settings, std::uint64_t kept) {
  const std::uint64_t most = settings.max_points;
  if (kept <= most && (columns == 0 || rows <= (most - kept) / columns)) return {};
  const std::string beside = kept == 0 ? "" : fmt::format(", with the {} returns kept,", kept);
  return Error{ErrorCode::limit_exceeded,
               fmt::format("{} of {} x {}{} has more than the {} points allowed", what, rows,
                           columns, beside, most)};
}

}  // namespace curlidar
