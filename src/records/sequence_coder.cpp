// SPDX-License-Identifier: BSD-3-Clause
#include "records/sequence_coder.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "records/numbers.hpp"

namespace curlidar {
namespace {

/// Sums and differences modulo 2^64.
std::int64_t plus(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t minus(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
std::int64_t times(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b));
}

/// Codes differences by how large the last two were.
class DifferenceModels {
 public:
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t difference) {
    difference = models_[4 * before_ + last_].code(coder, difference);
    before_ = last_;
    last_ = size_of(difference);
    return difference;
  }

 private:
  static std::size_t size_of(std::int64_t difference) {
    const auto bits = static_cast<std::uint64_t>(difference);
    const auto width = std::bit_width(difference < 0 ? 0 - bits : bits);
    return width == 0 ? 0 : width <= 2 ? 1 : width <= 8 ? 2 : 3;
  }

  std::array<SignedModels, 16> models_;
  std::size_t last_ = 0, before_ = 0;
};

/// Forecasts from the firing and the row of a cell: number = that of the firing + that of the row.
class FiringForecast {
 public:
  explicit FiringForecast(const RecordGeometry& geometry)
      : geometry_(geometry), firings_(geometry.grid.columns) {}

  std::int64_t at(std::uint32_t row, std::uint32_t column) {
    firing_ = &firings_[firing_of(row, column)];
    if (firing_->known) return plus(firing_->number, of_row_);
    const std::int64_t columns = std::int64_t{column} - last_column_;
    return plus(last_, times(step_, row == last_row_ ? columns : 1));
  }
  void learn(std::uint32_t row, std::uint32_t column, std::int64_t number) {
    if (firing_->known) {
      of_row_ = minus(number, firing_->number);
    } else {
      *firing_ = {minus(number, of_row_), true};
    }
    const std::int64_t columns = std::int64_t{column} - last_column_;
    if (row == last_row_ && columns > 0) step_ = minus(number, last_) / columns;
    last_ = number;
    last_row_ = row;
    last_column_ = column;
  }

 private:
  struct Firing {
    std::int64_t number = 0;
    bool known = false;
  };

  std::size_t firing_of(std::uint32_t row, std::uint32_t column) const {
    if (geometry_.column_shift.empty()) return column;
    const std::int64_t columns = geometry_.grid.columns;
    const std::int64_t firing = (std::int64_t{column} - geometry_.column_shift[row]) % columns;
    return static_cast<std::size_t>(firing < 0 ? firing + columns : firing);
  }

  const RecordGeometry& geometry_;
  std::vector<Firing> firings_;
  Firing* firing_ = nullptr;
  std::int64_t of_row_ = 0, last_ = 0, step_ = 0;
  std::uint32_t last_row_ = 0, last_column_ = 0;
};

/// Codes by the order of the slots.
template <class Coder, class GoOn>
bool code_in_slots(Coder& coder, bool line, const SequencePlaces& places,
                   std::vector<std::int64_t>& numbers, const GoOn& go_on) {
  DifferenceModels models;
  std::int64_t last = 0, before = 0;
  for (const std::uint32_t record : places.slots) {
    if (!go_on()) return false;
    const std::int64_t guess = line ? plus(last, minus(last, before)) : last;
    const std::int64_t number = plus(guess, models.code(coder, minus(numbers[record], guess)));
    numbers[record] = number;
    before = last;
    last = number;
  }
  return true;
}

/// Codes by the order of the records.
template <class Coder, class GoOn>
bool code_in_cells(Coder& coder, bool firings, const SequencePlaces& places,
                   std::vector<std::int64_t>& numbers, const GoOn& go_on) {
  const CellGrid& grid = places.geometry.grid;
  DifferenceModels models;
  FiringForecast forecast(places.geometry);
  std::size_t record = 0;
  std::int64_t last = 0;
  const auto code = [&](std::int64_t guess) {
    last = plus(guess, models.code(coder, minus(numbers[record], guess)));
    numbers[record++] = last;
  };
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    if (grid.occupied[cell] == 0) continue;
    if (!go_on()) return false;
    const auto row = static_cast<std::uint32_t>(cell / grid.columns);
    const auto column = static_cast<std::uint32_t>(cell % grid.columns);
    code(firings ? forecast.at(row, column) : last);
    if (firings) forecast.learn(row, column, last);
  }
  while (record < numbers.size()) {
    if (!go_on()) return false;
    code(last);
  }
  return true;
}

template <class Coder, class GoOn>
bool code_all(Coder& coder, Forecast forecast, const SequencePlaces& places,
              std::vector<std::int64_t>& numbers, const GoOn& go_on) {
  if (forecast == Forecast::last || forecast == Forecast::line) {
    return code_in_slots(coder, forecast == Forecast::line, places, numbers, go_on);
  }
  return code_in_cells(coder, forecast == Forecast::firing, places, numbers, go_on);
}

bool always() {
  return true;
}

}  // namespace

void write_sequence(RangeEncoder& coder, Forecast forecast, const SequencePlaces& places,
                    const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> copy = numbers;
  code_all(coder, forecast, places, copy, always);
}

std::uint64_t sequence_cost(Forecast forecast, const SequencePlaces& places,
                            const std::vector<std::int64_t>& numbers) {
  CostCounter counter;
  std::vector<std::int64_t> copy = numbers;
  code_all(counter, forecast, places, copy, always);
  return counter.cost();
}

bool read_sequence(RangeDecoder& coder, Forecast forecast, const SequencePlaces& places,
                   std::vector<std::int64_t>& numbers) {
  return code_all(coder, forecast, places, numbers, [&] { return !coder.exhausted(); }) &&
         !coder.exhausted();
}

}  // namespace curlidar
