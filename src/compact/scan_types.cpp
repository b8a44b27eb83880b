// SPDX-License-Identifier: BSD-3-Clause
#include "compact/scan_types.hpp"

namespace curlidar::compact {
namespace {

void round_to_shift(std::vector<std::int32_t>& values, std::uint32_t shift) {
  for (std::int32_t& value : values) {
    value = static_cast<std::int32_t>(shift_right_round(value, shift) * (std::int64_t{1} << shift));
  }
}

/// Where part i of `parts` of `count` begins.
std::uint32_t part_begin(std::uint32_t i, std::uint32_t count, std::uint32_t parts) {
  return static_cast<std::uint32_t>(std::uint64_t{i} * count / parts);
}

}  // namespace

void round_to_shifts(RowTable& table) {
  round_to_shift(table.elevation, table.elevation_shift);
  round_to_shift(table.height, table.height_shift);
  round_to_shift(table.range_offset, table.offset_shift);
}

std::vector<SegmentPlace> segments_of(const ScanParameters& p) {
  std::vector<SegmentPlace> places;
  places.reserve(std::size_t{p.bands} * p.sectors);
  for (std::uint32_t band = 0; band < p.bands; ++band) {
    const std::uint32_t row = part_begin(band, p.rows, p.bands);
    const std::uint32_t row_end = part_begin(band + 1, p.rows, p.bands);
    for (std::uint32_t sector = 0; sector < p.sectors; ++sector) {
      const std::uint32_t column = part_begin(sector, p.columns, p.sectors);
      const std::uint32_t column_end = part_begin(sector + 1, p.columns, p.sectors);
      places.push_back({row, column, row_end - row, column_end - column});
    }
  }
  return places;
}

Geometry geometry_of(const RowTable& table, const SegmentPlace& place) {
  const auto first = table.elevation.begin() + place.row;
  if (table.rays) {
    return Geometry({first, first + place.rows}, *table.rays, place.row, place.column,
                    place.columns);
  }
  return Geometry({first, first + place.rows}, table.turn_columns,
                  table.first_column + place.column, place.columns);
}

const char* to_string(ScanPart part) {
  switch (part) {
    case ScanPart::parameters:
      return "compact_parameters";
    case ScanPart::sensor:
      return "compact_sensor";
    case ScanPart::index:
      return "compact_index";
    case ScanPart::mask:
      return "compact_mask";
    case ScanPart::field:
      return "compact_field";
    case ScanPart::residual:
      return "compact_residual";
    case ScanPart::rays:
      return "compact_rays";
    case ScanPart::prediction:
      return "compact_prediction";
  }
  return "unknown";
}

}  // namespace curlidar::compact
