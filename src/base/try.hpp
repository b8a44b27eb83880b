// SPDX-License-Identifier: BSD-3-Clause
// Passing errors up: the only two macros of the library.
#pragma once

#include <utility>

#include "curlidar/result.hpp"

/// Returns the error of `expression` (a Status or Result) from the enclosing function.
#define CURLIDAR_TRY(expression)                              \
  do {                                                        \
    auto&& curlidar_status = (expression);                    \
    if (!curlidar_status) return curlidar_status.error();     \
  } while (false)

/// Declares `variable` from a Result, or returns its error.
#define CURLIDAR_TRY_ASSIGN(variable, expression)             \
  auto variable##_result = (expression);                      \
  if (!variable##_result) return variable##_result.error();   \
  auto variable = std::move(*variable##_result)
