// SPDX-License-Identifier: BSD-3-Clause
#include "base/bvh.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace curlidar {
namespace {

std::vector<Bounds> random_boxes(std::size_t count) {
  std::mt19937 engine(3);
  const auto draw = [&] { return static_cast<double>(engine()) / 4294967296.0; };
  std::vector<Bounds> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 low{10 * draw(), 10 * draw(), 10 * draw()};
    boxes.push_back({low, low + Vec3{draw(), draw(), draw()}});
  }
  return boxes;
}

double distance_to(const Bounds& box, const Vec3& p) {
  const auto outside = [](double low, double high, double x) {
    return std::max({low - x, x - high, 0.0});
  };
  return norm({outside(box.low.x, box.high.x, p.x), outside(box.low.y, box.high.y, p.y),
               outside(box.low.z, box.high.z, p.z)});
}

TEST(Bvh, AroundAPointLiesWhatIsNear) {
  const std::vector<Bounds> boxes = random_boxes(500);
  const Bvh tree(boxes);
  for (int n = 0; n < 100; ++n) {
    const Vec3 p{0.13 * n, 11 - 0.1 * n, 0.7 * (n % 17)};
    std::set<std::uint32_t> seen;
    tree.around(p, 1.5, [&](std::uint32_t i, double&) { seen.insert(tree.order()[i]); });
    double nearest = 1e300;
    tree.around(p, 1e300, [&](std::uint32_t i, double& reach) {
      reach = nearest = std::min(nearest, distance_to(boxes[tree.order()[i]], p));
    });
    double expected = 1e300;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const double d = distance_to(boxes[i], p);
      expected = std::min(expected, d);
      EXPECT_TRUE(d >= 1.5 || seen.contains(i)) << i;
    }
    EXPECT_EQ(nearest, expected);
  }
}

TEST(Bvh, NothingIsAroundWhereNothingIs) {
  const Bvh empty;
  empty.around({}, 1, [](std::uint32_t, double&) { ADD_FAILURE(); });
  const Bvh tree(std::vector<Bounds>{{{0, 0, 0}, {1, 1, 1}}});
  tree.around({5, 0, 0}, 3.9, [](std::uint32_t, double&) { ADD_FAILURE(); });
  int visits = 0;
  tree.around({5, 0, 0}, 4.1, [&](std::uint32_t, double&) { ++visits; });
  EXPECT_EQ(visits, 1);
}

}  // namespace
}  // namespace curlidar
