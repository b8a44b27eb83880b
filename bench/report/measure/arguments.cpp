// SPDX-License-Identifier: BSD-3-Clause
#include "report/measure/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "base/try.hpp"

namespace curlidar::bench {
namespace {

Error invalid(std::string message) {
  return {ErrorCode::invalid_argument, std::move(message)};
}

template <class Number>
bool parse(const std::string& text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end;
}

}  // namespace

std::string Arguments::option(const std::string& name, const std::string& otherwise) const {
  const auto found = options.find(name);
  return found == options.end() ? otherwise : found->second;
}

Result<std::uint32_t> Arguments::number(const std::string& name, std::uint32_t otherwise,
                                        std::uint32_t low, std::uint32_t high) const {
  const auto found = options.find(name);
  if (found == options.end()) return otherwise;
  std::uint32_t value = 0;
  if (parse(found->second, value) && value >= low && value <= high) return value;
  return invalid(
      fmt::format("--{} is '{}', not a whole number in {}..{}", name, found->second, low, high));
}

Result<Arguments> parse_arguments(const std::vector<std::string>& given, std::size_t words,
                                  const std::vector<std::string>& known) {
  Arguments arguments;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!given[i].starts_with("--")) {
      arguments.words.push_back(given[i]);
      continue;
    }
    const std::string name = given[i].substr(2);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return invalid(fmt::format("the option --{} is not known here", name));
    }
    if (i + 1 == given.size()) return invalid(fmt::format("--{} has no value", name));
    arguments.options[name] = given[++i];
  }
  if (arguments.words.size() == words) return arguments;
  return invalid(fmt::format("{} words given instead of {}", arguments.words.size(), words));
}

Result<std::vector<double>> parse_factors(const std::string& text) {
  std::vector<double> factors;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    double factor = 0;
    if (!parse(part, factor) || !(factor > 0 && factor <= 64)) {
      return invalid(fmt::format("'{}' is not a factor in (0, 64]", part));
    }
    factors.push_back(factor);
  }
  if (factors.empty()) return invalid("no factors are given");
  return factors;
}

}  // namespace curlidar::bench
