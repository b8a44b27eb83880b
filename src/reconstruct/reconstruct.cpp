// SPDX-License-Identifier: BSD-3-Clause
// Paper, III-D: the field sampled on a grid of any density.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/parallel.hpp"
#include "curlidar/reconstruct.hpp"

namespace curlidar {
namespace {

constexpr std::uint32_t kNoReturn = std::numeric_limits<std::uint32_t>::max();

/// One row of the dense grid: the believed points and the coded return nearest to each.
struct Line {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> nearest;
};

/// Number of the coded return of each cell in raster order; kNoReturn in empty cells.
std::vector<std::uint32_t> number_returns(const Field& field) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(field.lattice().cells());
  std::uint32_t next = 0;
  for (std::uint32_t row = 0; row < field.lattice().rows(); ++row) {
    for (std::uint32_t column = 0; column < field.lattice().columns(); ++column) {
      numbers.push_back(field.occupied(row, column) ? next++ : kNoReturn);
    }
  }
  return numbers;
}

Line evaluate_line(const Field& field, double row, const std::vector<double>& columns,
                   const std::vector<std::uint32_t>& numbers, const ReconstructSettings& settings) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> ranges(columns.size());
  field.evaluate_row(row, columns, settings.masks, ranges);
  std::vector<double> seen_columns, seen_ranges;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    if (std::isnan(ranges[j])) continue;
    seen_columns.push_back(columns[j]);
    seen_ranges.push_back(ranges[j]);
  }
  std::vector<Vec3> seen(seen_ranges.size());
  field.place_row(row, seen_columns, seen_ranges, seen);
  Line line;
  std::size_t next = 0;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    if (!std::isnan(ranges[j])) {
      line.points.push_back(seen[next++]);
      line.nearest.push_back(numbers[field.nearest_cell(row, columns[j])]);
    } else if (settings.organised) {
      line.points.push_back({kNan, kNan, kNan});
      line.nearest.push_back(kNoReturn);
    }
  }
  return line;
}

/// Values of the nearest coded returns; zeros where there is none.
Attribute gather(const Attribute& from, const std::vector<std::uint32_t>& returns) {
  const std::size_t k = from.components;
  Attribute to{from.name, from.components, make_column(type_of(from.values), returns.size() * k)};
  std::visit(
      [&](auto& values) {
        const auto& source = std::get<std::decay_t<decltype(values)>>(from.values);
        for (std::size_t i = 0; i < returns.size(); ++i) {
          if (returns[i] == kNoReturn) continue;
          std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(returns[i] * k), k,
                      values.begin() + static_cast<std::ptrdiff_t>(i * k));
        }
      },
      to.values);
  return to;
}

/// The coded returns themselves, as the file gives them to the bit.
Cloud coded_cloud(const DecodedScan& scan, bool organised) {
  const Lattice& lattice = scan.field->lattice();
  Cloud cloud;
  cloud.metadata = scan.metadata;
  if (!organised) {
    cloud.positions = scan.points;
    cloud.attributes = scan.attributes;
    cloud.width = static_cast<std::uint32_t>(scan.points.size());
    return cloud;
  }
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::uint32_t> numbers = number_returns(*scan.field);
  cloud.positions.reserve(numbers.size());
  for (const std::uint32_t number : numbers) {
    cloud.positions.push_back(number < scan.points.size() ? scan.points[number]
                                                          : Vec3{kNan, kNan, kNan});
  }
  for (const Attribute& attribute : scan.attributes) {
    cloud.attributes.push_back(gather(attribute, numbers));
  }
  cloud.width = lattice.columns();
  cloud.height = lattice.rows();
  return cloud;
}

}  // namespace

Result<Cloud> reconstruct(const DecodedScan& scan, const ReconstructSettings& settings) {
  const auto is_factor = [](double f) { return f > 0 && f <= 4096; };
  if (!is_factor(settings.rows) || !is_factor(settings.columns)) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("the factors {} x {} are not above 0 and at most 4096", settings.rows,
                             settings.columns)};
  }
  const bool plain = settings.rows == 1 && settings.columns == 1 && settings.masks;
  if (scan.records && scan.records->lattice == RecordLattice::none &&
      !(plain && !settings.organised)) {
    return Error{ErrorCode::invalid_argument,
                 "the file holds its points one after the other, without a field: it gives them as "
                 "they are, without other rows, columns or a grid"};
  }
  const Field& field = *scan.field;
  const DenseGrid grid(field.lattice(), settings.rows, settings.columns);
  if (grid.columns > settings.max_points || grid.rows > settings.max_points / grid.columns) {
    return Error{ErrorCode::limit_exceeded,
                 fmt::format("a grid of {} x {} has more than the {} points allowed", grid.rows,
                             grid.columns, settings.max_points)};
  }
  if (plain) {
    if (scan.cloud && !settings.organised) return *scan.cloud;
    if (!scan.points.empty()) return coded_cloud(scan, settings.organised);
  }
  std::vector<double> columns(grid.columns);
  for (std::size_t j = 0; j < columns.size(); ++j) columns[j] = grid.column(j);
  const std::vector<std::uint32_t> numbers = number_returns(field);
  std::vector<Line> lines(grid.rows);
  parallel_for(lines.size(), settings.threads, [&](std::size_t i) {
    lines[i] = evaluate_line(field, grid.row(i), columns, numbers, settings);
  });

  Cloud cloud;
  cloud.metadata = scan.metadata;
  std::vector<std::uint32_t> nearest;
  std::size_t total = 0;
  for (const Line& line : lines) total += line.points.size();
  cloud.positions.reserve(total);
  nearest.reserve(total);
  for (Line& line : lines) {
    cloud.positions.insert(cloud.positions.end(), line.points.begin(), line.points.end());
    nearest.insert(nearest.end(), line.nearest.begin(), line.nearest.end());
    line = {};
  }
  for (const Attribute& attribute : scan.attributes) {
    cloud.attributes.push_back(gather(attribute, nearest));
  }
  cloud.width = static_cast<std::uint32_t>(settings.organised ? grid.columns : total);
  cloud.height = static_cast<std::uint32_t>(settings.organised ? grid.rows : 1);
  return cloud;
}

}  // namespace curlidar
