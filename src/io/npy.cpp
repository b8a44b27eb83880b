// SPDX-License-Identifier: BSD-3-Clause
// NumPy arrays: N x k or H x W x k numbers with k >= 3, or N or H x W structures with fields x, y
// and z.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/try.hpp"
#include "io/columns.hpp"
#include "io/npy_header.hpp"

namespace curlidar::io {
namespace {

/// More columns mean that the array is transposed or no cloud.
constexpr std::uint64_t kMaxColumns = 64;

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  return fmt::format("({})", fmt::join(shape, ", "));
}

/// The number of elements; the data must be exactly that many.
Result<std::uint64_t> check_size(const Source& source, const NpyHeader& header) {
  const std::uint64_t left = source.bytes.size() - header.data_offset;
  std::uint64_t items = 1;
  bool overflow = false;
  for (const std::uint64_t size : header.shape) {
    overflow = overflow || (size != 0 && items > std::numeric_limits<std::uint64_t>::max() / size);
    items *= size;
  }
  if (std::find(header.shape.begin(), header.shape.end(), 0u) != header.shape.end()) {
    overflow = false;
    items = 0;
  }
  const std::uint64_t item = header.item_bytes();
  if (overflow || item == 0 || items != left / item || left % item != 0) {
    return error_at_byte(
        source, header.data_offset,
        fmt::format("an array of shape {} with {} bytes an item does not fill the {} bytes that "
                    "follow: the file is truncated or its header is wrong",
                    shape_text(header.shape), item, left));
  }
  return items;
}

/// Rows and columns of the grid of points: the first two dimensions, or one row.
struct Grid {
  std::uint64_t width = 0, height = 1;
};

Result<Grid> grid_of(const Source& source, const NpyHeader& header) {
  const std::size_t grid_dimensions = header.shape.size() - (header.structured ? 0 : 1);
  if (header.shape.empty() || grid_dimensions < 1 || grid_dimensions > 2) {
    return error_at_byte(source, header.data_offset,
                         fmt::format("the array has shape {}; a cloud is (N, k) or (H, W, k), or "
                                     "(N,) or (H, W) of structures",
                                     shape_text(header.shape)),
                         ErrorCode::unsupported);
  }
  if (grid_dimensions == 1) return Grid{header.shape[0], 1};
  return Grid{header.shape[1], header.shape[0]};
}

/// The fields of a plain array: one for each index of the last dimension.
Result<std::vector<FieldView>> plain_fields(const Source& source, const NpyHeader& header,
                                            const Grid& grid) {
  const std::uint64_t columns = header.shape.back();
  if (columns < 3 || columns > kMaxColumns) {
    return error_at_byte(source, header.data_offset,
                         fmt::format("the array has shape {}; its last dimension must be x, y, z "
                                     "and at most {} more. Is it transposed?",
                                     shape_text(header.shape), kMaxColumns - 3),
                         ErrorCode::unsupported);
  }
  const std::size_t item = size_of(header.fields[0].type);
  const std::vector<std::string> names = default_column_names(columns);
  std::vector<FieldView> fields;
  for (std::size_t k = 0; k < columns; ++k) {
    FieldView field{names[k], header.fields[0].type,       1,
                    k * item, grid.width * columns * item, columns * item};
    if (header.fortran_order) {
      field.offset = k * grid.width * grid.height * item;
      field.row_stride = item;
      field.column_stride = grid.height * item;
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

std::vector<Attribute> gather_plain(const Block& block, const std::vector<FieldView>& fields) {
  std::vector<Attribute> out;
  for (const FieldView& field : fields) out.push_back(gather(block, field));
  return out;
}

std::vector<Attribute> gather_structured(Block block, const NpyHeader& header, const Grid& grid) {
  const auto item = static_cast<std::size_t>(header.item_bytes());
  std::vector<Attribute> out;
  std::size_t offset = 0;
  for (const NpyField& field : header.fields) {
    if (!field.padding) {
      block.big_endian = field.big_endian;
      FieldView view{field.name, field.type,        static_cast<std::uint32_t>(field.components),
                     offset,     grid.width * item, item};
      if (header.fortran_order) {
        view.row_stride = item;
        view.column_stride = grid.height * item;
      }
      out.push_back(gather(block, view));
    }
    offset += field.bytes;
  }
  return out;
}

// ---- writing ----

std::string type_text(ScalarType type, bool big_endian) {
  const std::string_view name = to_string(type);
  const std::size_t size = size_of(type);
  return fmt::format("'{}{}{}'", size == 1 ? '|' : big_endian ? '>' : '<', name[0], size);
}

/// Whether a reader would give the columns of a plain array the names and the type they have.
bool is_plain(const std::vector<OutColumn>& columns) {
  const std::vector<std::string> names = default_column_names(columns.size());
  if (columns.size() > kMaxColumns) return false;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name != names[i] || columns[i].components != 1 ||
        columns[i].type() != columns[0].type()) {
      return false;
    }
  }
  return true;
}

Result<std::string> structure_text(const std::vector<OutColumn>& columns, bool big_endian) {
  std::string out = "[";
  for (const OutColumn& column : columns) {
    const bool odd = std::any_of(column.name.begin(), column.name.end(), [](char c) {
      return c == '\'' || c == '\\' || static_cast<unsigned char>(c) < 0x20;
    });
    if (odd) {
      return Error{ErrorCode::unsupported,
                   fmt::format("npy cannot hold an attribute named {}: rename it without quotes",
                               quoted(column.name))};
    }
    out += fmt::format("{}('{}', {}", out.size() > 1 ? ", " : "", column.name,
                       type_text(column.type(), big_endian));
    out += column.components > 1 ? fmt::format(", ({},))", column.components) : ")";
  }
  return out + "]";
}

}  // namespace

Result<Cloud> parse_npy(const Source& source) {
  CURLIDAR_TRY_ASSIGN(header, parse_npy_header(source));
  CURLIDAR_TRY_ASSIGN(grid, grid_of(source, header));
  CURLIDAR_TRY_ASSIGN(items, check_size(source, header));
  std::vector<FieldView> views;
  if (!header.structured) {
    CURLIDAR_TRY_ASSIGN(fields, plain_fields(source, header, grid));
    views = std::move(fields);
  }
  const std::uint64_t points = header.structured ? items : items / header.shape.back();
  CURLIDAR_TRY(check_point_count(source, points));
  const auto width = static_cast<std::uint32_t>(points == 0 ? 0 : grid.width);
  const auto height = static_cast<std::uint32_t>(points == 0 ? 1 : grid.height);
  const Block block{source.bytes.subspan(header.data_offset), width, height,
                    header.fields.empty() ? false : header.fields[0].big_endian};
  return assemble_cloud(
      source,
      header.structured ? gather_structured(block, header, grid) : gather_plain(block, views),
      width, height);
}

Result<Bytes> format_npy(const Cloud& cloud, Encoding encoding) {
  const bool big_endian = encoding == Encoding::binary_big_endian;
  const std::array<Column, 3> axes = coordinate_columns(cloud, written_position_type(cloud));
  const std::vector<OutColumn> columns = out_columns(cloud, axes);
  const std::string grid = cloud.organised() ? fmt::format("{}, {}", cloud.height, cloud.width)
                                             : fmt::format("{}", cloud.size());
  Bytes out;
  if (is_plain(columns)) {
    out = npy_header_bytes(type_text(columns[0].type(), big_endian),
                           fmt::format("({}, {})", grid, columns.size()));
  } else {
    CURLIDAR_TRY_ASSIGN(structure, structure_text(columns, big_endian));
    out = npy_header_bytes(
        structure, cloud.organised() ? fmt::format("({})", grid) : fmt::format("({},)", grid));
  }
  append_records(columns, cloud.size(), big_endian, out);
  return out;
}

}  // namespace curlidar::io
