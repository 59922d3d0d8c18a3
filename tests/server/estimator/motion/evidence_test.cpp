// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/support/sim_map.h"

namespace coslam::evidence_test {
namespace {

constexpr CameraId kCam0(0), kCam1(1);

// Two cameras with true poses in a mapped room, and things that move in it.
class EvidenceTest : public testing::Test {
 protected:
  EvidenceTest() : sim_(world_, test::paths_side_by_side(2), {.max_tracks = 400}) {
    sim_.advance(1, true);
    sim_.add_points(0.003);
    sim_.advance(kSets - 1, true);
  }
  // The first world point from there on that both follow.
  int followed(int from) const {
    while (!sim_.all_follow(from)) ++from;
    return from;
  }
  // Two tracks as a pair of cameras sees them now.
  bool as_one(int in_first, int in_second, double back_s = 0.33) {
    const MapCamera &first = sim_.map.camera(kCam0), &second = sim_.map.camera(kCam1);
    const ViewEdge edge{kCam0, kCam1, 20};
    const PairView view =
        make_pair_view(sim_.map, edge, first.frames.back().cam_from_world, second.frames.back().cam_from_world);
    const auto feature = [&](CameraId c, int point) {
      const ServerTrack* t = sim_.track_of(c, point);
      return Feature{t, t->seen.back().undistorted_px.cast<double>()};
    };
    return moved_as_one(sim_.map, view, feature(kCam0, in_first), feature(kCam1, in_second), back_s);
  }
  TrackMotion judged(CameraId camera, int point) const {
    for (const TrackJudgement& j : judge_tracks(sim_.map, sim_.map.camera(camera), config_)) {
      if (j.track == sim_.track_of(camera, point)) return j.motion;
    }
    ADD_FAILURE() << "it has a point";
    return TrackMotion::kResting;
  }

