// SPDX-License-Identifier: BSD-3-Clause
// fmt is used without its shared library. Its functions are compiled in this file alone: were they
// in every file that formats a message, a build would take half as long again. Everywhere else its
// headers only declare them (curlidar_fmt in cmake/Dependencies.cmake); fmt::format, and fmt::join
// of strings and integers, need no others than those below, fmt::format_to would.
#define FMT_HEADER_ONLY 1
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <tuple>

namespace {

namespace detail = fmt::detail;

/// Inline functions whose addresses are taken are compiled.
[[gnu::used]] const auto kept = std::make_tuple(
    static_cast<std::string (*)(fmt::string_view, fmt::format_args)>(&fmt::vformat),
    static_cast<void (*)(std::FILE*, fmt::string_view, fmt::format_args)>(&fmt::vprint),
    static_cast<void (*)(fmt::string_view, fmt::format_args)>(&fmt::vprint),
    static_cast<bool (*)(std::uint32_t)>(&detail::is_printable), &detail::throw_format_error,
    &detail::assert_fail, &detail::thousands_sep_impl<char>);

}  // namespace
