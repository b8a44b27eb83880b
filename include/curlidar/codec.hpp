// SPDX-License-Identifier: BSD-3-Clause
// The facade: a scan in, bytes out; bytes in, a continuous scan out. Clouds from it: reconstruct.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "curlidar/cloud.hpp"
#include "curlidar/field.hpp"
#include "curlidar/progress.hpp"
#include "curlidar/project.hpp"
#include "curlidar/result.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/settings.hpp"

namespace curlidar {

struct EncodeSettings {
  Profile profile = Profile::compact;
  CompactSettings compact{};  ///< of Profile::compact
  PaperSettings paper{};      ///< of the paper's profiles
  /// The sensor; detected from the cloud when absent.
  std::optional<SensorProfile> sensor{};
  /// Attributes to keep: nullopt = all, empty = none. Unknown names are an error.
  std::optional<std::vector<std::string>> attributes{};
  std::size_t threads = 1;  ///< never changes the bytes; 0 = all cores
};

/// Bits of a compact file without attributes and metadata, by what they are spent on.
struct CompactBreakdown {
  double header = 0;  ///< container, parameters, rows, index
  double mask = 0, partition = 0, modes = 0, coefficients = 0, labels = 0, residual = 0;
  /// Of files with every return: directions, loose points, corrections, order.
  double records = 0;

  double total() const {
    return header + mask + partition + modes + coefficients + labels + residual + records;
  }
};

/// What a compact file is made of.
struct CompactStatistics {
  std::size_t leaves = 0;
  std::size_t leaves_with_residual = 0;
  std::vector<std::size_t> leaves_by_size;       ///< by floor(log2(cells))
  std::vector<std::size_t> leaves_by_layers;     ///< [0]: of one layer
  std::vector<std::size_t> layers_by_functions;  ///< of 0, 1, 3 and 6 functions of their own
  /// Layers that start from a neighbour's plane; decoders count them if asked for the partition.
  std::size_t inherited_layers = 0;
};

/// What compact encoding reached.
struct CompactReport {
  /// Distances of the decoded returns, as the written file gives them, to their originals.
  double mean_error_m = 0, rms_error_m = 0, max_error_m = 0;
  std::optional<double> error_nn_m;  ///< if it was the target
  double bits_per_point_coded = 0;   ///< all bytes but attributes and metadata
  double step_m = 0, residual_step_m = 0;
  std::uint32_t rows = 0, columns = 0;
  std::uint32_t segments = 1;
  bool cell_centres = false;  ///< the cloud's points were cell centres and kept their cells
  bool heights = false;       ///< rows have heights: beams that do not start at the origin
  bool range_offsets = false;
  std::uint32_t encodings = 0;  ///< tried on the way to the target
  CompactBreakdown breakdown;
  CompactStatistics statistics;
};

/// How exactly a file with every return says that its points come back.
struct RecordPromise {
  bool bit_exact = false;
  double bound_m = 0;  ///< no point lies farther from its original; 0: nothing is promised
  /// The order of the points and the empty slots were given up: the returns are a set.
  bool any_order = false;

