// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/wide_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::wide_search_test {
namespace {

using test::PoseNear;

constexpr CameraId kCam(0);
constexpr int kLeast = 12;

// A camera that knows all points around it, of which no track of its is any more, at a pose that has drifted.
class FindAgainTest : public testing::Test {
 protected:
  FindAgainTest() : sim_(world_, test::paths_side_by_side(1)) {
    sim_.advance(3, true);
    sim_.add_points(0.005);
    sim_.advance(3, true);
    lose_sight();
  }
  void lose_sight() {
    for (const auto& [id, t] : camera().tracks) {
      if (t.bound()) sim_.edit.unbind(kCam, t, Why::kOutsideGate);
    }
    sim_.edit.set_sparse(camera(), true);
  }
  WideSearchReport look(const Vector6d& drift) {
    sim_.ingest(true);
    sim_.place(kCam, retract(sim_.truth(kCam, sim_.set.id), drift));
    return wide_search(sim_.edit, sim_.set, {}, kLeast);
  }
  static Vector6d turned(double by_rad) { return (Vector6d() << 0.3 * by_rad, by_rad, 0, 0, 0, 0).finished(); }
  const MapCamera& camera() { return sim_.map.camera(kCam); }
  const Rigid3& pose() { return camera().frames.back().cam_from_world; }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(FindAgainTest, ADriftedPoseIsCorrectedAndThePointsHaveTheirTracks) {
  const WideSearchReport report = look(turned(0.02));
  EXPECT_EQ(report.cameras, 1);
  EXPECT_GT(report.points, 100);
  EXPECT_THAT(pose(), PoseNear(sim_.truth(kCam, sim_.set.id), 0.003, 0.02));
  int wrong = 0;
  for (const auto& [id, p] : sim_.map.points()) {
    for (const BoundTrack& b : p.bound) wrong += sim_.world_point(b.camera, b.track) != sim_.world_point(p);
  }
  EXPECT_EQ(wrong, 0);
}

TEST_F(FindAgainTest, OneThatDriftedFartherIsLeft) {
  const WideSearchReport report = look(turned(0.2));
  EXPECT_EQ(report.cameras, 0);
  EXPECT_EQ(report.points, 0);
  EXPECT_GT(pose().rotation.angularDistance(sim_.truth(kCam, sim_.set.id).rotation), 0.19);
}

TEST_F(FindAgainTest, ACameraWithPointsEnoughDoesNotLook) {
  sim_.edit.set_sparse(camera(), false);
  EXPECT_EQ(look(turned(0.02)).points, 0);
}

TEST_F(FindAgainTest, ThingsThatLookAllTheSameAreNotTaken) {
  sim_.look(true);
  for (ImagePatch& patch : sim_.set.frames[0].patches->patches) patch.grey = world_.patch(0);
  sim_.take();
  sim_.place(kCam, retract(sim_.truth(kCam, sim_.set.id), turned(0.02)));
  EXPECT_EQ(wide_search(sim_.edit, sim_.set, {}, kLeast).cameras, 0);
}

TEST_F(FindAgainTest, TooFewThatAgreeAreNotTaken) {
  // Points elsewhere than they look: each patch is right, no pose explains them.
  std::vector<PointId> ids;
  for (const auto& [id, p] : sim_.map.points()) ids.push_back(id);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const MapPoint& p = *sim_.map.find(ids[i]);
    const double off_m = 0.028 * p.position.z(), towards_rad = 2.4 * static_cast<double>(i);
    sim_.shift(p, {off_m * std::cos(towards_rad), off_m * std::sin(towards_rad), 0});
  }
  const WideSearchReport report = look(turned(0));
  EXPECT_EQ(report.cameras, 0);
}

TEST_F(FindAgainTest, PointsOnTrialAreNotLookedFor) {
  sim_.edit.put_on_trial(sim_.id, Why::kMapIsNew);
  EXPECT_EQ(look(turned(0.02)).points, 0);
}

}  // namespace
}  // namespace coslam::wide_search_test
