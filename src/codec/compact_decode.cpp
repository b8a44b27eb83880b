// SPDX-License-Identifier: BSD-3-Clause
#include "codec/compact_decode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/try.hpp"
#include "codec/cell_points.hpp"
#include "codec/compact_field.hpp"
#include "codec/compact_model.hpp"
#include "codec/predicted.hpp"
#include "codec/record_file.hpp"
#include "compact/ray_tables.hpp"
#include "format/attributes_chunk.hpp"
#include "format/metadata_chunk.hpp"

namespace curlidar {
namespace {

bool is_compact_type(ChunkType type) {
  return type >= ChunkType::compact_parameters && type <= ChunkType::compact_prediction;
}

compact::ScanChunks scan_chunks(const PartialContainer& container) {
  compact::ScanChunks out;
  out.complete = container.complete;
  const auto add = [&](ChunkType type, ByteSpan payload, std::size_t offset, bool whole) {
    if (is_compact_type(type)) {
      out.chunks.push_back({static_cast<compact::ScanPart>(type), payload, offset, whole});
    }
  };
  for (const Chunk& chunk : container.chunks) add(chunk.type, chunk.payload, chunk.offset, true);
  if (container.torn) {
    add(container.torn->type, container.torn->payload, container.torn->offset, false);
  }
  return out;
}

/// Which cells a region holds.
class RegionFilter {
 public:
  /// `by_points`: cells are held by the azimuths of their points, as needs be for rays, which start
  /// beside the spin axis and may have been moved, and for returns with directions of their own;
  /// else by those of even columns.
  RegionFilter(const ScanRegion& region, const compact::ScanHeader& header, bool by_points)
      : begin_(region.azimuth_begin),
        width_(region.azimuth_end - region.azimuth_begin),
        by_points_(by_points),
        rows_{std::min(region.ring_begin, header.parameters.rows),
              std::min(region.ring_end, header.parameters.rows)},
        columns_(header.parameters.columns, by_points_) {
    if (by_points_) return;
    const auto columns = static_cast<double>(columns_.size());
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      columns_[column] =
          holds(-std::numbers::pi + 2 * std::numbers::pi * static_cast<double>(column) / columns);
    }
  }

  bool holds(std::uint32_t row, std::uint32_t column, const Vec3& point) const {
    return row >= rows_[0] && row < rows_[1] &&
           (by_points_ ? holds(azimuth_of(point)) : columns_[column]);
  }
  bool empty() const {
    return rows_[0] >= rows_[1] ||
           std::find(columns_.begin(), columns_.end(), true) == columns_.end();
  }
  /// The smallest range of cells with all of the region; the whole turn if it crosses the seam or
  /// goes by points.
  compact::Region bounds() const {
    const auto first = std::find(columns_.begin(), columns_.end(), true);
    const auto last = std::find(columns_.rbegin(), columns_.rend(), true);
    return {rows_[0], rows_[1], static_cast<std::uint32_t>(first - columns_.begin()),
            static_cast<std::uint32_t>(columns_.rend() - last)};
  }

 private:
  bool holds(double azimuth) const {
    const double turn = 2 * std::numbers::pi;
    double from_begin = std::fmod(azimuth - begin_, turn);
    if (from_begin < 0) from_begin += turn;
    return width_ >= turn || from_begin < width_;
  }

