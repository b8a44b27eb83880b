// SPDX-License-Identifier: BSD-3-Clause
#include <curlidar/version.hpp>

#include <cstdio>

int main() {
  std::printf("curlidar %s\n", curlidar::version());
  return 0;
}
