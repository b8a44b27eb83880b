// SPDX-License-Identifier: BSD-3-Clause
// A point cloud as its owner has it: any order, organised or not, NaN kept, named typed attributes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "curlidar/vec3.hpp"

namespace curlidar {

enum class ScalarType : std::uint8_t {
  int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64,
};

/// Bytes of one value of the type.
std::size_t size_of(ScalarType type);
/// "int8" .. "float64".
const char* to_string(ScalarType type);

/// A column of values; the alternative's index equals the ScalarType's number.
using Column =
    std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                 std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                 std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>,
                 std::vector<double>>;

ScalarType type_of(const Column& column);
std::size_t size_of(const Column& column);
/// An all-zero column of the given type and length.
Column make_column(ScalarType type, std::size_t size);

/// One named attribute: `components` consecutive values for each point.
struct Attribute {
  std::string name;              ///< "intensity", "ring", "time", ...
  std::uint32_t components = 1;  ///< values per point, at least 1
  Column values;

  /// Value of the first component of point i, converted to double.
  double as_double(std::size_t i) const;
};

/// Points with attributes. `positions` has one entry for every slot of the source, returns or not.
struct Cloud {
  std::vector<Vec3> positions;
  /// Type of the coordinates in the source; writers use it again. A double holds both exactly.
  ScalarType position_type = ScalarType::float32;
  std::vector<Attribute> attributes;  ///< each of size() * components values
  /// Organised layout: positions[row * width + column]. Unorganised clouds have height 1.
  std::uint32_t width = 0, height = 1;
  /// Free UTF-8 keys and values: frame_id, stamp_ns, viewpoint, source, user keys.
  std::map<std::string, std::string> metadata;

  std::size_t size() const { return positions.size(); }
  bool organised() const { return height > 1; }
  const Attribute* find(std::string_view name) const;
};

/// A slot holds a *return* if its coordinates are finite and not (0, 0, 0).
inline bool is_return(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
         !(p.x == 0 && p.y == 0 && p.z == 0);
}
/// Number of returns. O(n).
std::size_t count_returns(const Cloud& cloud);

/// The points at `indices`, in that order, unorganised, with all attributes and metadata.
/// Every index must be below cloud.size().
Cloud select(const Cloud& cloud, const std::vector<std::uint32_t>& indices);

/// The value at `fraction` of the sorted values: linear between order statistics (as numpy's
/// default percentile). NaN if empty. O(n); reorders its argument.
double percentile(std::vector<double>& values, double fraction);

}  // namespace curlidar