  double begin_, width_;
  bool by_points_;
  std::array<std::uint32_t, 2> rows_;
  std::vector<bool> columns_;  ///< that may hold something
};

Status check_region(const ScanRegion& region) {
  if (region.ring_begin >= region.ring_end || !(region.azimuth_end > region.azimuth_begin) ||
      !std::isfinite(region.azimuth_begin) || !std::isfinite(region.azimuth_end)) {
    return Error{
        ErrorCode::invalid_argument,
        "the region is empty: rings and azimuths go from the smaller to the larger number"};
  }
  return {};
}

/// Numbers of the returns that are kept, among those of the whole scan; empties the other cells.
/// `points`: of all coded cells.
std::vector<std::uint32_t> crop(compact::DecodedScan& scan, std::span<const Vec3> points,
                                const RegionFilter& filter) {
  std::vector<std::uint32_t> kept;
  std::uint32_t number = 0;
  std::size_t cell = 0;
  for (std::uint32_t row = 0; row < scan.parameters.rows; ++row) {
    for (std::uint32_t column = 0; column < scan.parameters.columns; ++column, ++cell) {
      const bool coded = scan.range[cell] > 0;
      if (filter.holds(row, column, coded ? points[number] : Vec3{})) {
        if (coded) kept.push_back(number);
      } else {
        scan.occupied[cell] = 0;
        scan.range[cell] = scan.field_range[cell] = 0;
        scan.surface[cell] = compact::kNoSurface;
        scan.leaf[cell] = -1;
      }
      number += coded ? 1 : 0;
    }
  }
  return kept;
}

double metres(std::int32_t units) {
  return static_cast<double>(units) / compact::kRangeUnit;
}

Ring ring_of(const compact::RowTable& table, std::size_t row) {
  Ring ring;
  ring.elevation = radians_from_angle(table.elevation[row]);
  if (!table.height.empty()) ring.vertical_offset_m = metres(table.height[row]);
  if (!table.rays) return ring;
  const compact::Ray& ray = table.rays->rays[row];
  ring.azimuth_offset = radians_from_angle(ray.azimuth_offset);
  ring.vertical_offset_m = metres(ray.height);
  ring.horizontal_offset_m = metres(ray.lateral);
  ring.range_phase_m = metres(ray.range_phase);
  return ring;
}

SensorProfile sensor_of(const compact::RowTable& table, const compact::DecodedScan& scan) {
  SensorProfile sensor;
  sensor.name = "unknown";
  sensor.columns = table.turn_columns;
  for (std::size_t row = 0; row < table.elevation.size(); ++row) {
    sensor.rings.push_back(ring_of(table, row));
  }
  if (table.rays) {
    const compact::BeamTable* frozen = compact::beam_table(table.rays->table);
    sensor.slots = table.rays->slots;
    sensor.range_unit_m =
        0x1p-48 * static_cast<double>(frozen != nullptr ? frozen->range_unit_q48
                                                        : table.rays->range_unit_q48);
  }
  sensor.fov_up = sensor.rings.front().elevation;
  sensor.fov_down = sensor.rings.back().elevation;
  std::int32_t farthest = 0;
  for (const std::int32_t range : scan.range) farthest = std::max(farthest, range);
  sensor.max_range_m = std::max(sensor.max_range_m, metres(farthest));
  return sensor;
}

void count_node(const compact::Node& node, CompactStatistics& statistics) {
  for (const compact::Node& child : node.children) count_node(child, statistics);
  if (node.split != compact::Split::none) return;
  for (std::uint32_t i = 0; i < node.leaf.layers; ++i) {
    statistics.inherited_layers += node.leaf.layer[i].parent != 0 ? 1 : 0;
  }
}

CompactStatistics statistics_of(const compact::DecodedScan& scan) {
  CompactStatistics out;
  out.leaves = scan.leaves.size();
  out.leaves_by_layers.resize(compact::kMaxLayers);
  out.layers_by_functions.resize(compact::kFunctions.size());
  for (const compact::DecodedLeaf& leaf : scan.leaves) {
    out.leaves_with_residual += leaf.has_residual ? 1 : 0;
    const auto size = static_cast<std::size_t>(std::bit_width(leaf.block.cells()) - 1);
    out.leaves_by_size.resize(std::max(out.leaves_by_size.size(), size + 1));
    ++out.leaves_by_size[size];
    ++out.leaves_by_layers[leaf.layers - 1];
    for (std::uint32_t i = 0; i < leaf.layers; ++i) {
      ++out.layers_by_functions[scan.surfaces[leaf.first_surface + i].functions];
    }
  }
  for (const compact::DecodedSegment& segment : scan.segments) {
    for (const compact::Node& node : segment.nodes) count_node(node, out);
  }
  return out;
}

void add_partition(const compact::DecodedScan& scan, CompactContents& contents) {
  for (const compact::DecodedSegment& segment : scan.segments) {
    for (std::uint32_t i = 0; i < segment.leaves; ++i) {
      const compact::DecodedLeaf& leaf = scan.leaves[segment.first_leaf + i];
      contents.leaves.push_back({segment.place.row + leaf.block.row,
                                 segment.place.column + leaf.block.column, leaf.block.height,
                                 leaf.block.width, leaf.layers, leaf.has_residual});
    }
  }
  contents.layer.assign(scan.range.size(), 255);
  for (std::size_t cell = 0; cell < scan.range.size(); ++cell) {
    if (scan.leaf[cell] < 0 || scan.surface[cell] < 0) continue;
    const auto first = scan.leaves[static_cast<std::size_t>(scan.leaf[cell])].first_surface;
    contents.layer[cell] =
        static_cast<std::uint8_t>(static_cast<std::uint32_t>(scan.surface[cell]) - first);
  }
}

CompactContents contents_of(const compact::DecodedScan& scan, bool partition) {
  CompactContents out;
  out.step_m = metres(scan.parameters.step);
  out.residual_step_m = metres(scan.parameters.residual_step);
  out.root_cells = 1u << scan.parameters.root_log2;
  out.smallest_leaf = scan.parameters.smallest_leaf;
  out.bands = scan.parameters.bands;
  out.sectors = scan.parameters.sectors;
  out.heights = !scan.table.height.empty();
  out.range_offsets = !scan.table.range_offset.empty();
  out.statistics = statistics_of(scan);
  if (partition) add_partition(scan, out);
  return out;
}

}  // namespace

