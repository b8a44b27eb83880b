// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace curlidar {

/// Number of workers for a setting where 0 means all cores.
inline std::size_t resolve_threads(std::size_t threads) {
  return threads != 0 ? threads : std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

/// Calls body(i) for every i in [0, count), from up to `threads` threads, in any order. Each i
/// must write only what belongs to it, so that results do not depend on the number of threads.
/// The body must not throw.
template <class Body>
void parallel_for(std::size_t count, std::size_t threads, const Body& body) {
  const std::size_t workers = std::min(resolve_threads(threads), count);
  if (workers <= 1) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) body(i);
  };
  std::vector<std::thread> pool;
  pool.reserve(workers - 1);
  for (std::size_t t = 1; t < workers; ++t) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
}

}  // namespace curlidar
