// SPDX-License-Identifier: BSD-3-Clause
#include "records/column_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "base/try.hpp"
#include "entropy/plain_bits.hpp"
#include "records/level_coder.hpp"
#include "records/level_window.hpp"
#include "records/numbers.hpp"

namespace curlidar {
namespace {

// The first byte of a column: a forecast, or one of these.
constexpr std::uint8_t kLevels = 4;
constexpr std::uint8_t kPalette = 5;

constexpr std::size_t kMostLevels = 256;
constexpr int kMostLevelBits = 8;
/// Numbers further apart have more levels at any mantissa.
constexpr std::uint64_t kMostSpan = 0xffffffff;
/// Mantissas of this many bits keep levels below 2^(1 + bits) as they are; 7 keeps all.
constexpr int kFewestMantissaBits = 3, kMostMantissaBits = 7;
constexpr std::uint32_t kLimit = 255;

std::uint64_t zigzag(std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  return bits << 1 ^ (value < 0 ? ~std::uint64_t{0} : 0);
}
std::int64_t unzigzag(std::uint64_t bits) {
  return static_cast<std::int64_t>(bits >> 1 ^ (0 - (bits & 1)));
}

std::uint64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b);
}
/// Modulo 2^64.
std::int64_t sum(std::int64_t a, std::uint64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + b);
}

/// Small numbers are levels of their own; larger ones keep their highest bits.
struct Levels {
  int mantissa_bits = kMostMantissaBits;

  int dropped(std::uint32_t level) const {
    return std::max(static_cast<int>(level >> mantissa_bits) - 1, 0);
  }
  std::uint32_t level_of(std::uint64_t number) const {
    const int drop = std::max(static_cast<int>(std::bit_width(number)) - 1 - mantissa_bits, 0);
    return static_cast<std::uint32_t>((std::uint64_t(drop) << mantissa_bits) + (number >> drop));
  }
  /// The least number of a level.
  std::uint64_t least(std::uint32_t level) const {
    const int drop = dropped(level);
    return (std::uint64_t{level} - (std::uint64_t(drop) << mantissa_bits)) << drop;
  }
};

/// Codes a number for each record as levels and the bits that they drop.
template <class Coder, class GoOn>
bool code_levels(Coder& coder, const Levels& levels, int bits, const RecordGeometry& geometry,
                 std::vector<std::uint64_t>& numbers, const GoOn& go_on) {
  LevelCoder level_coder(bits, numbers.size());
  LevelScan scan(geometry);
  std::array<BitModel, kMostLevels> first_dropped;
  for (std::uint64_t& number : numbers) {
    if (!scan.next() || !go_on()) return false;
    const LevelWindow window = scan.window();
    const auto wanted = static_cast<std::int32_t>(levels.level_of(number));
    const std::int32_t found = level_coder.code(coder, window, Coder::kDecodes ? 0 : wanted);
    scan.set(window, found);
    const auto level = static_cast<std::uint32_t>(found);
    const int drop = levels.dropped(level);
    std::uint64_t rest = 0;
    if (drop > 0) {
      rest = code_bit(coder, first_dropped[level], kLimit, (number >> (drop - 1) & 1) != 0) ? 1 : 0;
      const std::uint64_t low = (std::uint64_t{1} << (drop - 1)) - 1;
      rest = rest << (drop - 1) | code_plain(coder, number & low, static_cast<unsigned>(drop - 1));
    }
    number = levels.least(level) + rest;
  }
  return true;
}

void write_stream(ByteWriter& writer, RangeEncoder&& coder) {
  const std::vector<std::byte> stream = std::move(coder).finish();
  writer.write_varint(stream.size());
  writer.write_bytes(stream);
}

void write_levels(ByteWriter& writer, std::vector<std::uint64_t> numbers,
                  const RecordGeometry& geometry) {
  const std::uint64_t most =
      numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end());
  Levels levels;
  while (levels.level_of(most) >= kMostLevels) --levels.mantissa_bits;
  const int bits = static_cast<int>(std::bit_width(levels.level_of(most)));
  writer.write(static_cast<std::uint8_t>(levels.mantissa_bits));
  writer.write(static_cast<std::uint8_t>(bits));
  RangeEncoder coder;
  code_levels(coder, levels, bits, geometry, numbers, [] { return true; });
  write_stream(writer, std::move(coder));
}

/// The different numbers, ascending; nothing if they are too many for a palette.
std::optional<std::vector<std::int64_t>> palette_of(const std::vector<std::int64_t>& numbers) {
  std::vector<std::int64_t> palette;
  for (const std::int64_t number : numbers) {
    const auto at = std::lower_bound(palette.begin(), palette.end(), number);
    if (at != palette.end() && *at == number) continue;
    if (palette.size() == kMostLevels) return std::nullopt;
    palette.insert(at, number);
  }
  return palette;
}

void write_palette(ByteWriter& writer, const std::vector<std::int64_t>& palette) {
  writer.write(kPalette);
  writer.write_varint(palette.size());
  writer.write_varint(zigzag(palette.front()));
  for (std::size_t i = 1; i < palette.size(); ++i) {
    writer.write_varint(difference(palette[i], palette[i - 1]) - 1);
  }
}

