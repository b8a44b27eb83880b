// SPDX-License-Identifier: BSD-3-Clause
// 16 rings to 64 by TULIP's protocol: every method predicts the rows of the image between those
// given.
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "dense/row_rules.hpp"
#include "report/measure/codecs.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/json.hpp"
#include "report/measure/own_scan.hpp"
#include "report/measure/ring_samples.hpp"
#include "report/measure/tulip.hpp"
#include "report/measure/upsampling_files.hpp"
#include "report/measure/verbs.hpp"
#include "sensor/angles.hpp"

namespace curlidar::bench {
namespace {

using tulip::Image;
using tulip::kColumns;
using tulip::kEvery;
using tulip::kRows;

/// Ranges of the rows between the given ones, by the ranges below and above (0: none) and how far
/// up the row lies between them.
using Between = std::function<double(double below, double above, double up)>;

Image interpolate(const Image& given, const Between& between) {
  Image image;
  for (std::size_t row = 0; row < kRows; ++row) {
    const std::size_t lower = row / kEvery * kEvery, upper = lower + kEvery;
    const double up = static_cast<double>(row - lower) / kEvery;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double below = given.at(lower, column);
      image.at(row, column) = upper < kRows ? between(below, given.at(upper, column), up) : below;
    }
  }
  return image;
}

double nearest_ring(double below, double above, double up) {
  return up < .5 ? below : above;
}

double edge_aware(double below, double above, double up) {
  const auto range = [](double r) { return r > 0 ? r : std::nan(""); };
  const double mixed = mix_ranges(range(below), range(above), up, Mixing::edge_aware);
  return std::isnan(mixed) ? 0 : mixed;
}

/// The given rows as rings, from the top; elevations are the profile's, or the rows' own.
struct GivenRings {
  Cloud cloud;
  std::vector<std::uint16_t> ring_of_point;
  std::vector<double> elevations;

  RingPoints points() const { return {cloud.positions, ring_of_point, elevations, kColumns}; }
};

GivenRings rings_of(const Image& given, const DensityProfile& profile) {
  GivenRings rings;
  for (std::size_t row = profile.given_first; row < kRows; row += kEvery) {
    const std::size_t image_row = kRows - 1 - row;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double range = given.at(image_row, column);
      if (!(range > 0)) continue;
      const double azimuth = tulip::azimuth_of_column(static_cast<double>(column));
      rings.cloud.positions.push_back(direction_of(profile.elevation(row, range), azimuth) * range);
      rings.ring_of_point.push_back(static_cast<std::uint16_t>(rings.elevations.size()));
    }
    rings.elevations.push_back(tulip::elevation_of_row(static_cast<double>(image_row)));
  }
  rings.cloud.width = static_cast<std::uint32_t>(rings.cloud.size());
  return rings;
}

/// The returns that lie in the given rows, all of them: what a sensor of 16 rings measures.
Cloud returns_of_given_rows(const Cloud& own) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t i = 0; i < own.size(); ++i) {
    std::size_t row = 0, column = 0;
    if (!is_return(own.positions[i]) || !tulip::locate(own.positions[i], row, column)) continue;
    if (row % kEvery == 0) slots.push_back(i);
  }
  Cloud given = select(own, slots);
  given.attributes.clear();
  return given;
}

/// The image of such returns as a compact file of so many bits a point has them.
struct CodedImage {
  Image image;
  double bits_per_point = 0, step_m = 0;
};

Result<CodedImage> code(const Cloud& returns, const SensorProfile& sensor, double bits) {
  EncodeSettings settings = compact_of_scan(CompactTarget::bits_per_point, bits);
  settings.sensor = sensor;
  CURLIDAR_TRY_ASSIGN(encoded, encode(returns, settings));
  CURLIDAR_TRY_ASSIGN(decoded, decode(encoded.bytes));
  Cloud cloud;
  cloud.positions = decoded.cloud ? decoded.cloud->positions : decoded.points;
  return CodedImage{tulip::given_rows(tulip::project(cloud)), encoded.report.bits_per_point,
                    decoded.compact ? decoded.compact->step_m : 0};
}

/// What is known without a profile.
DensityProfile nominal_rows() {
  DensityProfile profile;
  profile.rows = kRows;
  profile.given_first = kEvery - 1;
  profile.given_every = kEvery;
  profile.elevation_mdeg = RangeTable(kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    const double elevation = tulip::elevation_of_row(static_cast<double>(kRows - 1 - row));
    profile.elevation_mdeg.row(row).fill(
        static_cast<std::int16_t>(std::lround(1000 * degrees_of(elevation))));
  }
  return profile;
}

