// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/co_moving.h"

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <vector>

#include "tests/support/sim_world.h"

// Things that go along with a camera, as the car ahead does. How tracks are judged by it is in evidence_test.cpp.
namespace coslam::co_moving_test {
namespace {

using Eigen::Vector3d;

constexpr double kStep_m = 0.05, kDepth_m = 4, kMost_px = 3;
constexpr MapId kMap(1);

// A camera that moves to the right, 30 images a second, with one track.
class CoMoving : public testing::Test {
 protected:
  CoMoving() {
    camera_.model = test::sim_camera();
    camera_.map = kMap;
    track_.id = TrackId(1);
    track_.motion = TrackMotion::kMoving;
  }
  // So many images; offset_m: of the thing from the camera, in the image of that number.
  void see(std::uint32_t images, const std::function<Vector3d(std::uint32_t image)>& offset_m,
           double step_m = kStep_m) {
    for (std::uint32_t i = 0; i < images; ++i) {
      const Rigid3 pose = test::looking({step_m * i, 0, 0});
      camera_.frames.push_back({.set = SetId(i), .capture_ns = to_ns(i / 30.0), .map = kMap, .cam_from_world = pose});
      track_.seen.push_back({SetId(i), camera_.model.project(offset_m(i)).cast<float>()});
    }
  }
  static Vector3d along(std::uint32_t) { return {0.3, 0.2, kDepth_m}; }
  // As a thing at rest that was there at that image.
  static Vector3d at_rest(std::uint32_t image, std::uint32_t there) {
    return {0.3 - kStep_m * (static_cast<double>(image) - there), 0.2, kDepth_m};
  }
  std::vector<View> views(std::size_t newest) const {
    std::vector<View> out;
    for (std::size_t k = 0; k < newest; ++k) {
      const std::size_t i = track_.seen.size() - 1 - k;
      out.push_back({&camera_.model, camera_.frames[i].cam_from_world, track_.seen[i].undistorted_px.cast<double>()});
    }
    return out;
  }
  bool goes_on(double depth_m = kDepth_m) const { return goes_on_with_camera(track_, views(30), depth_m, kMost_px); }
  std::optional<SetId> since(double depth_m = kDepth_m) const {
    return co_moving_since(camera_, track_, depth_m, config_);
  }

  MapCamera camera_;
  ServerTrack track_;
  const EvidenceConfig config_;
};

TEST_F(CoMoving, ParallaxIsTheWayOfAThingAtTheUsualDepth) {
  see(30, along);
  EXPECT_NEAR(parallax_px(views(30), kDepth_m), 29 * kStep_m / kDepth_m * camera_.model.focal_px(), 1e-6);
  EXPECT_EQ(parallax_px(views(30), 0), 0) << "the depth is not known";
  EXPECT_EQ(parallax_px(views(1), kDepth_m), 0);
}

TEST_F(CoMoving, WhatMovedAndKeepsItsDistanceGoesOn) {
  see(60, along);
  EXPECT_TRUE(goes_on());
  EXPECT_FALSE(goes_on(0)) << "nothing tells how fast others pass by";
  track_.motion = TrackMotion::kResting;
  EXPECT_FALSE(goes_on()) << "far things look like that";
}

TEST_F(CoMoving, WhatStoppedPassesBy) {
  see(60, [](std::uint32_t i) { return at_rest(i, 30); });
  EXPECT_FALSE(goes_on());
}

TEST_F(CoMoving, ACameraThatStandsTellsNothing) {
  see(60, along, 0.0001);
  EXPECT_FALSE(goes_on());
  EXPECT_EQ(since(), std::nullopt);
}

// It turns off within the last second; before that it went along, since it was met.
TEST_F(CoMoving, ItWentAlongSinceItKeptItsDistance) {
  constexpr std::uint32_t kMet = 45, kTurned = 105, kNow = 120;
  see(kNow, [](std::uint32_t i) -> Vector3d {
    if (i < kMet) return at_rest(i, kMet);
    return {0.3, 0.2 + (i < kTurned ? 0 : 0.02 * (i - kTurned)), kDepth_m};
  });
  const auto found = since();
  ASSERT_TRUE(found);
  EXPECT_GE(found->value, kMet - 5) << "but for the last images before, which differ little";
  EXPECT_LE(found->value, kMet + 20) << "time is looked at by halves of a second";
}

TEST_F(CoMoving, ItMayHaveGoneAlongFromTheBeginning) {
  see(90, along);
  EXPECT_EQ(since(), SetId(0));
}

TEST_F(CoMoving, AThingAtRestNeverWentAlong) {
  see(120, [](std::uint32_t i) { return at_rest(i, 60); });
  EXPECT_EQ(since(), std::nullopt);
}

TEST_F(CoMoving, AYoungTrackOrAnUnknownDepthTellsNothing) {
  see(20, along);
  EXPECT_EQ(since(), std::nullopt) << "all of it is of the last second";
  camera_.frames.clear();
  track_.seen.clear();
  see(90, along);
  EXPECT_EQ(since(0), std::nullopt);
}

TEST_F(CoMoving, PosesOfAnotherMapDoNotCount) {
  see(90, along);
  for (std::size_t i = 0; i < 60; ++i) camera_.frames[i].map = MapId(2);
  EXPECT_EQ(since(), std::nullopt);
}

}  // namespace
}  // namespace coslam::co_moving_test