  /// Whether anything is said of every single point.
  bool of_points() const { return bit_exact || bound_m > 0; }
  friend bool operator==(const RecordPromise&, const RecordPromise&) = default;
};

/// What a file with every return holds beside its image, in bytes with frames.
struct RecordBytes {
  std::size_t rays = 0, directions = 0, loose = 0, corrections = 0, order = 0, attributes = 0;
};

/// How the directions of a file with every return are coded.
enum class RecordLattice {
  none,   ///< not at all: points one after the other
  rings,  ///< rings on even columns, with offsets where the target needs them
  rays,   ///< the sensor's own rays
};
const char* to_string(RecordLattice lattice);  ///< "none", "rings", "rays"

/// What encoding every return found and reached.
struct RecordReport {
  RecordLattice lattice = RecordLattice::none;
  std::string table;            ///< name of the known rays, empty if they are in the file
  bool motion = false;          ///< motion compensation was undone
  std::size_t loose = 0;        ///< returns without a cell
  std::size_t corrected = 0;    ///< points that corrections changed
  double share_on_lattice = 0;  ///< of the returns, if the lattice is of rays
  /// Median distances from the lattice of rays, along the row, out of it, and of ranges from the
  /// unit, metres.
  double across_m = 0, up_m = 0, range_m = 0;
  std::uint32_t firings = 0, slots = 0;
  double range_unit_m = 0;
  RecordPromise promise;
  RecordBytes bytes;
  std::vector<std::string> notes;  ///< what a user should know, one sentence each
};

struct EncodeReport {
  std::string sensor;            ///< name of the profile used
  std::size_t points_in = 0;     ///< returns of the input
  std::size_t points_coded = 0;  ///< returns that a plain decode gives back
  std::size_t bytes = 0;
  double bits_per_point = 0;  ///< of points_in, everything counted
  ProjectionCounts projection;
  std::size_t points_upsampled = 0;  ///< samples after upsampling and denoising
  std::size_t coefficients = 0;
  std::size_t patches = 0;           ///< non-empty ones
  std::vector<std::size_t> degrees;  ///< patches of each degree
  /// The paper's compression percentage: (8 B a coefficient + 4 bits a cell) / 24 B a point.
  double cp_paper_percent = 0;
  std::optional<CompactReport> compact;  ///< of Profile::compact, whose files leave the above 0
  std::optional<RecordReport> records;   ///< of compact files with every return
  std::vector<StageTime> stages_ms;
};

struct Encoded {
  std::vector<std::byte> bytes;
  EncodeReport report;
};

/// Encodes one scan. Same bytes for any thread count. Errors: invalid_argument (settings, no return
/// to code, a target out of reach; says what to do), unsupported (limited-field scanners).
Result<Encoded> encode(const Cloud& cloud, const EncodeSettings& settings = {},
                       const ProgressCallback& progress = {});

/// Caps on what a file may make the decoder allocate. The worst compact file known takes some 500
/// bytes (800 with its partition) and 3 us a cell, and little of its own: who reads files of
/// strangers sets max_cells to what their sensors have.
struct DecodeLimits {
  std::uint64_t max_cells = 1u << 26;    ///< rows * columns of the coded lattice
  std::uint64_t max_bytes = 1ull << 32;  ///< total of unpacked chunks
};

/// A part of a scan: rings [ring_begin, ring_end), 0 the highest, and azimuths from azimuth_begin
/// counter-clockwise to azimuth_end (radians; a full turn or more apart: all of them).
struct ScanRegion {
  std::uint32_t ring_begin = 0, ring_end = 0xffffffff;
  double azimuth_begin = -4, azimuth_end = 4;
};

/// A decoded scan that others are predicted from.
class PredictionReference;

struct DecodeOptions {
  DecodeLimits limits{};
  /// Compact files: without the residual layer.
  bool field_only = false;
  /// Compact files: only this part; segments outside it are not decoded.
  std::optional<ScanRegion> region{};
  /// Takes files that are cut off as far as they go; DecodedScan::missing says what is not there.
  bool allow_truncated = false;
  /// Keep what `CompactContents::leaves` and `layer`, or `DecodedScan::paper_patches` tell.
  bool partition = false;
  std::size_t threads = 1;  ///< 0 = all cores
  /// Of a scan that is predicted: the one before it. What sequences need (sequence.hpp).
  std::shared_ptr<const PredictionReference> reference{};
};

/// A block of cells with the surfaces that describe it.
struct CompactLeaf {
  std::uint32_t row = 0, column = 0, rows = 0, columns = 0;
  std::uint32_t layers = 1;
  bool residual = false;
};

/// A patch of the paper's profiles that is fitted.
struct PaperPatch {
  std::uint32_t row = 0, column = 0, rows = 0, columns = 0;  ///< cells of the coded lattice
  std::uint32_t degree = 0;
};

/// What is special about a compact file.
struct CompactContents {
  double step_m = 0, residual_step_m = 0;
  std::uint32_t root_cells = 0;     ///< side of the blocks that the partition starts from
  std::uint32_t smallest_leaf = 0;  ///< cells
  std::uint32_t bands = 1, sectors = 1;
  bool heights = false, range_offsets = false;
  CompactStatistics statistics;
  std::vector<CompactLeaf> leaves;  ///< on request
  /// Layer of each cell's return in its leaf, row-major; 255 where there is none. On request.
  std::vector<std::uint8_t> layer;
};

/// Motion compensation that was undone, over one turn of the sensor: how far each point was turned
/// and moved grows with its azimuth, and with the square of it.
struct RecordMotion {
  Vec3 turn{}, turn2{};             ///< rotation vectors, radians a turn and a turn squared
  Vec3 move{}, move2{};             ///< metres, likewise
  Vec3 rigid_turn{}, rigid_move{};  ///< of the whole scan
};

/// What is special about a file with every return.
struct RecordContents {
  RecordLattice lattice = RecordLattice::none;
  std::string table;          ///< name of the known rays; empty: they are in the file, or none
  bool directions = false;    ///< points lie beside their cells' middles
  bool corrections = false;   ///< points are corrected one by one
  std::size_t loose = 0;      ///< returns without a cell
  std::uint32_t firings = 0;  ///< of rays
  std::uint32_t slots = 0;    ///< positions of the encoder that rays may fire at
  double range_unit_m = 0;    ///< ranges along rays are multiples of it; 0: of 2^-16 m
  std::optional<RecordMotion> motion{};
  std::size_t slots_of_cloud = 0;  ///< returns and empty slots
  std::uint32_t width = 0, height = 1;
  ScalarType coordinates = ScalarType::float32;
  RecordPromise promise;
};

/// A decoded file: everything it holds, nothing reconstructed yet.
struct DecodedScan {
  Profile profile = Profile::compact;
  SensorProfile sensor;  ///< compact files tell its name, if metadata are kept, and its elevations
  std::optional<PaperSettings> paper;      ///< of the paper's profiles
  std::vector<PaperPatch> paper_patches;   ///< of those with patches, on request
  std::optional<CompactContents> compact;  ///< of Profile::compact
  std::shared_ptr<const Field> field;
  /// Files with every return: the cloud as it was encoded, slot by slot. Not there if only a part
  /// was decoded.
  std::optional<Cloud> cloud;
  std::optional<RecordContents> records;  ///< of files with every return
  /// Compact files: the coded returns in raster order, then those without a cell; the same doubles
  /// on every machine. Empty in the paper's profiles, whose returns the field gives.
  std::vector<Vec3> points;
  /// What should be there and is not, one sentence each: the file was cut off.
  std::vector<std::string> missing;
  std::map<std::string, std::string> metadata;
  /// One value per coded return, in raster order (row by row, top row first).
  std::vector<Attribute> attributes;
  std::size_t coded_returns = 0;
  std::size_t coefficients = 0;
  std::size_t patches = 0;
};

/// Reads a .curl file. Never throws, whatever the bytes.
Result<DecodedScan> decode(std::span<const std::byte> bytes, const DecodeLimits& limits = {});
/// Invalid_argument for options that the file's profile does not know.
Result<DecodedScan> decode(std::span<const std::byte> bytes, const DecodeOptions& options);

/// Whether the bytes start as a .curl file of any version does.
bool is_curl(std::span<const std::byte> bytes);

/// One chunk of a .curl file, in file order.
struct ChunkInfo {
  std::string name;        ///< "sensor", "patches", ...
  std::size_t offset = 0;  ///< of its payload in the file
  std::size_t bytes = 0;   ///< of its payload, as stored
};
/// Where the bytes of a file go. Checks the container, not what the chunks hold.
Result<std::vector<ChunkInfo>> list_chunks(std::span<const std::byte> bytes);

}  // namespace curlidar
