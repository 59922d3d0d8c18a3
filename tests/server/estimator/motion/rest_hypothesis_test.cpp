// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/rest_hypothesis.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <vector>

#include "tests/support/sim_world.h"

namespace coslam::rest_hypothesis_test {
namespace {

using Eigen::Vector3d;

constexpr double kStep_m = 0.1, kMost_px = 3, kNearest = 0.3;
constexpr std::size_t kViews = 12;

class RestHypothesis : public testing::Test {
 protected:
  // Views of one track of a camera that moves to the right, the newest first; place_m: of the thing, so many images
  // ago.
  std::vector<View> views(const std::function<Vector3d(int ago)>& place_m, double noise_px = 0.4) {
    std::normal_distribution<double> normal(0, noise_px);
    std::vector<View> out;
    for (int ago = 0; ago < static_cast<int>(kViews); ++ago) {
      View v{&camera_, test::looking({-kStep_m * ago, 0, 0}), {}};
      v.undistorted_px =
          camera_.project(v.cam_from_world * place_m(ago)) + Eigen::Vector2d(normal(random_), normal(random_));
      out.push_back(v);
    }
    return out;
  }
  static bool moves(const std::vector<View>& views, std::size_t frames = kViews - 1, double nearest = kNearest) {
    return moves_by_more(views, frames, nearest, kMost_px);
  }

  const CameraModel camera_ = test::sim_camera();
  std::mt19937_64 random_{4};
};

TEST_F(RestHypothesis, WhatIsInfinitelyFarHasOneDirection) {
  EXPECT_LT(far_miss_px(views([](int) { return Vector3d(1e5, 2e5, 1e6); })), 3) << "but for noise";
  const double near_px = far_miss_px(views([](int) { return Vector3d(0, 0.2, 4); }, 0));
  const double passed_px = kStep_m * (kViews - 1) / 4 * camera_.fx;
  EXPECT_GT(near_px, 0.4 * passed_px);
  EXPECT_LT(near_px, 0.6 * passed_px) << "half of the way to either side";
}

TEST_F(RestHypothesis, NothingFarIsBeforeCamerasThatLookApart) {
  std::vector<View> all = views([](int) { return Vector3d(0, 0, 5); });
  for (std::size_t i = 0; i < 3; ++i) all[i].cam_from_world = test::looking({0, 0, 0}, 3.0);
  EXPECT_GT(far_miss_px(all), 1e6);
}

TEST_F(RestHypothesis, AThingAtRestRestsAtWhateverDistance) {
  for (const double depth_m : {1.0, 3.0, 10.0, 100.0, 1e4, 1e7}) {
    for (int i = 0; i < 10; ++i) {
      EXPECT_FALSE(moves(views([&](int) { return Vector3d(-0.1 * depth_m, 0.05 * i * depth_m, depth_m); })))
          << depth_m << ' ' << i;
    }
  }
}

TEST_F(RestHypothesis, WhatMovesAcrossTheWayOfTheCameraMoves) {
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(moves(views([](int ago) { return Vector3d(0, 0.3 - 0.02 * ago, 4); })));
  }
}

// Along the way of the camera, motion looks like another distance.
TEST_F(RestHypothesis, WhatComesTowardsTheCameraIsTooNearForAThingAtRest) {
  const auto oncoming = views([](int ago) { return Vector3d(0.4 + 2 * kStep_m * ago, 0.2, 4); });
  EXPECT_FALSE(moves(oncoming, kViews - 1, 0.1)) << "as something at a third of its distance";
  EXPECT_TRUE(moves(oncoming, kViews - 1, 2.5)) << "where nothing at rest is nearer than 2.5";
  const auto overtaken = views([](int ago) { return Vector3d(-2 * kStep_m * ago, 0.2, 4); });
  EXPECT_TRUE(moves(overtaken)) << "nothing is farther than infinitely far";
}

TEST_F(RestHypothesis, OnlyTheNewestViewsCount) {
  const auto stopped = views([](int ago) { return Vector3d(0, ago < 6 ? 0.3 : 0.3 - 0.05 * (ago - 5), 4); });
  EXPECT_FALSE(moves(stopped, 5));
  EXPECT_TRUE(moves(stopped, kViews - 1));
  EXPECT_TRUE(moves(stopped, 1000)) << "more than there are";
}

TEST_F(RestHypothesis, OneViewContradictsNothing) {
  std::vector<View> one = views([](int) { return Vector3d(0, 0, 4); });
  one.resize(1);
  EXPECT_FALSE(moves(one));
}

TEST_F(RestHypothesis, ACameraThatOnlyTurnsSeesWhetherAThingMoves) {
  const auto turning = [&](double speed_m) {
    std::vector<View> out;
    for (int ago = 0; ago < static_cast<int>(kViews); ++ago) {
      View v{&camera_, test::looking({0, 0, 0}, 0.02 * ago), {}};
      v.undistorted_px = camera_.project(v.cam_from_world * Vector3d(speed_m * ago, 0, 4));
      out.push_back(v);
    }
    return out;
  };
  EXPECT_FALSE(moves(turning(0)));
  EXPECT_TRUE(moves(turning(0.05)));
}

}  // namespace
}  // namespace coslam::rest_hypothesis_test
