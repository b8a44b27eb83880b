// SPDX-License-Identifier: BSD-3-Clause
// Pictures of clouds, for people to look at.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/result.hpp"

namespace curlidar {

/// 8-bit RGB, row by row from the top.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

enum class View {
  range_image,
  birds_eye,
  perspective,
  partition,  ///< of a compact file, over its range image: see render_partition
  layers,     ///< the same, each return in the colour of its layer
  degrees,  ///< of a file of the paper's profiles: each return in the colour of its patch's degree
};
enum class ColourBy {
  range,
  height,
  intensity,
  error,
  normal,  ///< of attributes normal_x, normal_y, normal_z: |x|, |y|, |z| as red, green, blue
};
/// "range-image", "birds-eye", "perspective", "partition", "layers",
/// "degrees"
Result<View> view_by_name(std::string_view name);
Result<ColourBy> colour_by_name(
    std::string_view name);  ///< "range", "height", "intensity", "error", "normal"

struct RenderSettings {
  View view = View::perspective;
  ColourBy colour = ColourBy::height;
  std::uint32_t width = 1280, height = 0;  ///< height 0: what suits the view
  /// Values mapped to the two ends of the colour map; by default the 2nd and 98th percentile, for
  /// errors 0 and the 98th.
  std::optional<double> value_min, value_max;
  double extent_m = 0;  ///< half width of the bird's-eye view; 0 = fits the 95th percentile
  double yaw_deg = -145, pitch_deg = 28;  ///< perspective camera, orbiting the sensor
  double distance_m = 0;                  ///< of that camera; 0 = fits the cloud
  double point_size_px = 0;               ///< 0 = by density
  /// Returns higher than this are left out: it takes the ceiling off a room.
  std::optional<double> clip_above_m;
  std::string title;  ///< drawn in the corner if not empty
};

/// Draws the returns of a cloud. For ColourBy::error `values` holds one value per slot (metres);
/// otherwise it may be empty. Range images show organised clouds row by row and others by the
/// rings that detect_sensor finds, as seen from the sensor; bird's-eye views have forward up
/// and circles every 10 m. Errors: no return, sides outside 16 .. 8192 pixels, missing values.
/// Deterministic. About 0.2 s for 120 k points and a million pixels.
Result<Image> render(const Cloud& cloud, const RenderSettings& settings,
                     const std::vector<double>& values = {});

/// A block of an organised cloud's cells and the number of surfaces in it.
struct PartitionBlock {
  std::uint32_t row = 0, column = 0, rows = 0, columns = 0;
  std::uint32_t layers = 1;  ///< View::degrees: its degree
};

/// Draws what a codec did to an organised cloud, whose azimuth grows from column to column: the
/// blocks' outlines by their layers and, behind them, ranges (View::partition) or the layer of each
/// return (View::layers), or the degrees of the blocks (View::degrees). `layer` holds one number
/// for each slot; degrees do not need it and take an empty one. The turn is cut into stripes, from
/// the back by the left to the front and on, so that a cell is some pixels wide; the height
/// follows. Errors: another view, a cloud that is not organised, sizes that do not match.
Result<Image> render_partition(const Cloud& grid, const std::vector<PartitionBlock>& blocks,
                               const std::vector<std::uint8_t>& layer,
                               const RenderSettings& settings);

/// Pictures of equal height side by side with a thin gap.
Image side_by_side(const std::vector<Image>& images);

/// Atomic; "-" is standard output.
Status write_png(const std::string& path, const Image& image);

}  // namespace curlidar
