// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/session_pen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "common/model/rig.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

// Cameras of a rig, what frames hold, and times. Tracks and restarts are in map_test.cpp and edit_test.cpp.
namespace coslam::session_pen_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

TEST(SessionRig, CamerasAreOfItByTheirNames) {
  const Rigid3 right_from_left(Eigen::Quaterniond::Identity(), {-0.3, 0, 0});
  MapConfig config;
  config.rigs = {text_of({"right", "left", right_from_left}), text_of({"tail", "nose", right_from_left})};
  MapEdit edit(config);
  for (const char* name : {"right", "alone", "left", "nose"}) edit.add_camera(name, RunId(1), test::sim_camera());
  const auto& cameras = edit.map().cameras();
  EXPECT_EQ(cameras[0].rig, "left");
  EXPECT_EQ(cameras[0].cam_from_rig.translation, right_from_left.translation);
  EXPECT_EQ(cameras[1].rig, "");
  EXPECT_EQ(cameras[2].rig, "left");
  EXPECT_EQ(cameras[2].cam_from_rig.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(edit.map().rig_mates(cameras[0]), std::vector({CameraId(2)}));
  EXPECT_TRUE(edit.map().rig_mates(cameras[1]).empty());
  EXPECT_TRUE(edit.map().rig_mates(cameras[3]).empty()) << "its other one is not there";
}

class SessionPenTest : public testing::Test {
 protected:
  SessionPenTest() { sim_.advance(6); }
  const MapCamera& camera(CameraId id) const { return sim_.map.camera(id); }
  // Part of the image that a track was in at a set; 8 parts across and 6 down.
  std::pair<int, int> part_of(const Eigen::Vector2f& px) const {
    const CameraModel& model = camera(kCam0).model;
    return {std::clamp(static_cast<int>(px.x() * 8 / static_cast<float>(model.width_px)), 0, 7),
            std::clamp(static_cast<int>(px.y() * 6 / static_cast<float>(model.height_px)), 0, 5)};
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  MapEdit& edit_ = sim_.edit;
};
using SessionPenDeathTest = SessionPenTest;

TEST_F(SessionPenDeathTest, FrameSetsComeInOrder) {
  FrameSet again = sim_.set;
  EXPECT_DEATH(edit_.ingest(again), "frame sets come in order");
}

TEST_F(SessionPenTest, AFrameHoldsTheOldestTrackOfEachPartOfTheImage) {
  sim_.advance(20);
  for (const MapCamera& c : sim_.map.cameras()) {
    std::set<std::pair<int, int>> parts, with_tracks;
    for (const auto& [id, t] : c.tracks) with_tracks.insert(part_of(t.seen.back().undistorted_px));
    for (const HeldTrack& h : c.frames.back().held) {
      EXPECT_TRUE(parts.insert(part_of(h.undistorted_px)).second) << "one of each";
      const SetId began = c.tracks.at(h.track).seen.front().set;
      for (const auto& [id, t] : c.tracks) {
        const bool beside = part_of(t.seen.back().undistorted_px) == part_of(h.undistorted_px);
        EXPECT_TRUE(!beside || t.seen.front().set >= began) << id.value;
      }
    }
    EXPECT_EQ(parts, with_tracks);
  }
}

TEST_F(SessionPenTest, ACameraWithoutTracksHasAFrameThatHoldsNothing) {
  sim_.look();
  sim_.set.frames[0].frame.tracks.clear();
  sim_.take();
  EXPECT_TRUE(camera(kCam0).tracks.empty());
  EXPECT_EQ(camera(kCam0).frames.back().set, sim_.set.id);
  EXPECT_TRUE(camera(kCam0).frames.back().held.empty());
  EXPECT_FALSE(camera(kCam1).frames.back().held.empty());
}

TEST_F(SessionPenTest, SetsInWhichNothingWasSeenCount) {
  const MapPoint& p = sim_.create({0, 0, 5});
  EXPECT_EQ(sim_.map.recent_points().size(), 1U);
  const std::uint32_t sets = sim_.map.sets_in(sim_.map.config().recent_s);
  edit_.pass_sets(sets);
  EXPECT_TRUE(sim_.map.is_recent(p.last_seen));
  edit_.pass_sets(1);
  EXPECT_FALSE(sim_.map.is_recent(p.last_seen));
  EXPECT_EQ(sim_.map.now(), SetId(5 + sets + 1));
  EXPECT_EQ(sim_.map.now_ns(), sim_.set.t_ns) << "how long it took is not known";
}

TEST_F(SessionPenTest, AllTimesAreShiftedTogether) {
  sim_.add_points();
  sim_.ingest();  // a set without poses
  const PointId moving = sim_.create({0, 0, 5}, 0.01, PointPhase::kMoving).id;
  edit_.record_motion(moving, {sim_.set.id, sim_.set.t_ns, {}});
  sim_.advance(3);
  edit_.take_frames(camera(kCam0), SetId(8), {});
  ASSERT_EQ(camera(kCam0).past.lost.size(), 1U);
  const MapEdit before = edit_;
  const double interval_s = sim_.map.set_interval_s();
  constexpr TimeNs kBy_ns = 123'456'789'012;
  edit_.shift_times(kBy_ns);
  EXPECT_EQ(sim_.map.now_ns(), before.map().now_ns() + kBy_ns);
  EXPECT_EQ(sim_.map.shifted_ns(), kBy_ns);
  const MapCamera &now = camera(kCam0), &then = before.map().camera(kCam0);
  for (std::size_t i = 0; i < now.frames.size(); ++i) {
    EXPECT_EQ(now.frames[i].capture_ns, then.frames[i].capture_ns + kBy_ns);
  }
  EXPECT_EQ(now.past.first_ns, then.past.first_ns + kBy_ns);
  EXPECT_EQ(now.past.lost[0].first, then.past.lost[0].first + kBy_ns);
  EXPECT_EQ(now.past.lost[0].second, then.past.lost[0].second + kBy_ns);
  for (const auto& [id, p] : sim_.map.points()) {
    EXPECT_EQ(p.first_ns, before.map().find(id)->first_ns + kBy_ns);
    EXPECT_EQ(p.last_ns, before.map().find(id)->last_ns + kBy_ns);
  }
  EXPECT_EQ(sim_.map.motions().at(moving)[0].t_ns, before.map().motions().at(moving)[0].t_ns + kBy_ns);
  edit_.shift_times(-kBy_ns);
  test::expect_same(sim_.map, before.map());
  sim_.advance(1);
  EXPECT_DOUBLE_EQ(sim_.map.set_interval_s(), interval_s);
}

TEST_F(SessionPenTest, TheRateIsKnownAcrossAShift) {
  edit_.shift_times(to_ns(1e6));
  sim_.look();
  sim_.set.t_ns += to_ns(1e6);
  for (CameraFrame& cf : sim_.set.frames) cf.frame.capture_ns += to_ns(1e6);
  sim_.take();
  EXPECT_NEAR(sim_.map.set_interval_s(), 1.0 / 30, 1e-6);
  EXPECT_NEAR(camera(kCam0).frame_interval_s, 1.0 / 30, 1e-6);
}

TEST_F(SessionPenTest, ARunBeginsWithTheNextSet) {
  edit_.restart_camera(kCam0, RunId(9), test::sim_camera());
  EXPECT_EQ(camera(kCam0).run_since, SetId(sim_.map.now().value + 1));
  EXPECT_EQ(camera(kCam1).run_since, SetId(0));
}

}  // namespace
}  // namespace coslam::session_pen_test
