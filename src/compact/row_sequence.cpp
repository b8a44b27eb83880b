// SPDX-License-Identifier: BSD-3-Clause
#include "compact/row_sequence.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "compact/scan_types.hpp"
#include "entropy/model.hpp"
#include "fixed/fixed.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint32_t kSmoothings = 4;
constexpr std::uint32_t kLimit = 30;
constexpr std::uint32_t kClasses = 33;

/// A number of up to 32 bits and its sign: zero flag, sign, class of the magnitude less one, its
/// bits from the top.
class NumberModels {
 public:
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t value) {
    const bool zero = code_bit(coder, zero_[last_zero_], kLimit, value == 0);
    last_zero_ = zero ? 1 : 0;
    if (zero) return 0;
    const bool negative = code_bit(coder, sign_, kLimit, value < 0);
    const auto target = static_cast<std::uint64_t>(std::abs(value)) - (value != 0);
    const auto target_size = static_cast<std::size_t>(std::bit_width(target));
    std::size_t size = 0;
    while (size + 1 < kClasses && code_bit(coder, size_[size], kLimit, target_size > size)) ++size;
    std::uint64_t magnitude = size > 0 ? 1 : 0;
    for (std::size_t place = size > 0 ? size - 1 : 0; place-- > 0;) {
      const bool bit = (target >> place & 1) != 0;
      const bool coded =
          place + 2 == size ? code_bit(coder, top_[size], kLimit, bit) : coder.code(32768, bit);
      magnitude = magnitude << 1 | (coded ? 1 : 0);
    }
    const auto found = static_cast<std::int64_t>(magnitude + 1);
    return negative ? -found : found;
  }

 private:
  std::array<BitModel, 2> zero_;
  BitModel sign_;
  std::array<BitModel, kClasses> size_, top_;
  std::size_t last_zero_ = 0;
};

template <class Coder>
std::uint32_t code_plain(Coder& coder, std::uint32_t value, int bits) {
  std::uint32_t found = 0;
  for (int i = bits; i-- > 0;) {
    found = found << 1 | (coder.code(32768, (value >> i & 1) != 0) ? 1u : 0u);
  }
  return found;
}

/// The mean of what came before, in 1/256, that forgets by 2^-smoothing.
class Expectation {
 public:
  explicit Expectation(std::uint32_t smoothing) : smoothing_(smoothing) {}
  std::int64_t value() const { return (mean_ + 128) >> 8; }
  void learn(std::int64_t value) {
    mean_ = first_ ? value * 256 : mean_ + ((value * 256 - mean_) >> smoothing_);
    first_ = false;
  }

 private:
  std::uint32_t smoothing_;
  std::int64_t mean_ = 0;
  bool first_ = true;
};

/// Codes values in units of 2^shift, of which `keep(value)` takes each; it says whether to go on.
template <class Coder, class Next, class Keep>
bool code_units(Coder& coder, std::size_t count, std::uint32_t smoothing, SequenceKind kind,
                const Next& next, const Keep& keep) {
  NumberModels first, models;
  Expectation expected(smoothing);
  std::int64_t last = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::int64_t value = next(k);
    if (kind == SequenceKind::steady_differences && k == 0) {
      last = first.code(coder, value);
    } else {
      const std::int64_t base = kind == SequenceKind::steady ? 0 : last;
      const std::int64_t guess = expected.value();
      const std::int64_t part = guess + models.code(coder, value - base - guess);
      expected.learn(part);
      last = base + part;
    }
    if (!keep(last)) return false;
  }
  return true;
}

template <class Coder>
void write_with(Coder& coder, const std::vector<std::int32_t>& values, std::uint32_t shift,
                std::uint32_t smoothing, SequenceKind kind) {
  code_plain(coder, shift, 5);
  code_plain(coder, smoothing, 2);
  code_units(
      coder, values.size(), smoothing, kind,
      [&](std::size_t k) { return std::int64_t{values[k]} >> shift; },
      [](std::int64_t) { return true; });
}

}  // namespace

void write_sequence(RangeEncoder& encoder, const std::vector<std::int32_t>& values,
                    std::uint32_t shift, SequenceKind kind) {
  std::uint32_t best = 0;
  std::uint64_t least = UINT64_MAX;
  for (std::uint32_t smoothing = 0; smoothing < kSmoothings; ++smoothing) {
    CostCounter counter;
    write_with(counter, values, shift, smoothing, kind);
    if (counter.cost() >= least) continue;
    least = counter.cost();
    best = smoothing;
  }
  write_with(encoder, values, shift, best, kind);
}

bool read_sequence(RangeDecoder& decoder, std::uint32_t count, std::int32_t limit,
                   std::vector<std::int32_t>& values, std::uint32_t& shift, SequenceKind kind) {
  shift = code_plain(decoder, 0, 5);
  const std::uint32_t smoothing = code_plain(decoder, 0, 2);
  if (shift > kMaxTableShift) return false;
  values.clear();
  values.reserve(count);
  return code_units(
      decoder, count, smoothing, kind, [](std::size_t) { return std::int64_t{0}; },
      [&](std::int64_t unit) {
        if (decoder.exhausted() || std::abs(unit) > (std::int64_t{limit} >> shift)) return false;
        values.push_back(static_cast<std::int32_t>(unit * (std::int64_t{1} << shift)));
        return true;
      });
}

}  // namespace curlidar::compact
