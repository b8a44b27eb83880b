// SPDX-License-Identifier: BSD-3-Clause
#include "render/colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace curlidar::drawing {

namespace {

constexpr std::array<Colour, 9> kValueStops{{{0.33f, 0.27f, 0.66f},
                                             {0.26f, 0.41f, 0.82f},
                                             {0.13f, 0.56f, 0.82f},
                                             {0.11f, 0.68f, 0.70f},
                                             {0.25f, 0.77f, 0.53f},
                                             {0.52f, 0.83f, 0.36f},
                                             {0.80f, 0.84f, 0.27f},
                                             {0.98f, 0.83f, 0.36f},
                                             {1.00f, 0.93f, 0.72f}}};

constexpr std::array<Colour, 6> kErrorStops{{{0.24f, 0.29f, 0.38f},
                                             {0.36f, 0.30f, 0.47f},
                                             {0.62f, 0.27f, 0.42f},
                                             {0.88f, 0.38f, 0.27f},
                                             {0.98f, 0.63f, 0.24f},
                                             {1.00f, 0.93f, 0.60f}}};

template <std::size_t Size>
Colour between(const std::array<Colour, Size>& stops, double share) {
  if (std::isnan(share)) return {0.5f, 0.5f, 0.5f};
  const double at = std::clamp(share, 0.0, 1.0) * (Size - 1);
  const auto stop = std::min(static_cast<std::size_t>(at), Size - 2);
  return mix(stops[stop], stops[stop + 1], static_cast<float>(at - static_cast<double>(stop)));
}

}  // namespace

Colour map_value(double share) {
  return between(kValueStops, share);
}
Colour map_error(double share) {
  return between(kErrorStops, share);
}

}  // namespace curlidar::drawing
