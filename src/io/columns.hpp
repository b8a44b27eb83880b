// SPDX-License-Identifier: BSD-3-Clause
// Fields of a file to the columns of a Cloud and back, for every format.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/formats.hpp"

namespace curlidar::io {

/// A grid of points in a block of bytes; unorganised clouds are one row.
struct Block {
  ByteSpan bytes;
  std::uint32_t width = 0, height = 1;
  bool big_endian = false;
};

/// Where a field of the point in row r and column c lies in a Block:
/// at offset + r * row_stride + c * column_stride, its components one after the other.
struct FieldView {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::uint32_t components = 1;
  std::size_t offset = 0, row_stride = 0, column_stride = 0;
};

/// Copies a field out of a block. The caller has checked that it lies inside.
Attribute gather(const Block& block, const FieldView& field);

/// Makes a cloud of the fields of a file: x, y and z become positions, the others attributes.
/// Fails if one of the three is missing or not a scalar, or if two fields share a name.
Result<Cloud> assemble_cloud(const Source& source, std::vector<Attribute> fields,
                             std::uint32_t width, std::uint32_t height);

/// Names for the columns of a table without names: x y z, then intensity if there are 4, intensity
/// and ring if there are 5, else column3, column4, ...
std::vector<std::string> default_column_names(std::size_t columns);

/// A column to write; x, y and z come first.
struct OutColumn {
  std::string name;
  std::uint32_t components = 1;
  const Column* values = nullptr;

  ScalarType type() const { return type_of(*values); }
  std::size_t bytes_per_point() const { return size_of(type()) * components; }
};

/// float32 or float64: the coordinate type that a cloud is written with.
ScalarType written_position_type(const Cloud& cloud);
/// The x, y and z of a cloud as columns of the given floating-point type.
std::array<Column, 3> coordinate_columns(const Cloud& cloud, ScalarType type);
/// All columns in writing order. Points into `axes` and `cloud`.
std::vector<OutColumn> out_columns(const Cloud& cloud, const std::array<Column, 3>& axes);
/// The same with attributes of k > 1 components split into name_0 .. name_{k-1}; the new columns
/// are kept in `storage`.
std::vector<OutColumn> split_components(const std::vector<OutColumn>& columns, std::size_t points,
                                        std::vector<Column>& storage);

/// Writes a column's values into bytes: point i starts at first + i * stride.
void scatter(const OutColumn& column, std::byte* first, std::size_t stride, bool big_endian);
/// Points one after the other, each the values of all columns in order.
void append_records(const std::vector<OutColumn>& columns, std::size_t points, bool big_endian,
                    Bytes& out);

/// Whether the cloud is consistent: lengths of attributes, width * height of organised clouds,
/// attribute names present, distinct and not x, y, z.
Status check_writable(const Cloud& cloud);
/// Fails if a column's name is empty or has blanks or control characters: headers made of words
/// cannot hold it. `format` is for the message.
Status check_names_are_words(const std::vector<OutColumn>& columns, const char* format);

}  // namespace curlidar::io