/// Nothing if there are no numbers or they are too far apart.
std::optional<std::vector<std::byte>> encode_levels(const std::vector<std::int64_t>& numbers,
                                                    const RecordGeometry& geometry) {
  if (numbers.empty()) return std::nullopt;
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  const std::uint64_t span = difference(*most, *least);
  const auto palette = span < kMostLevels ? std::nullopt : palette_of(numbers);
  if (!palette && span > kMostSpan) return std::nullopt;
  ByteWriter writer;
  std::vector<std::uint64_t> places;
  places.reserve(numbers.size());
  if (palette) {
    write_palette(writer, *palette);
    for (const std::int64_t number : numbers) {
      const auto at = std::lower_bound(palette->begin(), palette->end(), number);
      places.push_back(static_cast<std::uint64_t>(at - palette->begin()));
    }
  } else {
    writer.write(kLevels);
    writer.write_varint(zigzag(*least));
    for (const std::int64_t number : numbers) places.push_back(difference(number, *least));
  }
  write_levels(writer, std::move(places), geometry);
  return std::move(writer).bytes();
}

std::vector<std::byte> encode_sequence(const std::vector<std::int64_t>& numbers,
                                       const SequencePlaces& places) {
  auto best = Forecast::last;
  std::uint64_t least = sequence_cost(best, places, numbers);
  for (std::uint8_t i = 1; i < kForecasts; ++i) {
    const auto forecast = static_cast<Forecast>(i);
    const std::uint64_t cost = sequence_cost(forecast, places, numbers);
    if (cost >= least) continue;
    least = cost;
    best = forecast;
  }
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(best));
  RangeEncoder coder;
  write_sequence(coder, best, places, numbers);
  write_stream(writer, std::move(coder));
  return std::move(writer).bytes();
}

Result<ByteSpan> read_stream(PayloadReader& reader) {
  const std::uint64_t size = reader.read_varint();
  const ByteSpan stream = reader.take(size);
  CURLIDAR_TRY(reader.check("values of an attribute"));
  return stream;
}

/// Numbers from their least one or from a palette of them.
Result<std::vector<std::int64_t>> read_palette(PayloadReader& reader) {
  CURLIDAR_TRY_ASSIGN(count, reader.read_count("values of a palette", kMostLevels));
  if (count == 0) return reader.corrupt("a palette without values");
  std::vector<std::int64_t> palette{unzigzag(reader.read_varint())};
  while (palette.size() < count) {
    palette.push_back(sum(palette.back(), reader.read_varint() + 1));
  }
  CURLIDAR_TRY(reader.check("palette of an attribute"));
  return palette;
}

Result<std::vector<std::uint64_t>> read_levels(PayloadReader& reader, std::size_t records,
                                               const RecordGeometry& geometry) {
  const Levels levels{reader.read<std::uint8_t>()};
  const int bits = reader.read<std::uint8_t>();
  CURLIDAR_TRY_ASSIGN(stream, read_stream(reader));
  if (levels.mantissa_bits < kFewestMantissaBits || levels.mantissa_bits > kMostMantissaBits ||
      bits > kMostLevelBits) {
    return reader.corrupt(
        fmt::format("levels of {} bits with mantissas of {} bits", bits, levels.mantissa_bits));
  }
  RangeDecoder coder(stream);
  std::vector<std::uint64_t> numbers(records);
  const auto go_on = [&] { return !coder.exhausted(); };
  if (!code_levels(coder, levels, bits, geometry, numbers, go_on) || coder.exhausted()) {
    return reader.corrupt("the values of an attribute end early");
  }
  return numbers;
}

}  // namespace

std::vector<std::byte> encode_column(const std::vector<std::int64_t>& numbers,
                                     const SequencePlaces& places) {
  std::vector<std::byte> best = encode_sequence(numbers, places);
  // A sequence that costs next to nothing follows its rule: no need to try what takes longer.
  if (8 * best.size() < numbers.size() / 8) return best;
  auto levels = encode_levels(numbers, places.geometry);
  return levels && levels->size() < best.size() ? std::move(*levels) : best;
}

Result<std::vector<std::int64_t>> decode_column(PayloadReader& reader, std::size_t records,
                                                const SequencePlaces& places) {
  const auto form = reader.read<std::uint8_t>();
  CURLIDAR_TRY(reader.check("form of an attribute"));
  std::vector<std::int64_t> numbers(records);
  if (form < kForecasts) {
    CURLIDAR_TRY_ASSIGN(stream, read_stream(reader));
    RangeDecoder coder(stream);
    if (read_sequence(coder, static_cast<Forecast>(form), places, numbers)) return numbers;
    return reader.corrupt("the values of an attribute end early");
  }
  if (form > kPalette) return reader.corrupt(fmt::format("unknown form {} of values", form));
  std::vector<std::int64_t> palette;
  std::int64_t least = 0;
  if (form == kPalette) {
    CURLIDAR_TRY_ASSIGN(read, read_palette(reader));
    palette = std::move(read);
  } else {
    least = unzigzag(reader.read_varint());
  }
  CURLIDAR_TRY_ASSIGN(found, read_levels(reader, records, places.geometry));
  for (std::size_t i = 0; i < records; ++i) {
    if (form == kPalette && found[i] >= palette.size()) {
      return reader.corrupt("a value that is not in its palette");
    }
    numbers[i] =
        form == kPalette ? palette[static_cast<std::size_t>(found[i])] : sum(least, found[i]);
  }
  return numbers;
}

}  // namespace curlidar
