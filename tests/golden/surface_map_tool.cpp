// SPDX-License-Identifier: BSD-3-Clause
// surface_map_tool TILES FILE: makes the golden surface map anew from the golden tiles; for changes
// of the format only, and after surface_tool.
#include <cstdio>

#include "golden/surface_map.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto made = curlidar::test::write_golden_map(argv[1], argv[2]);
  if (!made) std::fprintf(stderr, "%s\n", made.error().message.c_str());
  return made ? 0 : 1;
}
