// SPDX-License-Identifier: BSD-3-Clause
// Files of poses cut at every length and with random damage: motions that can be written and read
// again, or one error.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "hostile/targets/poses.hpp"
#include "support/clouds.hpp"

namespace curlidar {
namespace {

const std::vector<std::string> kTexts = {
    "# a comment\n0 -1 0 1 1 0 0 2 0 0 1 3\n1 0 0 458000.25 0 1 0 -5e6 0 0 1 .1\n",
    "7.5 1 2 3 0 0 0.70710678118654752 0.70710678118654752\n8 1 2 3 0 0 0 -1.0004\r\n",
    "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n\n1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n",
    "qw;qz;qy;qx;\"z\";y;x;note\n.7071067811865475;.7071067811865475;0;0;3;2;1;99\n",
    "time,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n9,1,2,3,0,-1,0,1,0,0,0,0,1\n"};

std::string tried(const std::string& text) {
  return test::poses_target(std::as_bytes(std::span(text)));
}

TEST(HostilePoses, CutAtEveryLength) {
  for (const std::string& text : kTexts) {
    for (std::size_t size = 0; size <= text.size(); ++size) {
      ASSERT_EQ(tried(text.substr(0, size)), "") << text.substr(0, size);
    }
  }
}

TEST(HostilePoses, DamagedAnywhere) {
  // What numbers and lines are made of, so that much of what comes of it is still read.
  constexpr std::string_view kParts = "0123456789+-.eE,; \n\r\"#/xqnaif\xff";
  test::Random random(5);
  for (const std::string& text : kTexts) {
    for (int round = 0; round < 2000; ++round) {
      std::string damaged = text;
      for (std::size_t k = 0; k <= random.below(3); ++k) {
        damaged[random.below(damaged.size())] = kParts[random.below(kParts.size())];
      }
      ASSERT_EQ(tried(damaged), "") << damaged;
    }
  }
}

TEST(HostilePoses, NumbersBeyondAllBounds) {
  for (const char* number : {"1e308", "-1e308", "1e999", "nan", "inf", "1e-320", "0x10", "1e",
                             "99999999999999999999999999999999999999999999999999"}) {
    for (std::size_t at = 0; at < 12; ++at) {
      std::string text;
      for (std::size_t k = 0; k < 12; ++k) {
        text += k == at ? number : (k % 5 == 0 ? "1" : "0");
        text += k == 11 ? '\n' : ' ';
      }
      ASSERT_EQ(tried(text), "") << text;
    }
  }
}

}  // namespace
}  // namespace curlidar