bool is_compact(const std::vector<Chunk>& chunks) {
  return find_chunk(chunks, ChunkType::compact_parameters) != nullptr || has_records(chunks);
}

namespace {

const compact::DecodedScan* reference_of(const DecodeOptions& options) {
  return options.reference ? &options.reference->scan() : nullptr;
}

}  // namespace

Result<CompactImage> decode_compact_image(ByteSpan bytes, const DecodeOptions& options) {
  CURLIDAR_TRY_ASSIGN(chunks, read_container(bytes));
  PartialContainer container;
  container.complete = true;
  container.chunks = std::move(chunks);
  CURLIDAR_TRY_ASSIGN(
      scan, decode_scan(scan_chunks(container), {options.limits.max_cells},
                        {options.field_only, {}, false, options.threads, reference_of(options)}));
  return CompactImage{std::move(scan.table),
                      {scan.parameters.rows, scan.parameters.columns, std::move(scan.range)}};
}

namespace {

/// What a decoded image gives to whoever asked.
struct ImageParts {
  compact::DecodedScan scan;
  std::optional<RegionFilter> filter;
};

/// Chunks that number all returns of a scan, so that every mask must be known to find a part.
bool numbers_returns(const std::vector<Chunk>& chunks) {
  return find_chunk(chunks, ChunkType::attributes) != nullptr ||
         find_chunk(chunks, ChunkType::directions) != nullptr || has_records(chunks);
}

Result<ImageParts> decode_image(const PartialContainer& container, const DecodeOptions& options) {
  const compact::ScanChunks chunks = scan_chunks(container);
  const compact::ScanLimits limits{options.limits.max_cells};
  compact::ScanOptions scan_options;
  // Directions and attributes are coded with the whole ranges.
  scan_options.field_only = options.field_only && !has_records(container.chunks);
  scan_options.keep_nodes = options.partition;
  scan_options.threads = options.threads;
  scan_options.reference = reference_of(options);
  ImageParts out;
  if (options.region) {
    CURLIDAR_TRY(check_region(*options.region));
    CURLIDAR_TRY_ASSIGN(header, decode_scan_header(chunks, limits, scan_options.reference));
    out.filter.emplace(*options.region, header,
                       header.table.rays.has_value() || has_records(container.chunks));
    if (out.filter->empty()) {
      return Error{ErrorCode::invalid_argument,
                   fmt::format("the region holds none of the scan's {} rings and {} columns",
                               header.parameters.rows, header.parameters.columns)};
    }
    if (!numbers_returns(container.chunks)) scan_options.region = out.filter->bounds();
  }
  CURLIDAR_TRY_ASSIGN(scan, decode_scan(chunks, limits, scan_options));
  out.scan = std::move(scan);
  return out;
}

compact::Image image_of(const compact::DecodedScan& scan) {
  return {scan.parameters.rows, scan.parameters.columns, scan.range};
}

RecordMotion motion_of(const compact::Motion& motion) {
  const auto vector = [](const compact::Motion::Triple& numbers, int fraction_bits) {
    const auto number = [&](std::size_t i) { return std::ldexp(numbers[i], -fraction_bits); };
    return Vec3{number(0), number(1), number(2)};
  };
  constexpr int kTurnBits = 30, kMoveBits = 16;
  return {vector(motion.turn, kTurnBits),       vector(motion.turn2, kTurnBits),
          vector(motion.move, kMoveBits),       vector(motion.move2, kMoveBits),
          vector(motion.rigid_turn, kTurnBits), vector(motion.rigid_move, kMoveBits)};
}

RecordContents contents_of(const DecodedRecords& records, const compact::RowTable& table,
                           bool has_image) {
  RecordContents out;
  out.loose = records.loose;
  out.slots_of_cloud = records.order.slots();
  out.width = static_cast<std::uint32_t>(records.order.width);
  out.height = static_cast<std::uint32_t>(records.order.height);
  out.coordinates = records.order.type;
  if (!has_image) return out;
  out.lattice = table.rays ? RecordLattice::rays : RecordLattice::rings;
  if (!table.rays) return out;
  const compact::RayTable& rays = *table.rays;
  if (const compact::BeamTable* known = compact::beam_table(rays.table)) out.table = known->name;
  out.firings = static_cast<std::uint32_t>(rays.firings.size());
  out.slots = rays.slots;
  out.range_unit_m = std::ldexp(static_cast<double>(rays.range_unit_q48), -48);
  if (!rays.motion.none()) out.motion = motion_of(rays.motion);
  return out;
}

/// Points and attributes of a file with every return, and its cloud.
Status take_records(const PartialContainer& container, compact::DecodedScan& scan,
                    const DecodeOptions& options, DecodedScan& out) {
  const compact::RowTable& table = scan.table;
  const compact::Image image = image_of(scan);
  if (options.field_only) scan.range = scan.field_range;
  const compact::Image field = image_of(scan);
  CURLIDAR_TRY_ASSIGN(
      records, decode_records(container.chunks, table, image, options.field_only ? &field : nullptr,
                              options.limits));
  out.records = contents_of(records, table, image.rows > 0);
  out.records->directions = find_chunk(container.chunks, ChunkType::directions) != nullptr;
  out.records->corrections = find_chunk(container.chunks, ChunkType::corrections) != nullptr;
  CURLIDAR_TRY_ASSIGN(promise, read_promise(container.chunks));
  if (options.field_only) {
    promise.bit_exact = false;
    promise.bound_m = 0;
  }
  out.records->promise = promise;
  out.coded_returns = records.points.size();
  out.attributes = attributes_of_records(records);
  out.cloud = assemble_cloud(records);
  out.points = std::move(records.points);
  return {};
}

/// Points and attributes of an image alone.
Status take_image(const PartialContainer& container, const compact::DecodedScan& scan,
                  const DecodeOptions& options, DecodedScan& out) {
  const Chunk* chunk = find_chunk(container.chunks, ChunkType::attributes);
  out.coded_returns = static_cast<std::size_t>(
      std::count_if(scan.range.begin(), scan.range.end(), [](auto range) { return range > 0; }));
  if (chunk != nullptr && scan.missing.empty()) {
    CURLIDAR_TRY_ASSIGN(attributes,
                        read_attributes(*chunk, out.coded_returns, options.limits.max_bytes));
    out.attributes = std::move(attributes);
  }
  // Offsets of directions are coded in terms of the exact ranges of all cells.
  const bool exact = !options.field_only && scan.missing.empty();
  const std::vector<Chunk> none;
  CURLIDAR_TRY_ASSIGN(points, decode_cell_points(exact ? container.chunks : none, scan.table,
                                                 image_of(scan), nullptr));
  out.points = std::move(points);
  return {};
}

/// Leaves only what lies in the region. Points without a cell belong to no ring: they are in no
/// region.
void crop_to(const RegionFilter& filter, compact::DecodedScan& scan, DecodedScan& out) {
  const std::vector<std::uint32_t> kept = crop(scan, out.points, filter);
  Cloud records;
  records.positions = std::move(out.points);
  records.attributes = std::move(out.attributes);
  Cloud part = select(records, kept);
  out.points = std::move(part.positions);
  out.attributes = std::move(part.attributes);
  out.coded_returns = kept.size();
  out.cloud.reset();
}

}  // namespace

