// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruct/coded.hpp"

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "reconstruct/attributes.hpp"
#include "reconstruct/view.hpp"

namespace curlidar {
namespace {

/// The returns of all cells, row by row; NaN in cells without one. Files that do not list their
/// returns have them where their own masks believe.
std::vector<Vec3> points_of_cells(const DecodedScan& scan,
                                  const std::vector<std::uint32_t>& numbers, std::size_t threads) {
  const Field& field = *scan.field;
  const std::size_t width = field.lattice().columns();
  std::vector<Vec3> points(numbers.size(), kNowherePoint);
  if (!scan.points.empty()) {
    for (std::size_t cell = 0; cell < points.size(); ++cell) {
      if (numbers[cell] < scan.points.size()) points[cell] = scan.points[numbers[cell]];
    }
    return points;
  }
  std::vector<double> columns(width);
  for (std::size_t column = 0; column < width; ++column) {
    columns[column] = static_cast<double>(column);
  }
  parallel_for(field.lattice().rows(), threads, [&](std::size_t row) {
    std::vector<double> ranges(width);
    field.evaluate_row(static_cast<double>(row), columns, true, ranges);
    field.place_row(static_cast<double>(row), columns, ranges,
                    std::span(points).subspan(row * width, width));
  });
  return points;
}

/// `more` behind a column of the same type; another type is left alone.
void append(Column& column, const Column& more) {
  std::visit(
      [&](auto& values) {
        const auto* added = std::get_if<std::decay_t<decltype(values)>>(&more);
        if (added != nullptr) values.insert(values.end(), added->begin(), added->end());
      },
      column);
}

/// The slots of a cloud that hold returns.
Cloud without_empty_slots(const Cloud& cloud) {
  std::vector<std::uint32_t> returns;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (is_return(cloud.positions[i])) returns.push_back(i);
  }
  return select(cloud, returns);
}

/// A point for each cell.
Cloud cloud_of_cells(const DecodedScan& scan, std::size_t threads) {
  Cloud cloud;
  cloud.metadata = scan.metadata;
  std::vector<std::uint32_t> numbers = number_returns(*scan.field);
  cloud.positions = points_of_cells(scan, numbers, threads);
  for (std::size_t cell = 0; cell < numbers.size(); ++cell) {
    if (std::isnan(cloud.positions[cell].x)) numbers[cell] = kNoReturn;
  }
  for (const Attribute& attribute : scan.attributes) {
    cloud.attributes.push_back(gather(attribute, numbers));
  }
  cloud.width = scan.field->lattice().columns();
  cloud.height = scan.field->lattice().rows();
  return cloud;
}

}  // namespace

Cloud coded_cloud(const DecodedScan& scan, bool organised, std::size_t threads) {
  if (organised) return cloud_of_cells(scan, threads);
  if (scan.cloud) return *scan.cloud;
  if (scan.points.empty()) return without_empty_slots(cloud_of_cells(scan, threads));
  Cloud cloud;
  cloud.metadata = scan.metadata;
  cloud.positions = scan.points;
  cloud.attributes = scan.attributes;
  cloud.width = static_cast<std::uint32_t>(scan.points.size());
  return cloud;
}

Cloud coded_returns(const DecodedScan& scan, std::size_t threads) {
  return without_empty_slots(coded_cloud(scan, false, threads));
}

Cloud behind(Cloud coded, const Cloud& invented) {
  coded.positions.insert(coded.positions.end(), invented.positions.begin(),
                         invented.positions.end());
  for (Attribute& attribute : coded.attributes) {
    const Attribute* more = invented.find(attribute.name);
    if (more != nullptr) append(attribute.values, more->values);
  }
  std::erase_if(coded.attributes, [&](const Attribute& a) {
    return size_of(a.values) != coded.size() * a.components;
  });
  coded.width = static_cast<std::uint32_t>(coded.size());
  coded.height = 1;
  return coded;
}

}  // namespace curlidar
