// SPDX-License-Identifier: BSD-3-Clause
// Patches seen by their borders: how far ranges jump between neighbouring cells of one surface, and
// where they jump although nothing does. Against exact truth of simulated scans, against the
// original returns of real ones.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.hpp"
#include "cloud/neighbours.hpp"
#include "curlidar/dense.hpp"
#include "report/measure/codecs.hpp"
#include "report/measure/inputs.hpp"
#include "report/measure/json.hpp"
#include "report/measure/jumps.hpp"
#include "report/measure/truth.hpp"
#include "report/measure/verbs.hpp"

namespace curlidar::bench {
namespace {

constexpr std::size_t kPairs = 10'000;          // of each kind
constexpr double kApart = 0.1, kApart_m = 0.3;  // returns farther apart are of two surfaces
constexpr double kOneSurface = 0.25;      // true jumps on one surface are at most this many steps
constexpr double kSmall = 1, kLarge = 2;  // steps: jumps that are none, and that must be true ones

/// A coded scan with the blocks of its cells.
struct Coded {
  std::string name, setting;
  std::shared_ptr<const Field> field;
  std::vector<std::uint32_t> block;
  double bits_per_point = 0, step_m = 0;
};

/// What is known of a pair: of the true jump, and whether the original returns are apart.
struct Known {
  bool one_surface = false, no_jump = false;
};
using Knowledge = std::function<Known(const Cells& cells, const CellPair& pair)>;

template <class Block>
std::vector<std::uint32_t> blocks_of(const Lattice& lattice, const std::vector<Block>& blocks) {
  std::vector<std::uint32_t> of_cell(lattice.cells(), 0);
  std::uint32_t number = 0;
  for (const Block& block : blocks) {
    ++number;
    for (std::uint32_t i = 0; i < block.rows && block.row + i < lattice.rows(); ++i) {
      for (std::uint32_t j = 0; j < block.columns; ++j) {
        const std::size_t column = (block.column + j) % lattice.columns();
        of_cell[std::size_t{block.row + i} * lattice.columns() + column] = number;
      }
    }
  }
  return of_cell;
}

Result<Coded> coded(std::string name, std::string setting, const Cloud& cloud,
                    const EncodeSettings& settings) {
  CURLIDAR_TRY_ASSIGN(encoded, encode(cloud, settings));
  DecodeOptions options;
  options.partition = true;
  CURLIDAR_TRY_ASSIGN(scan, decode(encoded.bytes, options));
  if (!scan.field || (!scan.compact && !scan.paper)) {
    return Error{ErrorCode::invalid_argument, "the file has no field of patches"};
  }
  const Lattice& lattice = scan.field->lattice();
  return Coded{std::move(name),
               std::move(setting),
               scan.field,
               scan.compact ? blocks_of(lattice, scan.compact->leaves)
                            : blocks_of(lattice, scan.paper_patches),
               encoded.report.bits_per_point,
               encoded.report.compact ? encoded.report.compact->step_m : 0};
}

WayRanges true_ranges_along(const Scene& scene, const Way& way) {
  WayRanges ranges_m;
  std::transform(way.begin(), way.end(), ranges_m.begin(), [&](const Sightline& line) {
    Hit hit;
    return scene.cast(line.origin, line.direction, hit) ? hit.range_m
                                                        : std::numeric_limits<double>::quiet_NaN();
  });
  return ranges_m;
}

/// The returns that were coded.
class Originals {
 public:
  explicit Originals(const Cloud& cloud) : cloud_(cloud), tree_(cloud, cloud) {}

  /// Whether all between which the way of a pair passes are of one surface.
  bool near(const Cells& cells, const CellPair& pair) const {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const std::size_t cell : cells.around(pair)) {
      Neighbour nearest;
      tree_.nearest(cells.coded(cell), std::span(&nearest, 1));
      const double range_m = norm(cloud_.positions[nearest.slot]);
      least = std::min(least, range_m);
      most = std::max(most, range_m);
    }
    return most - least <= kApart * least + kApart_m;
  }

