// SPDX-License-Identifier: BSD-3-Clause
#include "format/sensor_chunk.hpp"

#include <array>
#include <cstdint>
#include <utility>

#include "base/bytes.hpp"
#include "base/try.hpp"
#include "format/packed.hpp"
#include "format/payload.hpp"

namespace curlidar {
namespace {

constexpr std::uint64_t kMaxColumns = 65536;

// The orders of these lists are the format's.
constexpr std::array kScalars{&SensorProfile::fov_up, &SensorProfile::fov_down,
                              &SensorProfile::min_range_m, &SensorProfile::max_range_m,
                              &SensorProfile::beam_origin_radius_m};
constexpr std::array kRingColumns{&Ring::elevation, &Ring::azimuth_offset, &Ring::vertical_offset_m,
                                  &Ring::horizontal_offset_m};

}  // namespace

Result<std::vector<std::byte>> write_sensor(const SensorProfile& profile) {
  CURLIDAR_TRY(validate(profile));
  ByteWriter writer;
  CURLIDAR_TRY(write_text(writer, "sensor name", profile.name, kMaxSensorNameBytes));
  CURLIDAR_TRY(
      write_text(writer, "sensor description", profile.description, kMaxSensorDescriptionBytes));
  writer.write(static_cast<std::uint8_t>(profile.pattern));
  writer.write_varint(profile.columns);
  for (const auto scalar : kScalars) writer.write(profile.*scalar);
  writer.write_varint(profile.rings.size());
  ByteWriter numbers;
  for (const auto column : kRingColumns) {
    for (const Ring& ring : profile.rings) numbers.write(ring.*column);
  }
  writer.write_bytes(pack(split_planes(numbers.bytes(), sizeof(double))));
  return std::move(writer).bytes();
}

Result<SensorProfile> read_sensor(const Chunk& chunk) {
  PayloadReader reader(chunk);
  SensorProfile profile;
  CURLIDAR_TRY_ASSIGN(name, reader.read_text("sensor name", kMaxSensorNameBytes));
  CURLIDAR_TRY_ASSIGN(description,
                      reader.read_text("sensor description", kMaxSensorDescriptionBytes));
  profile.name = std::move(name);
  profile.description = std::move(description);
  const auto pattern = reader.read<std::uint8_t>();
  if (pattern > static_cast<std::uint8_t>(ScanPattern::limited_field)) {
    return reader.corrupt("unknown scan pattern " + std::to_string(pattern));
  }
  profile.pattern = static_cast<ScanPattern>(pattern);
  CURLIDAR_TRY_ASSIGN(columns, reader.read_count("columns", kMaxColumns));
  profile.columns = static_cast<std::uint32_t>(columns);
  for (const auto scalar : kScalars) profile.*scalar = reader.read<double>();
  CURLIDAR_TRY_ASSIGN(rings, reader.read_count("rings", kMaxRings));
  CURLIDAR_TRY_ASSIGN(
      planes, unpack_exactly(reader, "ring table", rings * kRingColumns.size() * sizeof(double)));
  CURLIDAR_TRY(reader.finish());

  const std::vector<std::byte> table = join_planes(planes, sizeof(double));
  ByteReader numbers(table);
  profile.rings.resize(static_cast<std::size_t>(rings));
  for (const auto column : kRingColumns) {
    for (Ring& ring : profile.rings) ring.*column = numbers.read<double>();
  }
  if (const Status valid = validate(profile); !valid) {
    return reader.corrupt("the sensor makes no sense: " + valid.error().message);
  }
  return profile;
}

}  // namespace curlidar
