// SPDX-License-Identifier: BSD-3-Clause
#include "map/tile_header.hpp"

#include <cmath>

#include <fmt/format.h>

#include "map/tile_samples.hpp"

namespace curlidar::tile {
namespace {

constexpr std::uint32_t kSmallestRoot_log2 = 11;  ///< half a metre
constexpr std::uint32_t kRootSizes = 6;           ///< up to 16 m
constexpr std::uint32_t kMostCells_log2 = 6;
constexpr std::uint32_t kMostSide = 64;
constexpr std::int32_t kMostStep = 2 * kTicks;

std::uint32_t log2_of_ratio(double a, double b) {
  return static_cast<std::uint32_t>(std::ilogb(a / b));
}

Error damaged(const char* what, std::int64_t value) {
  return {ErrorCode::corrupt, fmt::format("the header of a tile gives {} as {}", value, what)};
}

}  // namespace

TileLayout layout_of(const SurfaceSettings& settings, double side_m) {
  TileLayout layout;
  layout.root_log2 = static_cast<std::uint32_t>(std::ilogb(settings.root_m * kTicks));
  layout.levels = log2_of_ratio(settings.root_m, settings.smallest_leaf_m);
  layout.cells_log2 = log2_of_ratio(settings.root_m, settings.footprint_m);
  layout.side_roots = static_cast<std::uint32_t>(side_m / settings.root_m);
  layout.step = static_cast<std::int32_t>(std::floor(settings.step_m * kTicks + 0.5));
  layout.fall = kStepFall;
  layout.curves = settings.curves;
  layout.intensity = settings.intensity;
  layout.intensity_step = static_cast<float>(settings.intensity_step);
  return layout;
}

void write_header(ByteWriter& out, const TileLayout& layout) {
  out.write(static_cast<std::uint8_t>((layout.root_log2 - kSmallestRoot_log2) | layout.levels << 3 |
                                      (layout.curves ? 64u : 0u) | (layout.intensity ? 128u : 0u)));
  out.write(static_cast<std::uint8_t>(layout.cells_log2 | (layout.fall - 1) << 3));
  out.write_varint(layout.side_roots);
  out.write_varint(static_cast<std::uint64_t>(layout.step));
  const std::int32_t row = layout.first_row;
  out.write_varint(row < 0 ? 2 * static_cast<std::uint64_t>(-row) - 1
                           : 2 * static_cast<std::uint64_t>(row));
  out.write_varint(layout.rows);
  if (layout.intensity) out.write(layout.intensity_step);
}

Result<TileLayout> read_header(ByteReader& in) {
  TileLayout layout;
  const auto sizes = in.read<std::uint8_t>(), cells = in.read<std::uint8_t>();
  const std::uint64_t side = in.read_varint(), step = in.read_varint();
  const std::uint64_t row = in.read_varint(), rows = in.read_varint();
  layout.curves = (sizes & 64) != 0;
  layout.intensity = (sizes & 128) != 0;
  if (layout.intensity) layout.intensity_step = in.read<float>();
  if (!in.ok()) return Error{ErrorCode::corrupt, "a tile ends within its header"};
  if ((sizes & 7u) >= kRootSizes) return damaged("the size of its roots", sizes & 7);
  layout.root_log2 = kSmallestRoot_log2 + (sizes & 7u);
  layout.levels = sizes >> 3 & 7u;
  if (layout.levels > kMaxLevels) return damaged("its levels", layout.levels);
  layout.cells_log2 = cells & 7u;
  if (layout.cells_log2 > kMostCells_log2)
    return damaged("the size of its cells", layout.cells_log2);
  layout.fall = (cells >> 3) + 1u;
  if (side < 1 || side > kMostSide) return damaged("its side", static_cast<std::int64_t>(side));
  layout.side_roots = static_cast<std::uint32_t>(side);
  if (step < 1 || step > kMostStep) return damaged("its step", static_cast<std::int64_t>(step));
  layout.step = static_cast<std::int32_t>(step);
  if (row >= 2 * std::uint64_t{kMaxRow})
    return damaged("its lowest row", static_cast<std::int64_t>(row));
  const auto half = static_cast<std::int32_t>((row + 1) / 2);
  layout.first_row = row % 2 != 0 ? -half : half;
  if (rows > kMaxRoots / (side * side)) return damaged("its rows", static_cast<std::int64_t>(rows));
  layout.rows = static_cast<std::uint32_t>(rows);
  if (layout.intensity && !(layout.intensity_step > 0 && std::isfinite(layout.intensity_step))) {
    return Error{ErrorCode::corrupt, "the header of a tile has no step of intensity"};
  }
  return layout;
}

}  // namespace curlidar::tile
