// SPDX-License-Identifier: BSD-3-Clause
// Arguments of a verb: words, and options that take one value each.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "curlidar/result.hpp"

namespace curlidar::bench {

struct Arguments {
  std::vector<std::string> words;
  std::map<std::string, std::string> options;  ///< without the leading dashes

  /// The option's value, or what is meant without it.
  std::string option(const std::string& name, const std::string& otherwise) const;
  /// The same as a whole number. Invalid_argument unless it is one in [low, high].
  Result<std::uint32_t> number(const std::string& name, std::uint32_t otherwise, std::uint32_t low,
                               std::uint32_t high) const;
};

/// Invalid_argument if the number of words is not the given one, or an option is not known or has
/// no value.
Result<Arguments> parse_arguments(const std::vector<std::string>& given, std::size_t words,
                                  const std::vector<std::string>& known);

/// Numbers separated by commas, each in (0, 64].
Result<std::vector<double>> parse_factors(const std::string& text);

}  // namespace curlidar::bench
