// SPDX-License-Identifier: BSD-3-Clause
// From full scans to a density profile.
#pragma once

#include <cstddef>
#include <span>

#include "dense/density_profile.hpp"
#include "density/boost.hpp"
#include "density/row_scan.hpp"

namespace curlidar::density {

/// Which rows are given, from the top.
struct GivenRows {
  std::size_t first = 0, every = 1;
};

/// The tables of a profile. There must be a scan, and all must have the same rows.
DensityProfile fit_tables(std::span<const RowScan> scans, const GivenRows& given);

struct TreeSettings {
  std::size_t return_trees = 40, residual_trees = 0;  ///< 0: none
  std::size_t depth = 5, residual_depth = 5;
  double residual_damping = 100;
  std::size_t every = 4;  ///< every so-manieth cell is a sample
};

/// Adds trees for returns and residuals to a profile with tables.
void fit_trees(std::span<const RowScan> scans, const TreeSettings& settings,
               DensityProfile& profile, std::size_t threads);

}  // namespace curlidar::density
