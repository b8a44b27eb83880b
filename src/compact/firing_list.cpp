// SPDX-License-Identifier: BSD-3-Clause
#include "compact/firing_list.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>

#include "compact/number_models.hpp"
#include "entropy/model.hpp"

namespace curlidar::compact {
namespace {

constexpr std::uint32_t kLimit = 255;
constexpr std::int32_t kRate = 20;
/// Steps this far from the usual one are written in full.
constexpr std::int64_t kUnary = 12;

/// The deviations of steps from `usual` = floor(slots / count): zero flag, sign, magnitude in
/// unary, what is left of it as a number. Each flag is the mix of three contexts.
class StepModels {
 public:
  StepModels(std::uint32_t slots, std::uint32_t count)
      : usual_(slots / count), pace_((std::int64_t{slots} << 8) / count) {}

  /// Codes a step and gives it; anything may come out of a decoder.
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t step) {
    step = usual_ + deviation(coder, step - usual_);
    learn(step);
    return step;
  }

 private:
  static constexpr std::size_t kFlags = 2 + 2 * static_cast<std::size_t>(kUnary);
  static constexpr std::size_t kNear = 9, kRuns = 16, kLags = 65;
  using Flags = std::array<BitModel, kFlags>;

  template <class Coder>
  bool flag(Coder& coder, std::size_t which, bool bit) {
    const std::array<BitModel*, 3> models = {
        &pairs_[near(0) * kNear + near(1)][which],
        &runs_[near(0) * kRuns + std::min<std::size_t>(run_, kRuns - 1)][which],
        &lags_[lag()][which]};
    return code_bit(coder, models, weights_[which], kRate, kLimit, bit);
  }

  template <class Coder>
  std::int64_t deviation(Coder& coder, std::int64_t value) {
    if (flag(coder, 0, value == 0)) return 0;
    const bool negative = flag(coder, 1, value < 0);
    const std::size_t first = negative ? 2 + static_cast<std::size_t>(kUnary) : 2;
    const std::int64_t target = std::abs(value);
    std::int64_t size = 1;
    while (size <= kUnary &&
           flag(coder, first + static_cast<std::size_t>(size) - 1, target > size)) {
      ++size;
    }
    if (size > kUnary) size += std::abs(rest_.code(coder, target - size));
    return negative ? -size : size;
  }

  void learn(std::int64_t step) {
    run_ = step == last_[0] ? run_ + 1 : 0;
    last_ = {step, last_[0]};
    constexpr std::int64_t most = std::int64_t{1} << 20;
    late_ = std::clamp(late_ - late_ / 8 + pace_ - step * 256, -most, most);
  }

  /// How far one of the last two steps is from the usual one, 0..8.
  std::size_t near(std::size_t i) const {
    return static_cast<std::size_t>(std::clamp<std::int64_t>(last_[i] - usual_, -4, 4) + 4);
  }
  /// How far behind a steady turn the position is, in quarters of a slot, about 32.
  std::size_t lag() const {
    return static_cast<std::size_t>(std::clamp<std::int64_t>((late_ + 32) >> 6, -32, 32) + 32);
  }

  std::int64_t usual_, pace_;
  std::int64_t late_ = 0;  ///< what the steps fell short of the pace, in 1/256, forgotten by 1/8
  std::array<std::int64_t, 2> last_{};
  std::size_t run_ = 0;
  std::vector<Flags> pairs_ = std::vector<Flags>(kNear * kNear);
  std::vector<Flags> runs_ = std::vector<Flags>(kNear * kRuns);
  std::vector<Flags> lags_ = std::vector<Flags>(kLags);
  std::array<MixWeights<3>, kFlags> weights_;
  NumberModels rest_;
};

}  // namespace

void write_firings(RangeEncoder& encoder, const std::vector<std::uint32_t>& firings,
                   std::uint32_t slots) {
  StepModels models(slots, static_cast<std::uint32_t>(firings.size()));
  std::int64_t last = -1;
  for (const std::uint32_t firing : firings) {
    models.code(encoder, firing - last);
    last = firing;
  }
}

bool read_firings(RangeDecoder& decoder, std::uint32_t count, std::uint32_t slots,
                  std::vector<std::uint32_t>& firings) {
  if (count == 0 || count > slots) return false;
  StepModels models(slots, count);
  firings.clear();
  std::int64_t last = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int64_t step = models.code(decoder, 0);
    if (decoder.exhausted() || step < 1 || step >= slots - last) return false;
    last += step;
    firings.push_back(static_cast<std::uint32_t>(last));
  }
  return true;
}

}  // namespace curlidar::compact
