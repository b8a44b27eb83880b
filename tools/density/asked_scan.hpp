// SPDX-License-Identifier: BSD-3-Clause
// Coded scans with directions between their rings in which the truth is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "curlidar/codec.hpp"
#include "curlidar/field.hpp"
#include "density/row_scan.hpp"

namespace curlidar::density {

struct AskedScan {
  struct Place {
    Sightline line;      ///< of unit length
    double range_m = 0;  ///< of the surface along it; 0: there is none
  };

  std::string group;  ///< scene or drive
  std::shared_ptr<const Field> field;
  std::vector<Place> places;
};

/// How files are made, and kept so that they need not be made again.
class Coder {
 public:
  /// `folder` keeps files; empty: none.
  explicit Coder(std::string folder) : folder_(std::move(folder)) {}
  /// The file that a scan comes to, decoded; `name` tells the scan, `step_m` how finely it is
  /// coded. Error without a field.
  Result<AskedScan> code(const std::string& name, const Cloud& cloud, const SensorProfile& sensor,
                         double step_m) const;

 private:
  std::string folder_;
};

struct SimulatedScan {
  std::string scene, sensor;
  std::uint64_t seed = 1;
};

/// All rings of a simulated scan, asked for `places` directions spread between them.
Result<AskedScan> ask_simulated(const Coder& coder, const SimulatedScan& what, double step_m,
                                std::size_t places);

/// Rings 0, every, 2 every .. of a scan, asked for about `places` returns and gaps of the others,
/// along the beams of these. `every` is refused if fewer than five rings were left.
Result<AskedScan> ask_held_out(const Coder& coder, const OwnScan& own, std::size_t every,
                               double step_m, std::size_t places);

}  // namespace curlidar::density
