// SPDX-License-Identifier: BSD-3-Clause
// The facade: a scan in, bytes out; bytes in, a continuous scan out; clouds of any density from it.
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
  Profile profile = Profile::paper;
  PaperSettings paper{};
  /// The sensor; detected from the cloud when absent.
  std::optional<SensorProfile> sensor{};
  /// Attributes to keep: nullopt = all, empty = none. Unknown names are an error.
  std::optional<std::vector<std::string>> attributes{};
  std::size_t threads = 1;  ///< never changes the bytes; 0 = all cores
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
  std::vector<StageTime> stages_ms;
};

struct Encoded {
  std::vector<std::byte> bytes;
  EncodeReport report;
};

/// Encodes one scan. Same bytes for any thread count. Cost: about 0.1 s for 120 k points.
Result<Encoded> encode(const Cloud& cloud, const EncodeSettings& settings = {},
                       const ProgressCallback& progress = {});

/// Caps on what a file may make the decoder allocate.
struct DecodeLimits {
  std::uint64_t max_cells = 1u << 26;    ///< rows * columns of the coded lattice
  std::uint64_t max_bytes = 1ull << 32;  ///< total of unpacked chunks
};

/// A decoded file: everything it holds, nothing reconstructed yet.
struct DecodedScan {
  Profile profile = Profile::paper;
  SensorProfile sensor;
  PaperSettings settings;
  std::shared_ptr<const Field> field;
  std::map<std::string, std::string> metadata;
  /// One value per coded return, in raster order (row by row, top row first).
  std::vector<Attribute> attributes;
  std::size_t coded_returns = 0;
  std::size_t coefficients = 0;
  std::size_t patches = 0;
};

/// Reads a .curl file. Never throws, whatever the bytes.
Result<DecodedScan> decode(std::span<const std::byte> bytes, const DecodeLimits& limits = {});

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

struct ReconstructSettings {
  double rows = 1;         ///< R_row: factor on the coded lattice's rows, may be fractional, > 0
  double columns = 1;      ///< R_col
  bool masks = true;       ///< apply point grid and cliffs; off gives every cell a point
  bool organised = false;  ///< keep empty cells as NaN
  std::size_t threads = 1;
  std::uint64_t max_points = 1ull << 31;  ///< refuse larger grids
};

/// The cloud seen on an R_row x R_col times denser grid. With factors 1 x 1 and masks: the coded
/// returns one for one with their attributes; otherwise attributes of the nearest coded return.
Result<Cloud> reconstruct(const DecodedScan& scan, const ReconstructSettings& settings = {});

}  // namespace curlidar
