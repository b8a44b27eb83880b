// SPDX-License-Identifier: BSD-3-Clause
// fmt is used without its shared library. Its functions are compiled in this file alone: were they
// in every file that formats a message, a build would take half as long again. Everywhere else its
// headers only declare them (curlidar_fmt in cmake/Dependencies.cmake).
#define FMT_HEADER_ONLY 1
#include <cstdint>
#include <cstdio>
#include <string>
#include <tuple>

#include <fmt/format.h>

namespace {

namespace detail = fmt::detail;

/// Inline functions whose addresses are taken are compiled: what headers call that are compiled
/// without FMT_HEADER_ONLY.
[[gnu::used]] const auto kept = std::make_tuple(
    static_cast<std::string (*)(fmt::string_view, fmt::format_args)>(&fmt::vformat),
    static_cast<void (*)(std::FILE*, fmt::string_view, fmt::format_args)>(&fmt::vprint),
    static_cast<void (*)(fmt::string_view, fmt::format_args)>(&fmt::vprint),
    static_cast<bool (*)(std::uint32_t)>(&detail::is_printable), &detail::throw_format_error,
    &detail::assert_fail, &detail::thousands_sep_impl<char>, &detail::decimal_point_impl<char>,
    &detail::dragonbox::to_decimal<float>, &detail::dragonbox::to_decimal<double>);

[[gnu::used]] void throw_error() {
  throw fmt::format_error("");
}

}  // namespace
