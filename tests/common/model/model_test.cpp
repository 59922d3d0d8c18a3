// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"
#include "tests/support/sim_tracker.h"
#include "tests/support/sim_world.h"

namespace coslam::model_test {
namespace {

CameraModel camera_of(int width_px, int height_px) {
  CameraModel c = test::sim_camera();
  c.width_px = width_px;
  c.height_px = height_px;
  return c;
}

TEST(PixelScale, IsThePowerOfTwoThatHoldsTwiceTheImage) {
  for (const int width_px : {16, 640, 752, 1280, 1920, 3840, 16384}) {
    const double scale = pixel_scale(camera_of(width_px, 16));
    EXPECT_EQ(std::exp2(std::round(std::log2(scale))), scale);
    EXPECT_LE(2.0 * width_px * scale, 32767) << width_px;
    EXPECT_GT(4.0 * width_px * scale, 32767) << width_px;
    EXPECT_EQ(pixel_scale(camera_of(16, width_px)), scale);  // the longer side counts
  }
}

TEST(QuantisedPx, IsTheNearestGridPointAndAFixedPoint) {
  const double scale = pixel_scale(test::sim_camera());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-600, 1200);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d px(uniform(random), uniform(random));
    const Eigen::Vector2f q = quantised_px(px, scale);
    EXPECT_LE((q.cast<double>() - px).cwiseAbs().maxCoeff(), 0.5 / scale + 1e-12);
    EXPECT_EQ(quantised_px(q.cast<double>(), scale), q);
    const float steps = q.x() * static_cast<float>(scale);
    EXPECT_EQ(steps, std::round(steps));
  }
}

TEST(QuantisedPx, ClampsAndKnowsNoNegativeZero) {
  const double scale = 16;
  EXPECT_EQ(quantised_px({1e9, -1e9}, scale), Eigen::Vector2f(32767.0F / 16, -32767.0F / 16));
  EXPECT_FALSE(std::signbit(quantised_px({-1e-6, -0.0}, scale).x()));
  EXPECT_FALSE(std::signbit(quantised_px({-1e-6, -0.0}, scale).y()));
}

TEST(Covariance, PacksTheUpperTriangle) {
  Eigen::Matrix3d c;
  c << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  const Eigen::Matrix<float, 6, 1> packed = pack_covariance(c);
  EXPECT_EQ(packed, (Eigen::Matrix<float, 6, 1>() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(unpack_covariance(packed), c);
}

TEST(Refusal, IsForOneRunOnly) {
  ServerStatus status;
  status.refused = {{RunId(3), "name taken"}, {RunId(4), "wrong protocol"}};
  EXPECT_EQ(refusal_of(status, RunId(4)), "wrong protocol");
  EXPECT_FALSE(refusal_of(status, RunId(5)));
  EXPECT_FALSE(refusal_of({}, RunId(3)));
}

// What the other tests stand on: the synthetic tracker keeps the rules of a TrackFrame.
TEST(SimTracker, FramesKeepTheRules) {
  const test::SimWorld world({});
  test::SimTracker tracker(world, test::paths_side_by_side(1)[0], {.ends = 0.05}, "cam0", RunId(1));
  const double scale = pixel_scale(test::sim_camera());
  std::uint32_t born_before = 0;
  int ended = 0;
  TrackFrame last;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const TrackFrame f = tracker.observe(FrameId(i), 33'000'000LL * i);
    EXPECT_GT(f.tracks.size(), 80U);
    EXPECT_TRUE(std::is_sorted(f.tracks.begin(), f.tracks.end(),
                               [](const auto& a, const auto& b) { return a.track < b.track; }));
    std::uint32_t newest = born_before;
    for (const TrackObservation& o : f.tracks) {
      EXPECT_EQ(quantised_px(o.undistorted_px.cast<double>(), scale), o.undistorted_px);
      const auto known = std::find_if(last.tracks.begin(), last.tracks.end(),
                                      [&](const TrackObservation& b) { return b.track == o.track; });
      EXPECT_TRUE(known != last.tracks.end() || o.track.value > born_before) << "an ended track came back";
      newest = std::max(newest, o.track.value);
      const Eigen::Vector3d in_cam = tracker.truth(f.capture_ns) * world.position(tracker.point_of(o.track));
      EXPECT_LT((test::sim_camera().project(in_cam) - o.undistorted_px.cast<double>()).norm(), 2.5);
    }
    for (const TrackObservation& b : last.tracks) {
      ended += std::none_of(f.tracks.begin(), f.tracks.end(), [&](const auto& o) { return o.track == b.track; });
    }
    born_before = newest;
    last = f;
  }
  EXPECT_GT(ended, 100);
}

TEST(PatchSteps, AtMostSixteenEachOfAPowerOfTwoAndTwiceIsOnce) {
  std::minstd_rand random(1);
  for (int span = 1; span <= 256; ++span) {
    PatchGrey grey;
    const int low = static_cast<int>(random() % static_cast<unsigned>(257 - span));
    for (auto& v : grey) v = static_cast<std::uint8_t>(low + static_cast<int>(random() % static_cast<unsigned>(span)));
    const int shift = patch_shift(grey);
    const PatchGrey once = quantised_patch(grey);
    EXPECT_EQ(patch_shift(once), shift) << span;
    EXPECT_EQ(quantised_patch(once), once) << span;
    const auto [least, most] = std::minmax_element(once.begin(), once.end());
    EXPECT_LE((*most - *least) >> shift, 15) << span;
    if (span <= 16) {
      EXPECT_EQ(once, grey) << span;
    }
    for (std::size_t i = 0; i < grey.size(); ++i) EXPECT_LE(std::abs(grey[i] - once[i]), (1 << shift) / 2) << span;
  }
}

}  // namespace
}  // namespace coslam::model_test
