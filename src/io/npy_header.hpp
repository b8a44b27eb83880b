// SPDX-License-Identifier: BSD-3-Clause
// The header of NumPy's .npy files: a Python dictionary literal, read by a small parser that knows
// only what such headers contain. Nothing is evaluated.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/formats.hpp"

namespace curlidar::io {

/// One field of a structured dtype, or the only one of a plain dtype (without a name).
struct NpyField {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::uint64_t components = 1;  ///< product of a sub-array's shape
  bool big_endian = false;
  bool padding = false;     ///< bytes without meaning
  std::uint64_t bytes = 0;  ///< of all components
};

struct NpyHeader {
  bool structured = false;
  std::vector<NpyField> fields;
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::size_t data_offset = 0;

  std::uint64_t item_bytes() const;
};

Result<NpyHeader> parse_npy_header(const Source& source);

/// The bytes before the data, for a dtype and a shape written as Python literals.
Bytes npy_header_bytes(const std::string& descr, const std::string& shape);

}  // namespace curlidar::io
