// SPDX-License-Identifier: BSD-3-Clause
// What models know before the first bit: tables of docs/format/priors, learnt once from many scans
// and part of the format ever since.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "entropy/model.hpp"

namespace curlidar {

/// Sets the models to the states in `text`: for each model four hexadecimal digits, two of its
/// stretched probability (signed, in 24/256) and two of its visits; white space and lines that
/// start with # are skipped. Models beyond the text's end keep their state. False if the text holds
/// anything else or more states than models.
bool apply_priors(std::string_view text, std::span<BitModel> models);

/// The same for weights: four digits each, signed, in 1/4096.
bool apply_weight_priors(std::string_view text, std::span<std::int32_t> weights);

}  // namespace curlidar
