// SPDX-License-Identifier: BSD-3-Clause
#include "format/parameters_chunk.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "format/payload.hpp"

namespace curlidar {
namespace {

/// Calls field(member) for every setting, in the order of the format. One list for both
/// directions, so that reader and writer cannot drift apart.
template <class Settings, class Field>
void for_each_field(Settings& s, const Field& field) {
  field(s.row_rule);
  field(s.rows);
  field(s.columns);
  field(s.min_range_m);
  field(s.max_range.metres);
  field(s.max_range.percentile);
  field(s.outlier_radius_m);
  field(s.outlier_min_points);
  field(s.upsample_rows);
  field(s.upsample_columns);
  field(s.refused_triangle_share);
  field(s.cliffs.row_m);
  field(s.cliffs.column_m);
  field(s.cliffs.diagonal_m);
  field(s.patch);
  field(s.overlap);
  field(s.max_degree);
  field(s.accept_m);
  field(s.reject_m);
  field(s.k);
  field(s.stop_on_total_error);
  field(s.global_degree);
  field(s.global_reject_m);
}

struct FieldWriter {
  ByteWriter& writer;

  void operator()(double value) const { writer.write(value); }
  void operator()(std::uint32_t value) const { writer.write_varint(value); }
  void operator()(bool value) const { writer.write(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void operator()(RowRule value) const { writer.write(static_cast<std::uint8_t>(value)); }
};

/// Reads fields until one is wrong, and keeps what was wrong with it.
struct FieldReader {
  PayloadReader& reader;
  Status& status;

  void operator()(double& value) const {
    value = reader.read<double>();
    require(std::isfinite(value), "a setting is not finite");
  }
  void operator()(std::uint32_t& value) const {
    const std::uint64_t wide = reader.read_varint();
    require(wide <= std::numeric_limits<std::uint32_t>::max(), "a setting is too large");
    value = static_cast<std::uint32_t>(wide);
  }
  void operator()(bool& value) const {
    const auto byte = reader.read<std::uint8_t>();
    require(byte <= 1, "a switch is neither 0 nor 1");
    value = byte == 1;
  }
  void operator()(RowRule& value) const {
    const auto byte = reader.read<std::uint8_t>();
    require(byte <= static_cast<std::uint8_t>(RowRule::rings), "unknown row rule");
    value = static_cast<RowRule>(byte);
  }
  void require(bool condition, const char* problem) const {
    if (status && !reader.ok()) status = reader.check("settings");
    if (status && !condition) status = reader.corrupt(problem);
  }
};

}  // namespace

std::vector<std::byte> write_parameters(const Parameters& parameters) {
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(parameters.profile));
  for_each_field(parameters.paper, FieldWriter{writer});
  return std::move(writer).bytes();
}

Result<Parameters> read_parameters(const Chunk& chunk) {
  PayloadReader reader(chunk);
  Parameters parameters;
  const auto profile = reader.read<std::uint8_t>();
  if (profile > static_cast<std::uint8_t>(Profile::paper_global)) {
    return reader.error(ErrorCode::unsupported,
                        fmt::format("unknown profile {}; the file needs a newer version of "
                                    "curlidar",
                                    profile));
  }
  parameters.profile = static_cast<Profile>(profile);
  Status status;
  for_each_field(parameters.paper, FieldReader{reader, status});
  CURLIDAR_TRY(status);
  CURLIDAR_TRY(reader.finish());
  return parameters;
}

}  // namespace curlidar
