// SPDX-License-Identifier: BSD-3-Clause
#include "records/walk.hpp"

#include <array>
#include <numeric>

#include "entropy/plain_bits.hpp"
#include "records/numbers.hpp"

namespace curlidar {
namespace {

/// Codes the steps (modulo the number of rows) from each row of a walk to the next: often those of
/// one or of two rows before.
class StepModels {
 public:
  explicit StepModels(std::uint32_t rows)
      : bits_(static_cast<unsigned>(std::bit_width(rows - 1))) {}

  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t step) {
    std::uint32_t found = last_[1];
    if (!code_bit(coder, repeated_[0], kLimit, step == last_[1])) {
      found = last_[0];
      if (!code_bit(coder, repeated_[1], kLimit, step == last_[0])) {
        found = code_plain(coder, step, bits_);
      }
    }
    last_ = {last_[1], found};
    return found;
  }

 private:
  static constexpr std::uint32_t kLimit = 30;

  unsigned bits_;
  std::array<BitModel, 2> repeated_;
  std::array<std::uint32_t, 2> last_{1, 1};
};

/// `first` as the nearest way round from `from`, in [-columns / 2, columns / 2].
std::int64_t turn_between(std::uint32_t from, std::uint32_t first, std::uint32_t columns) {
  const std::int64_t ahead = (std::int64_t{first} - from + columns) % columns;
  return 2 * ahead > columns ? ahead - columns : ahead;
}

template <class Coder>
bool code_walk(Coder& coder, Walk& walk, std::uint32_t rows, std::uint32_t columns) {
  walk.by_column = coder.code(32768, walk.by_column);
  walk.backward = coder.code(32768, walk.backward);
  if constexpr (Coder::kDecodes) {
    walk.rows.assign(rows, 0);
    walk.first.assign(rows, 0);
  }
  StepModels steps(rows);
  SignedModels turns;
  std::vector<std::uint8_t> seen(rows);
  std::uint32_t row = rows - 1, first = 0;
  for (std::uint32_t k = 0; k < rows; ++k) {
    const std::uint32_t step = steps.code(coder, (walk.rows[k] + rows - row) % rows);
    if (step >= rows) return false;
    row = (row + step) % rows;
    if (seen[row] != 0) return false;
    seen[row] = 1;
    walk.rows[k] = row;
    const std::int64_t turn = turns.code(coder, turn_between(first, walk.first[row], columns));
    if (turn < -std::int64_t{columns} || turn > std::int64_t{columns}) return false;
    first = static_cast<std::uint32_t>((first + turn + columns) % columns);
    walk.first[row] = first;
  }
  return true;
}

}  // namespace

Walk Walk::raster(std::uint32_t rows) {
  Walk walk;
  walk.rows.resize(rows);
  std::iota(walk.rows.begin(), walk.rows.end(), 0u);
  walk.first.assign(rows, 0);
  return walk;
}

std::vector<std::uint32_t> Walk::cells(std::uint32_t columns) const {
  std::vector<std::uint32_t> cells;
  cells.reserve(rows.size() * columns);
  const auto visit = [&](std::uint32_t row, std::uint32_t t) {
    const std::uint32_t column = (first[row] + (backward ? columns - t : t)) % columns;
    cells.push_back(row * columns + column);
  };
  if (by_column) {
    for (std::uint32_t t = 0; t < columns; ++t) {
      for (const std::uint32_t row : rows) visit(row, t);
    }
  } else {
    for (const std::uint32_t row : rows) {
      for (std::uint32_t t = 0; t < columns; ++t) visit(row, t);
    }
  }
  return cells;
}

void write_walk(RangeEncoder& coder, const Walk& walk, std::uint32_t columns) {
  Walk copy = walk;
  code_walk(coder, copy, static_cast<std::uint32_t>(walk.rows.size()), columns);
}

bool read_walk(RangeDecoder& coder, Walk& walk, std::uint32_t rows, std::uint32_t columns) {
  return code_walk(coder, walk, rows, columns);
}

}  // namespace curlidar
