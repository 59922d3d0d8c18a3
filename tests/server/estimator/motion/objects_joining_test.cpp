// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/objects_joining.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "server/estimator/motion/objects.h"

// Which moving points become one object, by exact paths. Bodies with noise are in objects_test.cpp.
namespace coslam::objects_joining_test {
namespace {

using Eigen::Vector3d;

constexpr double kReach = 0.9;

class ObjectsJoining : public testing::Test {
 protected:
  using Place = std::function<Vector3d(double t_s)>;
  // A point that was seen for the last second, in all sets or in each other one.
  void add(const Place& place, int every = 1, int from = 0) {
    MovingPoint p{PointId(static_cast<std::uint32_t>(points_.size() + 1)), MapId(1), {}, 0.05, kReach};
    for (int i = from; i < 30; i += every) {
      p.path.push_back({SetId(static_cast<std::uint32_t>(i)), to_ns(i / 30.0), place(i / 30.0)});
    }
    points_.push_back(p);
  }
  // Four points around a place that moves along x, where it is at half of the second.
  void add_body(const Vector3d& middle, double speed) {
    for (const double side : {-0.1, 0.1}) {
      for (const double up : {-0.1, 0.1}) {
        add([=](double t_s) -> Vector3d { return middle + Vector3d(speed * (t_s - 0.5), side, up); });
      }
    }
  }
  // How many points each object has.
  std::vector<std::size_t> sizes() {
    Objects finder{ObjectsConfig()};
    finder.step(points_, to_ns(29 / 30.0));
    std::vector<std::size_t> out;
    for (const MovingObject& o : finder.objects()) out.push_back(o.members.size());
    std::ranges::sort(out);
    return out;
  }

  std::vector<MovingPoint> points_;
};

using Sizes = std::vector<std::size_t>;

TEST_F(ObjectsJoining, ALongBodyIsOneThoughItsEndsAreFarApart) {
  for (int i = 0; i < 8; ++i) {
    add([=](double t_s) -> Vector3d { return {t_s + 0.5 * i, 0, 0}; });
  }
  EXPECT_EQ(sizes(), Sizes{8}) << "each is near the next";
}

TEST_F(ObjectsJoining, AGapThatIsWiderThanTheReachParts) {
  add_body({0, 0, 0}, 1);
  add_body({0, 0.2 + 1.1 * kReach, 0}, 1);
  EXPECT_EQ(sizes(), (Sizes{4, 4}));
}

TEST_F(ObjectsJoining, PointsThatWereNeverSeenAtOneInstantAreNotCompared) {
  for (const int from : {0, 1}) {
    for (int i = 0; i < 3; ++i) {
      add([=](double t_s) -> Vector3d { return {t_s, 0.1 * i, 0}; }, 2, from);
    }
  }
  EXPECT_EQ(sizes(), (Sizes{3, 3}));
}

TEST_F(ObjectsJoining, ALimbThatSwingsALittleHangsOnItsBody) {
  const auto limb = [](double swing) {
    return [swing](double t_s) -> Vector3d { return {t_s, 0.5 + swing * std::sin(6 * t_s), 0}; };
  };
  add_body({0.5, 0, 0}, 1);
  add(limb(0.05));
  EXPECT_EQ(sizes(), Sizes{5});
  points_.pop_back();
  add(limb(0.35));
  EXPECT_EQ(sizes(), Sizes{4});
}

TEST_F(ObjectsJoining, BodiesThatPassEachOtherAreTwo) {
  add_body({0, 0, 0}, 1);
  add_body({0, 0.5, 0}, 1.9);
  EXPECT_EQ(sizes(), (Sizes{4, 4}));
}

TEST_F(ObjectsJoining, PartsThatHardlyShiftAreOne) {
  add_body({0, 0, 0}, 1);
  add_body({0, 0.5, 0}, 1.2);
  EXPECT_EQ(sizes(), Sizes{8});
}

TEST_F(ObjectsJoining, OnePairThatKeepsItsDistanceByChanceJoinsNoBodies) {
  add_body({0, 0, 0}, 1);
  add_body({0, 0.5, 0}, -1);
  add([](double t_s) -> Vector3d { return {t_s - 0.5, 0.15, 0}; });  // of the first
  add([](double t_s) -> Vector3d { return {0.5 - t_s, 0.35, 0}; });  // of the second
  EXPECT_EQ(sizes(), (Sizes{5, 5}));
}

}  // namespace
}  // namespace coslam::objects_joining_test