 private:
  const Cloud& cloud_;
  ReturnTree tree_;
};

struct Jumps {
  std::size_t pairs = 0, nothing = 0, no_jump = 0, large = 0;
  std::vector<double> one_surface_m;
};

Json to_json(Jumps jumps, double step_m) {
  const DistanceStats stats = summarise(std::move(jumps.one_surface_m));
  const auto of = static_cast<double>(std::max<std::size_t>(jumps.no_jump, 1));
  return {{"pairs", jumps.pairs},
          {"nothing", jumps.nothing},
          {"one_surface", stats.count},
          {"mean_m", stats.mean},
          {"p95_m", stats.p95},
          {"max_m", stats.max},
          {"mean_of_step", stats.mean / step_m},
          {"no_jump", jumps.no_jump},
          {"untrue", jumps.large},
          {"untrue_share", static_cast<double>(jumps.large) / of}};
}

/// Prints the jumps of a field on borders and within blocks, in steps of `step_m`.
void print_jumps(const Coded& coded, double step_m, const Knowledge& knowledge) {
  Jumps borders, insides;
  const Cells cells(coded.field);
  for (const CellPair& pair : cells.pairs(coded.block, kPairs)) {
    const double jump_m = jump_of(ranges_along(*coded.field, cells.way(pair)));
    Jumps& jumps = pair.border ? borders : insides;
    ++jumps.pairs;
    if (std::isnan(jump_m)) {
      ++jumps.nothing;
      continue;
    }
    const Known known = knowledge(cells, pair);
    if (known.one_surface) jumps.one_surface_m.push_back(jump_m);
    jumps.no_jump += known.no_jump ? 1 : 0;
    jumps.large += known.no_jump && jump_m > kLarge * step_m ? 1 : 0;
  }
  print_line({{"method", coded.name},
              {"setting", coded.setting},
              {"bits_per_point", coded.bits_per_point},
              {"step_m", step_m},
              {"borders", to_json(std::move(borders), step_m)},
              {"insides", to_json(std::move(insides), step_m)}});
}

/// The compact codec at 1 bit a point, between its samples and by its field alone, and the paper's
/// scheme, in steps of the compact one.
Status print_all(const Cloud& cloud, const std::optional<SensorProfile>& compact_sensor,
                 const EncodeSettings& paper,
                 const std::function<Knowledge(double step_m)>& knowledge) {
  EncodeSettings settings = compact_of_scan(CompactTarget::bits_per_point, 1);
  settings.sensor = compact_sensor;
  const Result<Coded> field = coded("compact-field", "1 bit a point", cloud, settings);
  if (!field) {
    print_line({{"skipped", field.error().message}});
    return {};
  }
  const double step_m = field->step_m;
  Coded dense = *field;
  dense.name = "compact";
  dense.field = dense_field(field->field);
  print_jumps(dense, step_m, knowledge(step_m));
  print_jumps(*field, step_m, knowledge(step_m));
  CURLIDAR_TRY_ASSIGN(patches, coded("paper", paper_setting(Profile::paper), cloud,
                                     of_profile(paper, paper.profile)));
  print_jumps(patches, step_m, knowledge(step_m));
  return {};
}

}  // namespace

Status borders_truth(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(seed, arguments.number("seed", 1, 0, 1u << 30));
  CURLIDAR_TRY_ASSIGN(
      simulated, simulate_scan(arguments.words[0], arguments.words[1], arguments.words[2], seed));
  const Originals originals(simulated.cloud);
  const auto knowledge = [&](double step_m) -> Knowledge {
    return [&, step_m](const Cells& cells, const CellPair& pair) {
      const double jump_m = jump_of(true_ranges_along(*simulated.scene, cells.way(pair)));
      const bool no_jump = jump_m <= kSmall * step_m && originals.near(cells, pair);
      return Known{jump_m <= kOneSurface * step_m, no_jump};
    };
  };
  return print_all(simulated.cloud, {}, simulated.settings, knowledge);
}

Status borders(const Arguments& arguments) {
  CURLIDAR_TRY_ASSIGN(scan, read_scan(arguments));
  const Originals originals(scan.cloud);
  const auto knowledge = [&](double) -> Knowledge {
    return [&](const Cells& cells, const CellPair& pair) {
      const bool near = originals.near(cells, pair);
      return Known{near, near};
    };
  };
  return print_all(scan.cloud, scan.settings.sensor, scan.settings, knowledge);
}

}  // namespace curlidar::bench
