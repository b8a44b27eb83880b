// SPDX-License-Identifier: BSD-3-Clause
// What `report_measure VERB ...` measures; one file a verb. Each prints JSON, a line a measurement.
#pragma once

#include "curlidar/result.hpp"
#include "report/measure/arguments.hpp"

namespace curlidar::bench {

// one_to_one.cpp: the gridded cloud coded by the codecs of the paper's first table.
Status one_to_one(const Arguments& arguments);
// truth.cpp: between the rows of a simulated scan, against exact truth.
Status truth(const Arguments& arguments);
// held_out.cpp: between the coded rings of a scan, against the rings that were left out.
Status held_out(const Arguments& arguments);
// borders.cpp: jumps at the borders of patches, of a scan and of a simulated one.
Status borders(const Arguments& arguments);
Status borders_truth(const Arguments& arguments);
// range_images.cpp: what is told between the rings as range images, of a scan of which every K-th
// ring is coded and of a simulated one.
Status range_images(const Arguments& arguments);
Status range_images_truth(const Arguments& arguments);
// sparse.cpp: every K-th ring by the preset for sparse scans, against the rings left out.
Status sparse(const Arguments& arguments);
// as_sensor.cpp: a simulated scan as another sensor sees it, against what that one's beams meet.
Status as_sensor(const Arguments& arguments);
// nearest.cpp: distances between the whole scan and every K-th ring of it made denser.
Status nearest(const Arguments& arguments);
// timing.cpp: CPU time of the codecs, and of the stages of the paper's.
Status timing(const Arguments& arguments);
// upsampling.cpp: 16 rows to 64 by TULIP's protocol.
Status upsampling(const Arguments& arguments);

}  // namespace curlidar::bench