  static constexpr int kStatic = 300, kSets = 30;
  const EvidenceConfig config_;
  const test::SimWorld world_{{.seed = 24, .points = kStatic, .moving_points = 25}};
  test::SimMap sim_;
};

TEST_F(EvidenceTest, APointIsElsewhereWhenTwoCamerasMissIt) {
  const MapPoint& p = *sim_.map.recent_points().front();
  ASSERT_EQ(p.bound.size(), 2U);
  EXPECT_FALSE(seen_elsewhere(sim_.map, p));
  sim_.edit.miss_gate(p.bound[0].camera, sim_.map.track(p.bound[0]), 5);
  EXPECT_FALSE(seen_elsewhere(sim_.map, p)) << "one track may have slid";
  sim_.edit.miss_gate(p.bound[1].camera, sim_.map.track(p.bound[1]), 5);
  EXPECT_TRUE(seen_elsewhere(sim_.map, p));
  sim_.edit.pass_gate(sim_.map.track(p.bound[0]));
  EXPECT_FALSE(seen_elsewhere(sim_.map, p));
}

TEST_F(EvidenceTest, APointStandsStillWhenNoTrackMovesAgainstIt) {
  const MapPoint& rests = *sim_.map.recent_points().front();
  EXPECT_TRUE(stands_still(sim_.map, rests, config_));
  const int mover = followed(kStatic);
  const MapPoint& moves = sim_.add_point(mover, 0.01, Eigen::Vector3d::Zero(), PointPhase::kMoving);
  EXPECT_FALSE(stands_still(sim_.map, moves, config_));
}

TEST_F(EvidenceTest, OneCameraIsNotEnoughForStandingStill) {
  const MapPoint& p = *sim_.map.recent_points().front();
  sim_.edit.unbind(p.bound[1].camera, sim_.map.track(p.bound[1]), Why::kStray);
  EXPECT_FALSE(stands_still(sim_.map, p, config_));
}

TEST_F(EvidenceTest, ATrackMayRestAtWhateverDistance) {
  const MapCamera& camera = sim_.map.camera(kCam0);
  const double depth = median_static_depth(sim_.map, camera);
  EXPECT_GT(depth, 1);
  EXPECT_LT(depth, 20);
  int resting = 0, all = 0, moving_rests = 0, moving = 0;
  for (const auto& [id, t] : camera.tracks) {
    if (static_cast<int>(t.seen.size()) < kSets) continue;
    const bool rests = may_rest(camera, t, depth, config_);
    const bool is_mover = world_.moves(sim_.world_point(kCam0, id));
    (is_mover ? moving : all) += 1;
    (is_mover ? moving_rests : resting) += rests;
  }
  ASSERT_GT(moving, 5);
  EXPECT_GT(resting, 0.95 * all);
  EXPECT_LT(moving_rests, 0.4 * moving) << "some go away along their ray";
}

TEST_F(EvidenceTest, ATrackThatIsTooYoungDoesNotRest) {
  test::SimMap young(world_, test::paths_side_by_side(1));
  young.advance(3, true);
  const MapCamera& camera = young.map.camera(kCam0);
  for (const auto& [id, t] : camera.tracks) EXPECT_FALSE(may_rest(camera, t, 5, config_));
}

TEST_F(EvidenceTest, WhatMovesAmongItsLikeIsJudgedMoving) {
  int moving = 0, doubtful = 0, all = 0;
  for (int i = kStatic; i < world_.size(); ++i) {
    if (sim_.track_of(kCam0, i) == nullptr) continue;
    ++all;
    moving += judged(kCam0, i) == TrackMotion::kMoving;
    doubtful += judged(kCam0, i) == TrackMotion::kDoubtful;
  }
  EXPECT_GT(moving, 0.3 * all) << "in one second";
  EXPECT_GT(moving + doubtful, 0.9 * all);
  for (const TrackJudgement& j : judge_tracks(sim_.map, sim_.map.camera(kCam0), config_)) {
    EXPECT_FALSE(j.track->bound());
    if (j.motion != TrackMotion::kMoving) continue;
    EXPECT_TRUE(world_.moves(sim_.world_point(kCam0, j.track->id)));
    EXPECT_GE(j.moving_neighbours, 1);
  }
}

// Neighbours in the first camera that were seen to move, and then, for more than the time that is looked at, at
// fixed places: so far away from where the camera began, in its middle.
class AfterMotion : public EvidenceTest {
 protected:
  void stay(double distance, int sets = 40) {
    for (int i = kStatic; tracks_.size() < kTracks; ++i) {
      if (sim_.track_of(kCam0, i) != nullptr) tracks_.push_back(i);
    }
    const Rigid3 began = sim_.truth(kCam0, sim_.set.id);
    const MapCamera& camera = sim_.map.camera(kCam0);
    for (int n = 0; n < sets; ++n) {
      sim_.look();
      const Rigid3 now = sim_.truth(kCam0, sim_.set.id);
      for (std::size_t i = 0; i < tracks_.size(); ++i) {
        TrackObservation* seen = sim_.seen(kCam0, tracks_[i]);
        ASSERT_NE(seen, nullptr);
        const Eigen::Vector2d at(290 + 4.0 * static_cast<double>(i), 230);
        const Eigen::Vector3d place = distance * camera.model.normalized_from_pixel(at).homogeneous();
        seen->undistorted_px = camera.model.project(now * (began.inverse() * place)).cast<float>();
      }
      sim_.take();
      sim_.place_truly();
    }
    clear(sim_.track_of(kCam0, tracks_[kTracks / 2])->seen.back().undistorted_px);
  }
  // All of them together over the image, as nothing at rest does.
  void turn_off(int sets, const Eigen::Vector2f& step_px) {
    std::vector<Eigen::Vector2f> at;
    for (const int i : tracks_) at.push_back(sim_.track_of(kCam0, i)->seen.back().undistorted_px);
    for (int n = 1; n <= sets; ++n) {
      sim_.look();
      for (std::size_t i = 0; i < tracks_.size(); ++i) {
        sim_.seen(kCam0, tracks_[i])->undistorted_px = at[i] + static_cast<float>(n) * step_px;
      }
      sim_.take();
      sim_.place_truly();
    }
    clear(sim_.track_of(kCam0, tracks_[kTracks / 2])->seen.back().undistorted_px);
  }
  // No point at rest is around there.
  void clear(const Eigen::Vector2f& there) {
    for (const auto& [id, t] : sim_.map.camera(kCam0).tracks) {
      if (!t.bound() || (t.seen.back().undistorted_px - there).norm() > 80) continue;
      sim_.edit.remove_point(*sim_.map.find(t.point), Why::kTooFewViews);
    }
  }
  std::vector<TrackMotion> judged_after(TrackMotion before) {
    std::vector<TrackMotion> out;
    for (const int i : tracks_) sim_.edit.set_motion(kCam0, *sim_.track_of(kCam0, i), before);
    for (const int i : tracks_) out.push_back(judged(kCam0, i));
    return out;
  }
  static constexpr std::size_t kTracks = 8;
  std::vector<int> tracks_;
};

TEST_F(AfterMotion, WhatKeepsItsDistanceToTheCameraGoesOn) {
  stay(1e5);
  using enum TrackMotion;
  EXPECT_EQ(judged_after(kMoving), std::vector(kTracks, kMoving)) << "as the car ahead does";
  EXPECT_EQ(judged_after(kResting), std::vector(kTracks, kResting)) << "far things that never moved rest";
}

TEST_F(AfterMotion, WhatTurnsOffTellsThatItWentAlong) {
  const SetId began = sim_.set.id;
  stay(1e5, 70);
  EXPECT_EQ(judged_after(TrackMotion::kResting), std::vector(kTracks, TrackMotion::kResting)) << "on a straight way";
  const SetId turned = sim_.set.id;
  turn_off(8, {3, -6});
  int told = 0;
  for (const TrackJudgement& j : judge_tracks(sim_.map, sim_.map.camera(kCam0), config_)) {
    const bool is_one = std::ranges::any_of(tracks_, [&](int i) { return j.track == sim_.track_of(kCam0, i); });
    if (!is_one) continue;
    EXPECT_EQ(j.motion, TrackMotion::kMoving);
    ASSERT_TRUE(j.co_moving_since);
    EXPECT_GE(*j.co_moving_since, began) << "when it moved otherwise";
    EXPECT_LT(j.co_moving_since->value, (began.value + turned.value) / 2);
    ++told;
  }
  EXPECT_EQ(told, static_cast<int>(kTracks));
}

TEST_F(AfterMotion, WhatStoodSomewhereDidNotGoAlong) {
  stay(3, 70);
  EXPECT_EQ(judged_after(TrackMotion::kResting), std::vector(kTracks, TrackMotion::kResting));
  turn_off(8, {3, -6});
  for (const TrackJudgement& j : judge_tracks(sim_.map, sim_.map.camera(kCam0), config_)) {
    if (std::ranges::none_of(tracks_, [&](int i) { return j.track == sim_.track_of(kCam0, i); })) continue;
    EXPECT_EQ(j.motion, TrackMotion::kMoving);
    EXPECT_FALSE(j.co_moving_since);
  }
}

TEST_F(AfterMotion, WhatStoppedSomewhereRests) {
  stay(3);
  EXPECT_EQ(judged_after(TrackMotion::kMoving), std::vector(kTracks, TrackMotion::kResting));
}

TEST_F(EvidenceTest, TwoTracksOfOneMoverMovedAsOne) {
  int as_ones = 0, movers = 0;
  for (int i = kStatic; i < world_.size(); ++i) {
    if (!sim_.all_follow(i)) continue;
    ++movers;
    as_ones += as_one(i, i);
  }
  ASSERT_GT(movers, 5);
  EXPECT_GT(as_ones, 0.7 * movers) << "but for those that have hardly moved";
}

TEST_F(EvidenceTest, NotWhatRests) {
  for (const MapPoint* p : sim_.map.recent_points()) {
    const int corner = sim_.world_point(*p);
    if (!sim_.all_follow(corner)) continue;
    EXPECT_FALSE(as_one(corner, corner)) << corner;
  }
}

TEST_F(EvidenceTest, NotTwoThings) {
  const int one = followed(kStatic), other = followed(one + 1);
  EXPECT_FALSE(as_one(one, other));
  EXPECT_FALSE(as_one(other, one));
}

TEST_F(EvidenceTest, NotWhatWasSeenTogetherForTooShort) {
  const int mover = followed(kStatic);
  EXPECT_FALSE(as_one(mover, mover, 100)) << "half of that time has to be there";
}

}  // namespace
}  // namespace coslam::evidence_test
