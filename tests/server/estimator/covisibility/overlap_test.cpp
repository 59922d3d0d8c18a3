// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/covisibility/overlap.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam::overlap_test {
namespace {

CameraId cam(int i) { return CameraId(static_cast<std::uint16_t>(i)); }

// Two cameras that stand still; every point has its own id in each, so that they share none.
class OverlapTest : public testing::Test {
 protected:
  OverlapShares between(const Rigid3& first, const Rigid3& second) {
    test::SimMap sim(world_, {test::still_path(first), test::still_path(second)});
    sim.advance();
    for (int c = 0; c < 2; ++c) {
      for (const auto& [id, t] : sim.map.camera(cam(c)).tracks) {
        sim.bind(sim.create(world_.position(sim.world_point(cam(c), id))), cam(c), t);
      }
    }
    change(sim);
    return ViewOverlap(sim.map).between(cam(0), cam(1));
  }
  virtual void change(test::SimMap& /*sim*/) {}
  const test::SimWorld world_{{}};
};

TEST_F(OverlapTest, SideBySideTheySeeTheSame) {
  const OverlapShares s = between(test::looking({-0.1, 0, 0}), test::looking({0.1, 0, 0}));
  EXPECT_GT(s.least(), 0.8);
}

TEST_F(OverlapTest, TurnedAwayLessAndThenNothing) {
  const OverlapShares half = between(test::looking({0, 0, 0}), test::looking({0, 0, 0}, 0.65));
  EXPECT_GT(half.least(), 0.2);
  EXPECT_LT(half.least(), 0.7);
  EXPECT_EQ(between(test::looking({0, 0, 0}), test::looking({0, 0, 0}, 1.5)).least(), 0);
}

// What the second camera follows is much nearer: it stands before a wall that hides the rest.
class HiddenOverlapTest : public OverlapTest {
  void change(test::SimMap& sim) override {
    const Eigen::Vector3d center = sim.truth(cam(1), sim.set.id).center();
    for (const auto& [id, t] : sim.map.camera(cam(1)).tracks) {
      const MapPoint& p = *sim.map.find(t.point);
      sim.shift(p, -0.7 * (p.position - center));
    }
  }
};

TEST_F(HiddenOverlapTest, NearerThingsHideTheRest) {
  EXPECT_LT(between(test::looking({0, 0, 0}), test::looking({0, 0, 0})).least(), 0.05);
}

class OtherMapOverlapTest : public OverlapTest {
  void change(test::SimMap& sim) override {
    sim.place(cam(1), sim.edit.new_map(Why::kStartedAlone, 1), sim.truth(cam(1), sim.set.id));
  }
};

TEST_F(OtherMapOverlapTest, NothingIsKnownOfOtherMaps) {
  EXPECT_EQ(between(test::looking({0, 0, 0}), test::looking({0, 0, 0})).least(), 0);
}

// A camera of three times the focal length looks at the middle of what the other one sees.
TEST(OverlapOfLenses, AllThatALongLensCanShowOfAWideOnesViewIsTheWhole) {
  MapEdit edit{MapConfig{}};
  const MapId map = edit.new_map(Why::kStartedTogether, 2);
  FrameSet set{SetId(0), 0, {}};
  std::vector<Eigen::Vector3d> points;
  for (int y = -30; y <= 30; ++y) {
    for (int x = -40; x <= 40; ++x) points.emplace_back(0.1 * x, 0.1 * y, 5);
  }
  for (const int times : {1, 3}) {
    CameraModel model = test::sim_camera();
    model.fx *= times, model.fy *= times;
    const CameraId c = edit.add_camera(times == 1 ? "wide" : "long", RunId(static_cast<std::uint64_t>(times)), model);
    CameraFrame cf{c, {}, {}, {}};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d px = model.project(points[i]);
      if (!model.contains_raw(px)) continue;
      cf.frame.tracks.push_back({TrackId(static_cast<std::uint32_t>(i + 1)), px.cast<float>()});
    }
    set.frames.push_back(std::move(cf));
  }
  edit.ingest(set);
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = edit.map().camera(cf.camera);
    edit.place(camera, set.id, map, Rigid3(), Why::kStartedTogether);
    for (const auto& [id, t] : camera.tracks) {
      const MapPoint& p = edit.create_point(map, points[id.value - 1], 1e-4 * Eigen::Matrix3d::Identity(),
                                            PointPhase::kStatic, Why::kStartOfMap, {2, 0});
      edit.bind(p, cf.camera, t, Why::kMadeFromIt);
    }
  }
  const OverlapShares s = ViewOverlap(edit.map()).between(cam(0), cam(1));
  EXPECT_GT(s.least(), 0.9);
}

}  // namespace
}  // namespace coslam::overlap_test
