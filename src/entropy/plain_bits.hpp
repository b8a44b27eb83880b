// SPDX-License-Identifier: BSD-3-Clause
// Bits that nothing is known of.
#pragma once

#include <concepts>

namespace curlidar {

/// Codes a number of `bits` bits, all equally likely, the highest first.
template <class Coder, std::unsigned_integral Number>
Number code_plain(Coder& coder, Number value, unsigned bits) {
  Number found = 0;
  for (unsigned place = bits; place-- > 0;) {
    found = found << 1 | (coder.code(32768, (value >> place & 1) != 0) ? 1u : 0u);
  }
  return found;
}

}  // namespace curlidar
