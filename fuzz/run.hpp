// SPDX-License-Identifier: BSD-3-Clause
// Runs a target of tests/hostile/targets/ on an input of libFuzzer.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "base/bytes.hpp"

namespace curlidar::fuzz {

/// A broken promise ends the program as a fault of memory would.
template <class Target>
int run(const Target& target, const std::uint8_t* data, std::size_t size) {
  const std::string fault = target(std::as_bytes(std::span(data, size)));
  if (fault.empty()) return 0;
  std::fprintf(stderr, "broken promise: %s\n", fault.c_str());
  std::abort();
}

}  // namespace curlidar::fuzz
