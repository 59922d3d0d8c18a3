// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/create/two_cameras.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

// Two cameras 1.2 m apart with true poses; every fourth point that both see is mapped, so that they share an edge.
class MapInterTest : public testing::Test {
 protected:
  explicit MapInterTest(const test::WorldConfig& world = {})
      : world_(world), sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(10, true);
    for (int p = 0; p < world_.size(); ++p) {
      if (!sim_.all_follow(p) || world_.moves(p)) continue;
      if (++seen_ % 4 == 0) sim_.add_point(p);
    }
  }
  MapInterReport step(const MapInterConfig& config = {}) {
    return map_inter(sim_.map, sim_.set, view_graph(sim_.map, sim_.set), config);
  }
  std::vector<const MapPoint*> created() const {
    std::vector<const MapPoint*> out;
    for (const auto& [id, p] : sim_.map.points()) {
      if (p.id.value > seeds()) out.push_back(&p);
    }
    return out;
  }
  std::uint32_t seeds() const { return static_cast<std::uint32_t>(seen_ / 4); }

  const test::SimWorld world_;
  test::SimMap sim_;
  int seen_ = 0;
};

TEST_F(MapInterTest, MapsWhatBothSee) {
  const MapInterReport report = step();
  EXPECT_GT(seen_, 60);
  EXPECT_GE(report.created, 0.6 * seen_);  // of three quarters
  ASSERT_EQ(created().size(), static_cast<std::size_t>(report.created));
  std::vector<double> values;
  for (const MapPoint* p : created()) {
    ASSERT_EQ(p->bound.size(), 2U);
    EXPECT_EQ(p->state, PointState::kStatic);
    EXPECT_EQ(sim_.world_point(p->bound[0].camera, p->bound[0].track),
              sim_.world_point(p->bound[1].camera, p->bound[1].track));
    const Eigen::Vector3d error = p->position - world_.position(sim_.world_point(*p));
    EXPECT_LT(error.norm(), 0.03 * p->position.z());
    values.push_back(test::nees(error, p->covariance));
  }
  EXPECT_LT(test::median(values), 4);
}

TEST_F(MapInterTest, NothingIsLeftForTheSecondTime) {
  step();
  EXPECT_LE(step().created, 1);
}

TEST_F(MapInterTest, NothingWithoutPatches) {
  for (auto& [id, t] : sim_.map.camera(kCam1).tracks) t.patch.reset();
  EXPECT_EQ(step().compared, 0);
}

TEST_F(MapInterTest, NothingWithoutAnEdge) {
  for (auto& [id, t] : sim_.map.camera(kCam1).tracks) {
    if (t.point != PointId()) sim_.map.unbind(kCam1, t);
  }
  EXPECT_EQ(step().compared, 0);
}

TEST_F(MapInterTest, NothingWithoutAPose) {
  sim_.map.camera(kCam1).frames.back().map = MapId();
  EXPECT_EQ(step().created, 0);
}

class MapInterWithTraffic : public MapInterTest {
 protected:
  MapInterWithTraffic() : MapInterTest({.points = 300, .moving_points = 80}) {}
};

TEST_F(MapInterWithTraffic, StaticPointsOnly) {
  sim_.advance(25, true);
  step();
  int moving = 0;
  for (const MapPoint* p : created()) moving += world_.moves(sim_.world_point(*p));
  EXPECT_GT(created().size(), 30U);
  EXPECT_EQ(moving, 0);
}

// One candidate on each side: the same patch on the same epipolar line, as if the thing were `depth_m` away.
class Lookalike : public MapInterTest {
 protected:
  Lookalike() {
    for (int p = 0; p < world_.size() && a_ == nullptr; ++p) {
      if (!sim_.all_follow(p) || sim_.track_of(kCam0, p)->point != PointId() || !near_a_seed(p)) continue;
      a_ = sim_.track_of(kCam0, p);
      b_ = sim_.track_of(kCam1, p);
    }
    for (const CameraId c : {kCam0, kCam1}) {
      for (auto& [id, t] : sim_.map.camera(c).tracks) {
        if (&t != a_ && &t != b_) t.patch.reset();
      }
    }
  }
  bool near_a_seed(int p) {
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (t.point == PointId()) continue;
      const auto apart = t.seen.back().undistorted_px - sim_.track_of(kCam0, p)->seen.back().undistorted_px;
      if (apart.norm() < 50) return true;
    }
    return false;
  }
  // Puts the second track where it would see a thing on the first track's newest ray, at this depth, all along.
  void pretend(double depth_m) {
    const CameraModel camera = test::sim_camera();
    const Rigid3 first = sim_.truth(kCam0, sim_.set.id);
    const Eigen::Vector2d n = camera.normalized_from_pixel(a_->seen.back().undistorted_px.cast<double>());
    const Eigen::Vector3d thing = first.inverse() * (depth_m * n.homogeneous());
    for (TrackPoint& s : a_->seen) s.undistorted_px = camera.project(sim_.truth(kCam0, s.set) * thing).cast<float>();
    for (TrackPoint& s : b_->seen) s.undistorted_px = camera.project(sim_.truth(kCam1, s.set) * thing).cast<float>();
  }
  ServerTrack* a_ = nullptr;
  ServerTrack* b_ = nullptr;
};

TEST_F(Lookalike, OfTheDisparityAroundIsMatched) {
  const MapInterReport report = step();
  EXPECT_EQ(report.matched, 1);
  EXPECT_EQ(report.created, 1);
}

TEST_F(Lookalike, OfAnotherDisparityIsRefused) {
  pretend(1.2);  // 417 px of disparity against 60 to 170 of the room
  EXPECT_EQ(step().compared, 0);
  const MapInterReport report = step({.disparity_gate = 100});
  EXPECT_EQ(report.matched, 1) << "it is the disparity alone that refuses it";
  EXPECT_EQ(report.created, 1);
}

TEST_F(Lookalike, OffTheEpipolarLineIsRefused) {
  b_->seen.back().undistorted_px += Eigen::Vector2f(0, 12);
  EXPECT_EQ(step().compared, 0);
}

TEST_F(Lookalike, OfAnotherPatchIsRefused) {
  b_->patch = world_.patch(0);
  a_->patch = world_.patch(1);
  const MapInterReport report = step();
  EXPECT_EQ(report.compared, 1);
  EXPECT_EQ(report.matched, 0);
}

TEST_F(Lookalike, ThatWalkedInThePastIsRefused) {
  b_->seen[4].undistorted_px += Eigen::Vector2f(15, 0);
  const MapInterReport report = step();
  EXPECT_EQ(report.matched, 1);
  EXPECT_EQ(report.created, 0);
}

TEST_F(Lookalike, TwoThatLookAlikeAreAmbiguous) {
  // A second track of the second camera, a little along the line, with the same patch.
  for (auto& [id, t] : sim_.map.camera(kCam1).tracks) {
    if (&t == b_ || t.point != PointId()) continue;
    t.patch = b_->patch;
    t.seen.back().undistorted_px = b_->seen.back().undistorted_px + Eigen::Vector2f(8, 0);
    break;
  }
  EXPECT_EQ(step().matched, 0);
}

}  // namespace
}  // namespace coslam
