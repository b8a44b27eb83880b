// SPDX-License-Identifier: BSD-3-Clause
// Range images of what methods tell between the rings, beside the exact scene or the whole scan:
// what pictures are drawn from.
#include <bit>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "protocol/ring_split.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/truth.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

/// Directions of a lattice made denser, row by row.
struct Directions {
  std::size_t rows = 0, columns = 0;
  std::vector<Vec3> all;
};

Directions directions_of(const std::vector<double>& elevations, std::uint32_t columns,
                         double factor) {
  const Lattice lattice = Lattice::from_rings(elevations, columns);
  const DenseGrid grid(lattice, factor, 1);
  Directions directions{grid.rows, grid.columns, {}};
  for (std::size_t i = 0; i < grid.rows; ++i) {
    for (std::size_t j = 0; j < grid.columns; ++j) {
      directions.all.push_back(lattice.direction(grid.row(i), grid.column(j)));
    }
  }
  return directions;
}

/// Planes of float32 of one size as a NumPy file.
class Planes {
 public:
  explicit Planes(const Directions& directions) : directions_(&directions) {
    std::vector<float>& elevations = add("elevation");
    for (std::size_t i = 0; i < directions.all.size(); ++i) {
      elevations[i] = static_cast<float>(elevation_of(directions.all[i]));
    }
  }

  std::vector<float>& add(const std::string& name) {
    names_.push_back(name);
    return planes_.emplace_back(directions_->all.size());
  }

  void add_ranges(const std::string& name, const Sampler& sampler, bool confidence) {
    const std::vector<RangeEstimate> told = sampler.tell(directions_->all);
    std::vector<float>& ranges = add(name);
    for (std::size_t i = 0; i < told.size(); ++i) {
      ranges[i] = told[i].valid() ? static_cast<float>(told[i].range_m) : std::nanf("");
    }
    if (!confidence) return;
    std::vector<float>& confidences = add("confidence");
    for (std::size_t i = 0; i < told.size(); ++i) confidences[i] = told[i].confidence;
  }

  /// Writes the file and prints the names of the planes.
  Status write(const std::string& path) const {
    std::string header =
        fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}, {}), }}",
                    planes_.size(), directions_->rows, directions_->columns);
    constexpr std::size_t kStart = 10;  // of the header in the file
    header.append(63 - (kStart + header.size()) % 64, ' ');
    header += '\n';
    std::ofstream file(path, std::ios::binary);
    file << "\x93NUMPY\x01" << '\0' << static_cast<char>(header.size() & 0xff)
         << static_cast<char>(header.size() >> 8) << header;
    static_assert(std::endian::native == std::endian::little);
    for (const std::vector<float>& plane : planes_) {
      file.write(reinterpret_cast<const char*>(plane.data()),
                 static_cast<std::streamsize>(plane.size() * sizeof(float)));
    }
    if (!file.flush()) return Error{ErrorCode::io, path + ": could not be written"};
    print_line(
        {{"planes", names_}, {"rows", directions_->rows}, {"columns", directions_->columns}});
    return {};
  }

 private:
  const Directions* directions_;
  std::vector<std::string> names_;
  std::vector<std::vector<float>> planes_;
};

Result<std::uint32_t> factor_of(const Arguments& arguments) {
  return arguments.number("factor", 8, 1, 16);
}

/// What the compact codec and edge-aware interpolation tell.
Status add_methods(Planes& planes, const MethodInput& input) {
  const std::vector<Method> compact = compact_methods(input);
  if (!compact[0].sampler) return Error{ErrorCode::invalid_argument, compact[0].skipped};
  planes.add_ranges("compact", *compact[0].sampler, true);
  planes.add_ranges("compact-field", *compact[1].sampler, false);
  planes.add_ranges("edge-aware", *edge_aware_method(input).sampler, false);
  return {};
}

}  // namespace

Status range_images_truth(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(factor, factor_of(arguments));
  CURLIDAR_TRY_ASSIGN(seed, arguments.number("seed", 1, 0, 1u << 30));
  CURLIDAR_TRY_ASSIGN(
      simulated, simulate_scan(arguments.words[0], arguments.words[1], arguments.words[2], seed));
  const Directions directions =
      directions_of(simulated.rings.ring_elevations, simulated.rings.sensor.columns, factor);
  Planes planes(directions);
  const std::vector<double> truth = true_ranges(*simulated.scene, directions.all);
  std::vector<float>& ranges = planes.add("truth");
  for (std::size_t i = 0; i < truth.size(); ++i) ranges[i] = static_cast<float>(truth[i]);
  CURLIDAR_TRY(add_methods(planes, input_of(simulated)));
  return planes.write(arguments.words[3]);
}

Status range_images(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(factor, factor_of(arguments));
  CURLIDAR_TRY_ASSIGN(every, arguments.number("every", 4, 2, 64));
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  CURLIDAR_TRY_ASSIGN(detection, scan.settings.sensor
                                     ? assign_rings(scan.cloud, *scan.settings.sensor)
                                     : detect_sensor(scan.cloud));
  const RingSplit split = split_rings(scan.cloud, detection, every);
  const Directions directions = directions_of(split.elevations, split.sensor.columns, factor);
  Planes planes(directions);
  const MethodInput whole{.cloud = &scan.cloud,
                          .paper = {},
                          .compact_sensor = {},
                          .ring_of_point = detection.ring_of_point,
                          .ring_elevations = detection.ring_elevations,
                          .columns = detection.sensor.columns};
  planes.add_ranges("truth", *edge_aware_method(whole).sampler, false);
  CURLIDAR_TRY(add_methods(planes, {.cloud = &split.coded,
                                    .paper = {},
                                    .compact_sensor = split.sensor,
                                    .ring_of_point = split.ring_of_point,
                                    .ring_elevations = split.elevations,
                                    .columns = split.sensor.columns}));
  return planes.write(arguments.words[1]);
}

}  // namespace curlidar::bench
