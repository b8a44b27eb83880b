// SPDX-License-Identifier: BSD-3-Clause
#include "format/parameters_chunk.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/chunks.hpp"

namespace curlidar {
namespace {

using test::chunk_of;

/// Settings of which no two are equal, so that a swapped pair shows.
Parameters odd_parameters() {
  Parameters p;
  p.profile = Profile::paper_1to1;
  p.paper.row_rule = RowRule::rings;
  p.paper.rows = 1001;
  p.paper.columns = 1002;
  p.paper.min_range_m = 0.1;
  p.paper.max_range = {0.2, 0.3};
  p.paper.outlier_radius_m = 0.4;
  p.paper.outlier_min_points = 1003;
  p.paper.upsample_rows = 1004;
  p.paper.upsample_columns = 1005;
  p.paper.refused_triangle_share = 0.5;
  p.paper.cliffs = {0.6, 0.7, 0.8};
  p.paper.patch = 1006;
  p.paper.overlap = 1007;
  p.paper.max_degree = std::numeric_limits<std::uint32_t>::max();
  p.paper.accept_m = 0.9;
  p.paper.reject_m = 1.1;
  p.paper.k = -1.2e-300;
  p.paper.stop_on_total_error = false;
  p.paper.global_degree = 1008;
  p.paper.global_reject_m = 1.3;
  return p;
}

void expect_equal(const Parameters& a, const Parameters& b) {
  EXPECT_EQ(a.profile, b.profile);
  EXPECT_EQ(a.paper.row_rule, b.paper.row_rule);
  EXPECT_EQ(a.paper.rows, b.paper.rows);
  EXPECT_EQ(a.paper.columns, b.paper.columns);
  EXPECT_EQ(a.paper.min_range_m, b.paper.min_range_m);
  EXPECT_EQ(a.paper.max_range.metres, b.paper.max_range.metres);
  EXPECT_EQ(a.paper.max_range.percentile, b.paper.max_range.percentile);
  EXPECT_EQ(a.paper.outlier_radius_m, b.paper.outlier_radius_m);
  EXPECT_EQ(a.paper.outlier_min_points, b.paper.outlier_min_points);
  EXPECT_EQ(a.paper.upsample_rows, b.paper.upsample_rows);
  EXPECT_EQ(a.paper.upsample_columns, b.paper.upsample_columns);
  EXPECT_EQ(a.paper.refused_triangle_share, b.paper.refused_triangle_share);
  EXPECT_EQ(a.paper.cliffs.row_m, b.paper.cliffs.row_m);
  EXPECT_EQ(a.paper.cliffs.column_m, b.paper.cliffs.column_m);
  EXPECT_EQ(a.paper.cliffs.diagonal_m, b.paper.cliffs.diagonal_m);
  EXPECT_EQ(a.paper.patch, b.paper.patch);
  EXPECT_EQ(a.paper.overlap, b.paper.overlap);
  EXPECT_EQ(a.paper.max_degree, b.paper.max_degree);
  EXPECT_EQ(a.paper.accept_m, b.paper.accept_m);
  EXPECT_EQ(a.paper.reject_m, b.paper.reject_m);
  EXPECT_EQ(a.paper.k, b.paper.k);
  EXPECT_EQ(a.paper.stop_on_total_error, b.paper.stop_on_total_error);
  EXPECT_EQ(a.paper.global_degree, b.paper.global_degree);
  EXPECT_EQ(a.paper.global_reject_m, b.paper.global_reject_m);
}

TEST(ParametersChunk, RoundTripsEveryField) {
  for (const Parameters& parameters : {Parameters{}, odd_parameters()}) {
    const auto payload = write_parameters(parameters);
    const auto back = read_parameters(chunk_of(ChunkType::parameters, payload));
    ASSERT_TRUE(back) << back.error().message;
    expect_equal(*back, parameters);
  }
}

TEST(ParametersChunk, RefusesUnknownNamesAndNumbersThatAreNone) {
  const auto refused = [](std::vector<std::byte> payload, ErrorCode code) {
    const auto back = read_parameters(chunk_of(ChunkType::parameters, payload));
    return !back && back.error().code == code;
  };
  const auto good = write_parameters({});
  auto payload = good;
  payload[0] = std::byte{3};  // profile
  EXPECT_TRUE(refused(payload, ErrorCode::unsupported));
  payload = good;
  payload[1] = std::byte{2};  // row rule
  EXPECT_TRUE(refused(payload, ErrorCode::corrupt));
  Parameters not_finite;
  not_finite.paper.k = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused(write_parameters(not_finite), ErrorCode::corrupt));
  payload = good;
  payload.pop_back();
  EXPECT_TRUE(refused(payload, ErrorCode::corrupt));
  payload = good;
  payload.push_back(std::byte{0});
  EXPECT_TRUE(refused(payload, ErrorCode::corrupt));
}

}  // namespace
}  // namespace curlidar
