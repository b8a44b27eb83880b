// SPDX-License-Identifier: BSD-3-Clause
#include "compact/row_sequence.hpp"

#include <cstdlib>

#include "compact/number_models.hpp"
#include "compact/scan_types.hpp"
#include "entropy/model.hpp"
#include "entropy/plain_bits.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint32_t kSmoothings = 4;

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
  shift = code_plain(decoder, 0u, 5);
  const std::uint32_t smoothing = code_plain(decoder, 0u, 2);
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
