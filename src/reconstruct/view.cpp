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

constexpr double kTurn = 2 * std::numbers::pi;

/// Angle counter-clockwise from one azimuth to another, in [0, 2 pi).
double turn_on(double from, double to) {
  const double turn = std::fmod(to - from, kTurn);
  return turn < 0 ? turn + kTurn : turn;
}

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

std::shared_ptr<const Field> continuous_field(const DecodedScan& scan,
                                              std::optional<DenseStrategy> strategy,
                                              std::shared_ptr<const DensityProfile> density_profile,
                                              bool rows_of_profile) {
  DenseSettings settings;
  settings.strategy = strategy.value_or(usual_strategy(scan));
  settings.profile = std::move(density_profile);
  settings.rows_of_profile = rows_of_profile;
  return dense_field(scan.field, settings);
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

Status check_lattice(const DecodedScan& scan) {
  if (!scan.records || scan.records->lattice != RecordLattice::none) return {};
  return Error{ErrorCode::invalid_argument,
               "the file holds its points one after the other, without a field: it gives them as "
               "they are, without other rows, columns or a grid"};
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

ScanView::ScanView(const DecodedScan& scan, const ReconstructSettings& settings,
                   bool rows_of_profile)
    : scan_(&scan),
      settings_(settings),
      field_(settings.field ? settings.field
                            : continuous_field(scan, settings.strategy, settings.density_profile,
                                               rows_of_profile)) {
  if (!settings.region) return;
  cropped_ = settings.region->azimuth_end - settings.region->azimuth_begin < kTurn;
  double nearest = scan.points.empty() ? 0 : norm(scan.points.front());
  for (const Vec3& p : scan.points) nearest = std::min(nearest, norm(p));
  nearest_m_ = nearest / 2;
}

Result<ScanView> ScanView::make(const DecodedScan& scan, const ReconstructSettings& settings,
                                bool rows_of_profile) {
  CURLIDAR_TRY(check_settings(scan, settings));
  CURLIDAR_TRY(check_lattice(scan));
  return ScanView(scan, settings, rows_of_profile);
}

bool ScanView::holds(const Vec3& point) const {
  if (!cropped_) return true;
  const ScanRegion& region = *settings_.region;
  return turn_on(region.azimuth_begin, azimuth_of(point)) <
         region.azimuth_end - region.azimuth_begin;
}

bool ScanView::may_hold(const Sightline& line) const {
  constexpr double kMargin = 1e-6;  // radians, for what is rounded
  if (!cropped_) return true;
  // Along a straight line the azimuth turns one way, to that of its direction.
  const double far = azimuth_of(line.direction);
  const Vec3 start = line.origin + line.direction * (nearest_m_ / norm(line.direction));
  const bool beside = start.x != 0 || start.y != 0;
  const double turn = beside ? std::remainder(far - azimuth_of(start), kTurn) : 0;
  const double first = std::min(far, far - turn) - kMargin;
  const double width = std::abs(turn) + 2 * kMargin;
  const ScanRegion& region = *settings_.region;
  return turn_on(region.azimuth_begin, first) < region.azimuth_end - region.azimuth_begin ||
         turn_on(first, region.azimuth_begin) < width;
}

void ScanView::look(std::span<const Sightline> lines, std::span<Vec3> points,
                    std::span<float> confidence, std::size_t threads) const {
  std::vector<std::size_t> wanted;
  std::vector<Sightline> asked;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    points[i] = kNowherePoint;
    confidence[i] = 0;
    if (!may_hold(lines[i])) continue;
    wanted.push_back(i);
    asked.push_back(lines[i]);
  }
  std::vector<RangeEstimate> estimates(asked.size());
  if (asks_confidence()) {
    field_->range_along(asked, estimates, threads);
  } else {
    field_->surfaces_along(asked, estimates, threads);
  }
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const RangeEstimate& estimate = estimates[k];
    confidence[wanted[k]] = estimate.confidence;
    if (settings_.masks ? !estimate.valid() : std::isnan(estimate.range_m)) continue;
    if (!sure(estimate.confidence)) continue;
    const Vec3& d = asked[k].direction;
    const Vec3 point = asked[k].origin + d * (estimate.range_m / norm(d));
    if (holds(point)) points[wanted[k]] = point;
  }
}

void ScanView::look_along_row(double row, std::span<const double> columns, std::span<Vec3> points,
                              std::span<float> confidence) const {
  std::vector<double> ranges(columns.size());
  field_->evaluate_row(row, columns, settings_.masks, ranges);
  field_->place_row(row, columns, ranges, points);
  std::fill(confidence.begin(), confidence.end(), 0.0F);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!std::isnan(ranges[i]) && holds(points[i])) {
      found.push_back(i);
    } else {
      points[i] = kNowherePoint;
    }
  }
  if (!asks_confidence()) return;
  std::vector<double> asked(found.size());
  for (std::size_t k = 0; k < found.size(); ++k) asked[k] = columns[found[k]];
  std::vector<RangeEstimate> estimates(found.size());
  field_->range_along(lines_of_row(*field_, row, asked), estimates);
  for (std::size_t k = 0; k < found.size(); ++k) {
    confidence[found[k]] = estimates[k].confidence;
    if (!sure(estimates[k].confidence)) points[found[k]] = kNowherePoint;
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
