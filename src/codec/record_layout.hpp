// SPDX-License-Identifier: BSD-3-Clause
// Where every return of a cloud is coded: in a cell of an image, or as a loose point.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "codec/compact_grid.hpp"
#include "codec/compact_model.hpp"
#include "curlidar/codec.hpp"
#include "sensor/lattice.hpp"

namespace curlidar {

struct RecordLayout {
  GriddedScan scan;                   ///< no rows: every return is loose
  std::optional<LatticeFit> lattice;  ///< the cells are the sensor's own rays
  std::vector<std::uint32_t> loose;   ///< slots of the returns without a cell, ascending
  std::vector<std::string> notes;     ///< what a user should know, one sentence each
};

/// The sensor's own rays if the cloud fits them; else its rings on even columns, as many as cost
/// least; else nothing but loose points. Never fails for lack of structure. Errors:
/// invalid_argument (a given sensor that makes no sense).
Result<RecordLayout> lay_out(const Cloud& cloud, const EncodeSettings& settings);

/// All returns as loose points.
RecordLayout lay_out_loose(const Cloud& cloud);

/// What is coded of the layout's image. Numbers of tables are rounded so that what they add to an
/// error of `error_m` (metres; 0: as exactly as can be) is lost in it.
CompactModel model_of(const Cloud& cloud, const RecordLayout& layout, double error_m);

/// Fills the model's offsets if returns lie so far beside their cells that an error of `error_m`
/// shows it; `step_m` is what they will be rounded to.
void add_offsets(const Cloud& cloud, const GriddedScan& scan, double error_m, double step_m,
                 CompactModel& model);

}  // namespace curlidar
