// SPDX-License-Identifier: BSD-3-Clause
// How far a guess is to be trusted, without anything learned.
#pragma once

#include "dense/look.hpp"
#include "dense/ring_points.hpp"
#include "dense/rules.hpp"

namespace curlidar {

/// How far rings lie from the surface that the rings beside them saw: the median over smooth places
/// of a scan, metres. Noise of the sensor, steps of its coding and roughness, all in one; 0 where
/// rings have no neighbours to tell. O(samples), 10 ms at most.
double ring_noise_m(const RingPoints& points);

/// P(a surface is there and |range error| <= 5 cm) as far as a few numbers tell.
float plain_confidence(const Look& look, const Guess& guess, double noise_m);

}  // namespace curlidar
