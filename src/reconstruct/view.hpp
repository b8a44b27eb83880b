// SPDX-License-Identifier: BSD-3-Clause
// A decoded scan as its reconstructions look at it: along lines of sight, believing or not.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "curlidar/reconstruct.hpp"

namespace curlidar {

/// Points found along lines of sight; NaN where nothing is believed.
struct Samples {
  std::vector<Vec3> points;
  std::vector<float> confidence;    ///< of the points
  std::vector<std::uint16_t> ring;  ///< of a virtual sensor; else empty
  std::uint32_t width = 0, height = 1;

  void resize(std::size_t size) {
    points.resize(size);
    confidence.resize(size);
  }
  void append(const Samples& other);
  /// Removes the empty slots, and with them the layout.
  void drop_empty();
};

/// The field of a scan and what of it is to be believed. `scan` must outlive the view.
class ScanView {
 public:
  /// Invalid_argument as check_settings says, and for files without a field.
  /// `rows_of_profile`: lines that are those of a row of the density profile are to see what that
  /// row would have measured.
  static Result<ScanView> make(const DecodedScan& scan, const ReconstructSettings& settings,
                               bool rows_of_profile = false);

  const DecodedScan& scan() const { return *scan_; }
  const ReconstructSettings& settings() const { return settings_; }
  const Field& field() const { return *field_; }

  /// Looks along the lines; all three have the same size.
  void look(std::span<const Sightline> lines, std::span<Vec3> points, std::span<float> confidence,
            std::size_t threads) const;
  /// A line of the lattice at these columns: as look does from the places where its lines start,
  /// at exactly the ranges of evaluate_row.
  void look_along_row(double row, std::span<const double> columns, std::span<Vec3> points,
                      std::span<float> confidence) const;
  /// Whether a point lies in the part of the scan that was asked for.
  bool holds(const Vec3& point) const;
  /// Whether any point of a line may, from the scan's nearest returns on.
  bool may_hold(const Sightline& line) const;

 private:
  /// Whether that much is enough; a confidence that is not told (NaN) is, if none is wanted.
  bool sure(float confidence) const {
    return settings_.min_confidence == 0 || confidence >= settings_.min_confidence;
  }

  bool asks_confidence() const { return settings_.confidence || settings_.min_confidence > 0; }

  ScanView(const DecodedScan& scan, const ReconstructSettings& settings, bool rows_of_profile);

  const DecodedScan* scan_;
  ReconstructSettings settings_;
  bool cropped_ = false;  ///< a part was asked for that is no full turn
  double nearest_m_ = 0;  ///< half as far as the nearest return
  std::shared_ptr<const Field> field_;
};

/// Lines of sight of a fractional row of the lattice at fractional columns, as the field places
/// points on them.
std::vector<Sightline> lines_of_row(const Field& field, double row,
                                    std::span<const double> columns);

/// Calls body(begin, end) for consecutive parts of [0, count), and progress between them.
template <class Body>
void in_batches(std::size_t count, std::size_t batch, const ProgressCallback& progress,
                const Body& body) {
  for (std::size_t begin = 0; begin < count; begin += batch) {
    if (progress) {
      progress("reconstruct", static_cast<double>(begin) / static_cast<double>(count));
    }
    body(begin, std::min(count, begin + batch));
  }
}

/// Invalid_argument for factors and confidences that lie nowhere.
Status check_bounds(const ReconstructSettings& settings);
/// Files that hold points one after the other have neither a field nor a lattice: invalid_argument.
Status check_lattice(const DecodedScan& scan);

/// Limit_exceeded for more points than the settings allow; `what` makes them beside those kept.
Status check_points(std::uint64_t rows, std::uint64_t columns, const char* what,
                    const ReconstructSettings& settings, std::uint64_t kept = 0);

inline constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
inline constexpr Vec3 kNowherePoint{kNowhere, kNowhere, kNowhere};

}  // namespace curlidar
