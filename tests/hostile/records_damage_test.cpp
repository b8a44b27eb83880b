// SPDX-License-Identifier: BSD-3-Clause
// Chunks of order and attributes with their ends cut off, bytes changed, or nothing but noise.
#include <gtest/gtest.h>

#include <random>

#include "hostile/targets/records.hpp"
#include "support/record_chunks.hpp"

namespace curlidar {
namespace {

using Target = std::string (*)(ByteSpan);

/// Every cut, and a few changes of every byte.
void damage(Target target, const std::vector<std::byte>& bytes) {
  ASSERT_EQ(target(bytes), "");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_EQ(target(ByteSpan(bytes).first(size)), "") << "cut to " << size;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const unsigned change : {0x01u, 0x80u, 0xffu}) {
      std::vector<std::byte> damaged = bytes;
      damaged[i] ^= static_cast<std::byte>(change);
      ASSERT_EQ(target(damaged), "") << "byte " << i << " changed by " << change;
    }
  }
}

TEST(RecordsDamage, Order) {
  for (const auto& [name, bytes] : test::order_inputs()) {
    SCOPED_TRACE(name);
    damage(test::order_target, bytes);
  }
}

TEST(RecordsDamage, Attributes) {
  for (const auto& [name, bytes] : test::records_inputs()) {
    SCOPED_TRACE(name);
    damage(test::records_target, bytes);
  }
}

TEST(RecordsDamage, Noise) {
  std::mt19937 random(21);
  for (const Target target : {&test::order_target, &test::records_target}) {
    for (int round = 0; round < 300; ++round) {
      std::vector<std::byte> bytes(random() % 80);
      for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 0xff);
      ASSERT_EQ(target(bytes), "") << "noise " << round;
    }
  }
}

}  // namespace
}  // namespace curlidar
