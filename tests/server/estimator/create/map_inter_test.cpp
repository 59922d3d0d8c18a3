// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/create/map_inter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::map_inter_test {
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
    return map_inter(sim_.edit, sim_.set, view_graph(sim_.map, sim_.set), config);
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
    EXPECT_TRUE(p->rests());
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
  test::SimMap blind(world_, test::paths_side_by_side(2));
  for (int i = 0; i < 10; ++i) {
    blind.look(true);
    blind.set.frames[1].patches.reset();
    blind.take();
    blind.place_truly();
  }
  for (const auto& [id, p] : sim_.map.points()) blind.add_point(sim_.world_point(p));
  const ViewGraph graph = view_graph(blind.map, blind.set);
  ASSERT_EQ(graph.edges.size(), 1U);
  EXPECT_EQ(map_inter(blind.edit, blind.set, graph, {}).pairs.compared, 0);
}

TEST_F(MapInterTest, NothingWithoutAnEdge) {
  for (const auto& [id, t] : sim_.map.camera(kCam1).tracks) {
    if (t.bound()) sim_.edit.unbind(kCam1, t, Why::kOutsideGate);
  }
  EXPECT_EQ(step().pairs.compared, 0);
}

TEST_F(MapInterTest, NothingWithoutAPose) {
  sim_.ingest(true);
  sim_.place_truly(kCam0);
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

// One candidate on each side: the same patch on the same epipolar line, as if the thing were somewhere else. The run
// is repeated with that pair alone having patches, and with what a test changes of it.
class Lookalike : public MapInterTest {
 protected:
  Lookalike() {
    while (!sim_.all_follow(thing_) || track(kCam0).bound() || !near_a_seed()) ++thing_;
  }
  const ServerTrack& track(CameraId camera) { return *sim_.track_of(camera, thing_); }
  bool near_a_seed() {
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (!t.bound()) continue;
      const auto apart = t.seen.back().undistorted_px - track(kCam0).seen.back().undistorted_px;
      if (apart.norm() < 50) return true;
    }
    return false;
  }
  // Puts both tracks where they would see a thing on the first track's newest ray, at this depth, all along.
  void pretend(double depth_m) {
    const CameraModel camera = test::sim_camera();
    const Eigen::Vector2d n = camera.normalized_from_pixel(track(kCam0).seen.back().undistorted_px.cast<double>());
    place_ = sim_.truth(kCam0, sim_.set.id).inverse() * (depth_m * n.homogeneous());
  }
  MapInterReport match(const MapInterConfig& config = {}) {
    again_.emplace(world_, test::paths_side_by_side(2));
    for (int i = 0; i <= static_cast<int>(sim_.set.id.value); ++i) {
      again_->look(true);
      for (const CameraId c : {kCam0, kCam1}) {
        std::erase_if(again_->set.frames[c.value].patches->patches,
                      [&](const ImagePatch& p) { return p.track != track(c).id; });
        if (!place_) continue;
        const Eigen::Vector2d px = test::sim_camera().project(again_->truth(c, again_->set.id) * *place_);
        again_->seen(c, thing_)->undistorted_px = px.cast<float>();
      }
      change(i);
      again_->take();
      again_->place_truly();
    }
    for (const auto& [id, p] : sim_.map.points()) again_->add_point(sim_.world_point(p));
    return map_inter(again_->edit, again_->set, view_graph(again_->map, again_->set), config);
  }

  int thing_ = 0;
  std::optional<Eigen::Vector3d> place_;
  std::function<void(int set)> change = [](int) {};
  std::optional<test::SimMap> again_;
};

TEST_F(Lookalike, OfTheDisparityAroundIsMatched) {
  const MapInterReport report = match();
  EXPECT_EQ(report.pairs.matched, 1);
  EXPECT_EQ(report.created, 1);
}

TEST_F(Lookalike, OfAnotherDisparityIsRefused) {
  pretend(1.2);  // 417 px of disparity against 60 to 170 of the room
  EXPECT_EQ(match().pairs.compared, 0);
  const MapInterReport report = match({.match = {.disparity_gate = 100}});
  EXPECT_EQ(report.pairs.matched, 1) << "it is the disparity alone that refuses it";
  EXPECT_EQ(report.created, 1);
}

TEST_F(Lookalike, OffTheEpipolarLineIsRefused) {
  change = [&](int set) {
    if (set == 9) again_->seen(kCam1, thing_)->undistorted_px += Eigen::Vector2f(0, 12);
  };
  EXPECT_EQ(match().pairs.compared, 0);
}

TEST_F(Lookalike, OfAnotherPatchIsRefused) {
  change = [&](int) {
    again_->patch_of(kCam0, thing_)->grey = world_.patch(1);
    again_->patch_of(kCam1, thing_)->grey = world_.patch(0);
  };
  const MapInterReport report = match();
  EXPECT_EQ(report.pairs.compared, 1);
  EXPECT_EQ(report.pairs.matched, 0);
}

TEST_F(Lookalike, ThatWalkedInThePastIsRefused) {
  change = [&](int set) {
    if (set == 4) again_->seen(kCam1, thing_)->undistorted_px += Eigen::Vector2f(15, 0);
  };
  const MapInterReport report = match();
  EXPECT_EQ(report.pairs.matched, 1);
  EXPECT_EQ(report.created, 0);
}

TEST_F(Lookalike, TwoThatLookAlikeAreAmbiguous) {
  // A second track of the second camera, a little along the line, with the same patch.
  const TrackId second = [&] {
    for (const auto& [id, t] : sim_.map.camera(kCam1).tracks) {
      if (id != track(kCam1).id && !t.bound()) return id;
    }
    return TrackId();
  }();
  change = [&](int) {
    CameraFrame& cf = again_->set.frames[kCam1.value];
    const auto at = std::ranges::find(cf.frame.tracks, second, &TrackObservation::track);
    if (at == cf.frame.tracks.end()) return;
    at->undistorted_px = again_->seen(kCam1, thing_)->undistorted_px + Eigen::Vector2f(8, 0);
    cf.patches->patches.push_back({second, again_->patch_of(kCam1, thing_)->grey});
  };
  const MapInterReport report = match();
  EXPECT_EQ(report.pairs.compared, 2);
  EXPECT_EQ(report.pairs.matched, 0);
}

}  // namespace
}  // namespace coslam::map_inter_test
