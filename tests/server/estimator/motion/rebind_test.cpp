// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/rebind.h"

#include <gtest/gtest.h>

#include "tests/server/estimator/motion/follow_body.h"

namespace coslam::rebind_test {
namespace {

using RebindMoving = FollowBody;

TEST_F(RebindMoving, AFurtherTrackIsFoundByItsLooks) {
  const MapPoint& p = follow_all();
  step(true);
  unbind(kCam1, body_[0]);
  sim_.advance(1, true);
  FollowReport report = follow_moving(sim_.edit, sim_.set, config_);
  rebind_moving(sim_.edit, sim_.set, config_, &report);
  EXPECT_GE(report.bound, 1);
  EXPECT_EQ(track(kCam1, body_[0]).point, p.id);
  const auto bound = events(Why::kLooksLikeIt);
  ASSERT_FALSE(bound.empty());
  EXPECT_GT(bound.back().figures[0], sim_.map.config().zncc_min);
  for (const int i : body_) {
    for (const CameraId c : {kCam0, kCam1}) {
      const MapPoint* q = sim_.map.find(track(c, i).point);
      EXPECT_TRUE(q == nullptr || sim_.world_point(*q) == i) << "of the right point";
    }
  }
}

TEST_F(RebindMoving, ATrackThatLooksLikeAnotherPointOrRestsIsNotTaken) {
  const MapPoint& p = follow(body_[0]);
  step(true);
  unbind(kCam1, body_[0]);
  sim_.edit.set_motion(kCam1, track(kCam1, body_[0]), TrackMotion::kResting);
  FollowReport report;
  rebind_moving(sim_.edit, sim_.set, config_, &report);
  EXPECT_EQ(report.bound, 0) << "it rests";
  sim_.edit.set_motion(kCam1, track(kCam1, body_[0]), TrackMotion::kMoving);
  sim_.look(true);
  sim_.patch_of(kCam1, body_[0])->grey = world_.patch(0);
  sim_.take();
  sim_.place_truly();
  report = follow_moving(sim_.edit, sim_.set, config_);
  rebind_moving(sim_.edit, sim_.set, config_, &report);
  EXPECT_EQ(report.bound, 0) << "another look";
  step(true);
  rebind_moving(sim_.edit, sim_.set, config_, &report);
  EXPECT_EQ(report.bound, 1) << "its own";
  EXPECT_EQ(p.bound.size(), 2U);
}

}  // namespace
}  // namespace coslam::rebind_test
