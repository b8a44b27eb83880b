// SPDX-License-Identifier: BSD-3-Clause
#include "base/utf8.hpp"

#include <gtest/gtest.h>

#include <string>

namespace curlidar {
namespace {

TEST(Utf8, TakesEveryLength) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("plain"));
  EXPECT_TRUE(is_utf8(std::string_view("\0", 1)));
  EXPECT_TRUE(is_utf8("\x7f\xc2\x80\xdf\xbf"));                              // up to U+07FF
  EXPECT_TRUE(is_utf8("\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xef\xbf\xbf"));  // around surrogates
  EXPECT_TRUE(is_utf8("\xf0\x90\x80\x80\xf4\x8f\xbf\xbf"));                  // U+10000, U+10FFFF
}

TEST(Utf8, RefusesWhatRfc3629Excludes) {
  EXPECT_FALSE(is_utf8("\x80"));          // continuation first
  EXPECT_FALSE(is_utf8("\xc3"));          // cut off
  EXPECT_FALSE(is_utf8("\xe2\x82"));      // cut off
  EXPECT_FALSE(is_utf8("\xf0\x9f\x98"));  // cut off
  EXPECT_FALSE(is_utf8("\xc3("));         // no continuation
  EXPECT_FALSE(is_utf8("\xe2\x82("));     // no continuation in third place
  EXPECT_FALSE(is_utf8("\xc0\xaf"));      // overlong, 2 bytes
  EXPECT_FALSE(is_utf8("\xc1\xbf"));
  EXPECT_FALSE(is_utf8("\xe0\x9f\xbf"));      // overlong, 3 bytes
  EXPECT_FALSE(is_utf8("\xf0\x8f\xbf\xbf"));  // overlong, 4 bytes
  EXPECT_FALSE(is_utf8("\xed\xa0\x80"));      // surrogate
  EXPECT_FALSE(is_utf8("\xf4\x90\x80\x80"));  // above U+10FFFF
  EXPECT_FALSE(is_utf8("\xf5\x80\x80\x80"));
  EXPECT_FALSE(is_utf8("good \xff bad"));
}

}  // namespace
}  // namespace curlidar
