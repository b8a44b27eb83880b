// SPDX-License-Identifier: BSD-3-Clause
#include "hostile/targets/predicted.hpp"

#include "chunk_mutator.hpp"
#include "run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return curlidar::fuzz::run(curlidar::test::predicted_target, data, size);
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return curlidar::fuzz::mutate_chunks(curlidar::test::kPredictedHeader, data, size, max_size,
                                       seed);
}
