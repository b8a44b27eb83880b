// SPDX-License-Identifier: BSD-3-Clause
#include "hostile/targets/sequence.hpp"
#include "run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return curlidar::fuzz::run(curlidar::test::sequence_target, data, size);
}
