// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/track_pen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/server/estimator/map/shared_point.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

// Corner cases of verbs on tracks. What each does is in edit_test.cpp and map_points_test.cpp.
namespace coslam::track_pen_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

class TrackPenTest : public test::SharedPointTest {
 protected:
  TrackPenTest() : SharedPointTest(true) { test::forget(edit_.journal()); }
};

TEST_F(TrackPenTest, AMissBehindTheCameraHasNoDistance) {
  sim_.add_point(shared_);
  test::forget(edit_.journal());
  edit_.miss_gate(kCam0, track(kCam0), std::numeric_limits<double>::quiet_NaN());
  edit_.miss_gate(kCam1, track(kCam1), 5);
  const std::vector<Event>& events = edit_.journal().events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].why, Why::kBehindCamera);
  EXPECT_EQ(events[1].why, Why::kOutsideGate);
}

TEST_F(TrackPenTest, ATrackThatIsBoundAgainStartsAnew) {
  const MapPoint &p = sim_.create({0, 0, 5}), &q = sim_.create({0, 0, 6});
  sim_.bind(p, kCam0, track(kCam0));
  edit_.miss_gate(kCam0, track(kCam0), 4);
  edit_.unbind(kCam0, track(kCam0), Why::kOutsideGate);
  EXPECT_EQ(track(kCam0).gate_failures, 0);
  EXPECT_TRUE(sim_.map.untracked_points().contains(p.id));
  sim_.bind(q, kCam0, track(kCam0));
  EXPECT_FALSE(sim_.map.untracked_points().contains(q.id));
  EXPECT_EQ(track(kCam0).point, q.id);
  test::expect_consistent(sim_.map);
}

TEST_F(TrackPenTest, APointIsUntrackedWhenItsLastTrackEnds) {
  const MapPoint& p = sim_.add_point(shared_);
  ASSERT_EQ(p.bound.size(), 2U);
  edit_.unbind(kCam0, track(kCam0), Why::kStray);
  EXPECT_FALSE(sim_.map.untracked_points().contains(p.id));
  const TrackId other = track(kCam1).id;
  sim_.look();
  std::erase_if(sim_.set.frames[1].frame.tracks, [&](const TrackObservation& o) { return o.track == other; });
  sim_.take();
  EXPECT_TRUE(p.bound.empty());
  EXPECT_TRUE(sim_.map.untracked_points().contains(p.id));
}

TEST_F(TrackPenTest, ABoundTrackBringsItsPatchAndWhereThePointIsInIt) {
  const MapPoint& p = sim_.create({0, 0, 5}, 0.01, PointPhase::kMoving);
  edit_.bind_moving(p, kCam0, track(kCam0), {2, -1}, Why::kLooksLikeIt, {0.9, 0});
  ASSERT_EQ(p.patches.size(), 1U);
  EXPECT_EQ(p.patches[0].camera, kCam0);
  EXPECT_EQ(p.patches[0].set, sim_.set.id);
  EXPECT_EQ(p.patches[0].offset_px, Eigen::Vector2f(2, -1));
  EXPECT_EQ(p.patches[0].pixels, *track(kCam0).patch);
}

TEST_F(TrackPenTest, AMotionThatIsLessHasAStaticPlace) {
  edit_.set_motion(kCam0, track(kCam0), TrackMotion::kMoving, {3, 1});
  edit_.set_motion(kCam0, track(kCam0), TrackMotion::kDoubtful, {1, 2});
  edit_.set_motion(kCam0, track(kCam0), TrackMotion::kDoubtful, {1, 2});
  const std::vector<Event>& events = edit_.journal().events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].why, Why::kNoStaticPlace);
  EXPECT_EQ(events[0].to, static_cast<std::uint8_t>(TrackMotion::kMoving));
  EXPECT_EQ(events[1].why, Why::kStaticPlace);
  EXPECT_EQ(events[1].figures, (Figures{1, 2}));
}

TEST_F(TrackPenTest, AnEndTellsHowLongItWasFollowed) {
  const std::size_t sets = track(kCam0).seen.size();
  sim_.add_point(shared_);
  test::forget(edit_.journal());
  edit_.restart_camera(kCam0, RunId(9), test::sim_camera());
  const auto& events = edit_.journal().events();
  const auto end = std::ranges::find_if(
      events, [](const Event& e) { return e.kind == EventKind::kTrackEnded && e.point != PointId(); });
  ASSERT_NE(end, events.end());
  EXPECT_EQ(end->why, Why::kRestarted);
  EXPECT_EQ(end->figures[0], static_cast<double>(sets));
}

}  // namespace
}  // namespace coslam::track_pen_test