Result<DecodedScan> decode_compact(const PartialContainer& container,
                                   const DecodeOptions& options) {
  DecodedScan out;
  out.profile = Profile::compact;
  const bool records = has_records(container.chunks);
  const bool has_image = find_chunk(container.chunks, ChunkType::compact_parameters) != nullptr;
  if (!records && container.complete) CURLIDAR_TRY(check_no_records(container.chunks));
  ImageParts parts;
  if (has_image) {
    CURLIDAR_TRY_ASSIGN(decoded, decode_image(container, options));
    parts = std::move(decoded);
  } else if (options.region) {
    return Error{ErrorCode::invalid_argument,
                 "the file holds points without rings: no region of it can be told"};
  }
  compact::DecodedScan& scan = parts.scan;
  for (const compact::Missing& missing : scan.missing) out.missing.push_back(to_string(missing));
  if (records && scan.missing.empty()) {
    CURLIDAR_TRY(take_records(container, scan, options, out));
  } else {
    CURLIDAR_TRY(take_image(container, scan, options, out));
  }
  if (has_image) {
    out.sensor = sensor_of(scan.table, scan);
    out.compact = contents_of(scan, options.partition);
  }
  if (parts.filter) crop_to(*parts.filter, scan, out);
  if (const Chunk* chunk = find_chunk(container.chunks, ChunkType::metadata)) {
    CURLIDAR_TRY_ASSIGN(metadata, read_metadata(*chunk));
    out.metadata = std::move(metadata);
    const auto name = out.metadata.find(kSensorKey);
    if (name != out.metadata.end()) out.sensor.name = name->second;
  } else if (out.records && !out.records->table.empty()) {
    out.sensor.name = out.records->table;
  }
  if (out.cloud) out.cloud->metadata = out.metadata;
  out.field = has_image
                  ? std::shared_ptr<const Field>(std::make_shared<CompactField>(std::move(scan)))
                  : std::make_shared<EmptyField>();
  return out;
}

}  // namespace curlidar
