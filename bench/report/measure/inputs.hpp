// SPDX-License-Identifier: BSD-3-Clause
// What the paper's comparisons start from: a scan, its sensor, its preset and its gridded cloud.
#pragma once

#include <memory>
#include <string>

#include "curlidar/codec.hpp"
#include "curlidar/dense.hpp"
#include "report/measure/arguments.hpp"
#include "report/measure/judge.hpp"

namespace curlidar::bench {

struct Scan {
  std::string path;
  std::string preset;  ///< of the paper's settings
  Cloud cloud;
  EncodeSettings settings;  ///< of Profile::paper: sensor if given, no attributes, one thread
};

/// Reads the scan named by the first word; --preset (else the suggested one) and --sensor (else
/// found in the scan) say how to take it.
Result<Scan> read_scan(const Arguments& arguments);

/// The density profile that an option names; none if the option is not given.
Result<std::shared_ptr<const DensityProfile>> density_profile_of(const Arguments& arguments,
                                                                 const std::string& option);

/// The settings as the profile starts from them.
EncodeSettings of_profile(EncodeSettings settings, Profile profile);

/// The paper's settings for a sensor with `times` fewer rings than those that they were made for.
/// No more columns than the sensor has, or directions between them would see empty cells for
/// cliffs. Rows spread evenly over the field of view are not where the rings of every sensor are,
/// and fewer of them miss by more: rows are the rings. What is farther from the next row than a
/// cliff allows must be allowed to be so by as much more.
EncodeSettings for_fewer_rings(EncodeSettings settings, const SensorProfile& sensor, double times);

/// The scan as the paper grids it: the cloud that its errors are measured against. Organised, NaN
/// in empty cells.
Result<Cloud> gridded(const Cloud& scan, EncodeSettings settings);

/// The settings with the largest kept range in metres for the upper limit, as files hold
/// them.
PaperSettings range_limits(PaperSettings settings, const Cloud& grid);

/// The limits that the paper's settings come to on the cloud.
Result<RangeLimits> limits_of(const Cloud& cloud, const EncodeSettings& settings);

/// The raw returns within the range limits of such settings.
Cloud in_range(const Cloud& scan, const PaperSettings& settings);

}  // namespace curlidar::bench