Image predict(const RingPoints& points, const DensityProfile& profile) {
  const RowRules rules(points, profile);
  Image image;
  for (std::size_t row = 0; row < kRows; ++row) {
    if (profile.is_given(row)) continue;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double azimuth = tulip::azimuth_of_column(static_cast<double>(column));
      const RowGuess found =
          rules.guess_along_row(row, std::remainder(azimuth, 2 * std::numbers::pi));
      if (found.guess.seen == Seen::surface) image.at(kRows - 1 - row, column) = found.guess.r;
    }
  }
  return image;
}

Json to_json(const tulip::Scores& s) {
  return {{"mae_m", s.mae_m},
          {"both_valid_mae_m", s.both_valid_mae_m},
          {"chamfer_m2", s.chamfer_m2},
          {"iou", s.iou},
          {"f1", s.f1},
          {"precision", s.precision},
          {"recall", s.recall},
          {"mask_iou", s.mask_iou},
          {"p50", s.median_m},
          {"p95", s.p95_m},
          {"completeness", s.completeness}};
}

Status print_scores(Json line, const Image& predicted, const Image& given, const Image& truth) {
  CURLIDAR_TRY_ASSIGN(scores, tulip::score(predicted, given, truth));
  line.update(to_json(scores));
  print_line(line);
  return {};
}

/// Prints an image that was decoded: with its own given rows, and with these left exact.
Status print_decoded(const std::string& method, double bits, const Image& decoded,
                     const Image& told, const Image& given, const Image& truth) {
  const auto line = [&](const char* rows) {
    return Json{{"method", method + rows}, {"bits_per_point", bits}};
  };
  CURLIDAR_TRY(print_scores(line(""), told, decoded, truth));
  return print_scores(line(", given rows exact"), told, given, truth);
}

/// What a user has: files of 16 rings of the sensor, seen by the whole one.
Status print_files(const OwnScan& own, const std::shared_ptr<const DensityProfile>& profile,
                   const Image& truth, const Image& given) {
  constexpr double kFine_m = 0.005;
  const std::array files{std::tuple{"file, 5 mm", CompactTarget::error, kFine_m},
                         std::tuple{"file, 1 bit", CompactTarget::bits_per_point, 1.0}};
  for (const auto& [name, target, value] : files) {
    CURLIDAR_TRY_ASSIGN(file, file_of_rings(own.cloud, own.rings, target, value));
    CURLIDAR_TRY_ASSIGN(plain, seen_by(file, own.rings.sensor, nullptr));
    CURLIDAR_TRY(print_decoded(name, file.bits_per_point, plain, plain, given, truth));
    if (!profile) continue;
    CURLIDAR_TRY(check_density_profile(*profile, *file.scan.field));
    CURLIDAR_TRY_ASSIGN(taught, seen_by(file, own.rings.sensor, profile));
    CURLIDAR_TRY(print_decoded(std::string(name) + ", profile", file.bits_per_point, taught, taught,
                               given, truth));
  }
  return {};
}

}  // namespace

Status upsampling(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(own, own_scan(scan));
  const Image truth = tulip::project(own.cloud);
  const Image given = tulip::given_rows(truth);
  print_line({{"motion_undone", own.motion_undone}});
  const auto print = [&](const std::string& method, const Image& predicted) {
    return print_scores({{"method", method}}, predicted, given, truth);
  };
  CURLIDAR_TRY(print("nearest ring", interpolate(given, nearest_ring)));
  CURLIDAR_TRY(print("edge-aware", interpolate(given, edge_aware)));
  const DensityProfile nominal = nominal_rows();
  CURLIDAR_TRY(print("rules", predict(rings_of(given, nominal).points(), nominal)));
  CURLIDAR_TRY_ASSIGN(of_rings, density_profile_of(arguments, "rings-profile"));
  CURLIDAR_TRY(print_files(own, of_rings, truth, given));
  CURLIDAR_TRY_ASSIGN(profile, density_profile_of(arguments, "profile"));
  if (!profile) return {};
  if (profile->rows != kRows || profile->given_first != nominal.given_first ||
      profile->given_every != kEvery) {
    return Error{ErrorCode::invalid_argument,
                 "--profile: not a profile of 64 rows of which every fourth is given"};
  }
  const GivenRings rings = rings_of(given, *profile);
  DensityProfile tables = *profile;
  tables.returns = tables.residual = {};
  CURLIDAR_TRY(print("rules, tables", predict(rings.points(), tables)));
  CURLIDAR_TRY(print("rules, tables, trees", predict(rings.points(), *profile)));
  const Cloud returns = returns_of_given_rows(own.cloud);
  for (const double bits : {1.0, 2.0}) {
    CURLIDAR_TRY_ASSIGN(coded, code(returns, own.rings.sensor, bits));
    const Image told = predict(rings_of(coded.image, *profile).points(), *profile);
    CURLIDAR_TRY(print_decoded(fmt::format("decoded image, {} bit", bits), coded.bits_per_point,
                               coded.image, told, given, truth));
  }
  return {};
}

}  // namespace curlidar::bench
