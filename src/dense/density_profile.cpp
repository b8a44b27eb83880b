// SPDX-License-Identifier: BSD-3-Clause
#include "dense/density_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/try.hpp"
#include "curlidar/io.hpp"
#include "dense/embedded_density.hpp"
#include "sensor/angles.hpp"

namespace curlidar {
namespace {

constexpr std::int16_t kMostPermille = 1000;

struct NamedTable {
  const char* name;
  const RangeTable* table;
  int low, high;
};

Status validate_table(const NamedTable& named, std::size_t rows) {
  if (!named.table->empty() && named.table->rows() != rows) {
    return Error{ErrorCode::invalid_argument, fmt::format("{} has {} rows, the profile {}",
                                                          named.name, named.table->rows(), rows)};
  }
  for (std::size_t row = 0; row < named.table->rows(); ++row) {
    for (const std::int16_t number : named.table->row(row)) {
      if (number >= named.low && number <= named.high) continue;
      return Error{ErrorCode::invalid_argument,
                   fmt::format("{}, row {}: {} is not in {} .. {}", named.name, row, number,
                               named.low, named.high)};
    }
  }
  return {};
}

Status validate_trees(const char* name, const ObliviousTrees& trees, std::size_t features) {
  if (trees.empty()) return {};
  Status status = validate(trees);
  if (status && trees.features() == features) return {};
  return Error{ErrorCode::invalid_argument,
               fmt::format("trees of {}: {}", name,
                           status ? fmt::format("cuts of {} features are meant", features)
                                  : status.error().message)};
}

}  // namespace

std::size_t RangeTable::bin(double range_m) {
  const double bin = kBinScale_m / range_m;
  return bin < kBins ? static_cast<std::size_t>(std::max(bin, 0.0)) : kBins - 1;
}

double DensityProfile::elevation(std::size_t row, double range_m) const {
  return radians_of(elevation_mdeg.at(row, range_m) / 1000);
}

double DensityProfile::return_share(std::size_t row, double range_m) const {
  return return_permille.empty() ? 1 : return_permille.at(row, range_m) / kMostPermille;
}

double DensityProfile::given_return_share(std::size_t row, double range_m) const {
  return given_return_permille.empty() ? 1 : given_return_permille.at(row, range_m) / kMostPermille;
}

double DensityProfile::bias_m(std::size_t row, double range_m) const {
  return bias_mm.empty() ? 0 : bias_mm.at(row, range_m) / 1000;
}

Status validate(const DensityProfile& profile) {
  const auto invalid = [&](std::string what) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("density profile \"{}\": {}", profile.name, what)};
  };
  if (profile.rows > kMaxDensityRows) {
    return invalid(fmt::format("{} rows are more than {}", profile.rows, kMaxDensityRows));
  }
  if (profile.given_every < 1 || profile.given_every > kMaxDensityRows ||
      profile.given_first >= std::max<std::size_t>(profile.rows, 1)) {
    return invalid("the rows given must be rows of the profile");
  }
  for (const NamedTable& named :
       {NamedTable{"elevation_mdeg", &profile.elevation_mdeg, -30000, 30000},
        {"return_permille", &profile.return_permille, 0, kMostPermille},
        {"given_return_permille", &profile.given_return_permille, 0, kMostPermille},
        {"bias_mm", &profile.bias_mm, -kMaxBias_mm, kMaxBias_mm}}) {
    if (Status status = validate_table(named, profile.rows); !status) {
      return invalid(status.error().message);
    }
  }
  CURLIDAR_TRY(validate_trees("returns", profile.returns, kRowFeatures));
  CURLIDAR_TRY(validate_trees("residual", profile.residual, kRowFeatures));
  CURLIDAR_TRY(validate_trees("confidence", profile.confidence, kPlainFeatures));
  CURLIDAR_TRY(validate_trees("row_confidence", profile.row_confidence, kRowFeatures));
  if (profile.rows > 0 && profile.elevation_mdeg.empty()) return invalid("rows need elevations");
  if (profile.rows == 0 &&
      !(profile.returns.empty() && profile.residual.empty() && profile.row_confidence.empty())) {
    return invalid("trees of rows need rows");
  }
  return {};
}

std::vector<std::string> builtin_density_names() {
  std::vector<std::string> names;
  for (const EmbeddedText& text : embedded_density()) names.emplace_back(text.name);
  std::sort(names.begin(), names.end());
  return names;
}

const ObliviousTrees& generic_confidence() {
  // Of the library's own text, which cannot be wrong: a test reads it.
  static const ObliviousTrees trees =
      std::move(builtin_density_profile("generic").value().confidence);
  return trees;
}

Result<std::shared_ptr<const DensityProfile>> load_density_profile(
    const std::string& name_or_path) {
  constexpr std::size_t kMostBytes = std::size_t{4} << 20;
  constexpr std::string_view kEnding = ".toml";
  if (!name_or_path.ends_with(kEnding)) {
    CURLIDAR_TRY_ASSIGN(builtin, builtin_density_profile(name_or_path));
    return std::make_shared<const DensityProfile>(std::move(builtin));
  }
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(name_or_path, failure);
  if (!failure && size > kMostBytes) {
    return Error{
        ErrorCode::limit_exceeded,
        fmt::format("{}: {} bytes are too many for a density profile, which has {} at most",
                    name_or_path, size, kMostBytes)};
  }
  CURLIDAR_TRY_ASSIGN(bytes, read_file(name_or_path));
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  CURLIDAR_TRY_ASSIGN(read, parse_density_profile(text, name_or_path));
  return std::make_shared<const DensityProfile>(std::move(read));
}

Result<DensityProfile> builtin_density_profile(std::string_view name) {
  const std::string_view text = text_named(embedded_density(), name);
  if (text.empty()) {
    std::string known;
    for (const std::string& other : builtin_density_names()) known += " " + other;
    return Error{ErrorCode::not_found,
                 fmt::format("no built-in density profile is named \"{}\"; there are{}",
                             name.substr(0, 64), known.empty() ? " none" : known)};
  }
  return parse_density_profile(text, fmt::format("built-in density profile {}", name));
}

}  // namespace curlidar
