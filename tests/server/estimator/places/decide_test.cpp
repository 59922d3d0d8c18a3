// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/decide.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::decide_test {
namespace {

using test::cam;
using enum PlaceDecision::Action;

// Two cameras in one map at their true poses. What the second one recognises is put together by hand: points of the
// first, at the tracks that the second has of them.
class DecideTest : public testing::Test {
 protected:
  explicit DecideTest(const test::WorldConfig& world = {}) : world_(world), sim_(world_, test::paths_side_by_side(2)) {
    step();
    sim_.add_points();
    for (int i = 0; i < 20; ++i) step();
  }
  void step() {
    sim_.ingest();
    sim_.place_truly(cam(0));
    if (second_is_placed_) sim_.place(cam(1), in_, transform_world(sim_.truth(cam(1), sim_.set.id), in_from_world_));
  }
  // The second camera has a map of its own from now on.
  void put_second_elsewhere() {
    for (const MapPoint* p : sim_.map.recent_points()) {
      const std::vector<BoundTrack> bound = p->bound;
      for (const BoundTrack& b : bound) {
        if (b.camera == cam(1)) sim_.edit.unbind(b.camera, sim_.map.track(b), Why::kStray);
      }
    }
    in_ = sim_.edit.new_map(Why::kStartedAlone, 1);
    in_from_world_ = {2, so3_exp({0.1, 0.4, 0}), {1, 2, 3}};
    step();
    for (int p = 0; p < world_.size(); ++p) {
      const ServerTrack* t = sim_.track_of(cam(1), p);
      if (t != nullptr) sim_.bind(sim_.create(in_, in_from_world_ * world_.position(p)), cam(1), *t);
    }
  }
  const MapCamera& second() const { return sim_.map.camera(cam(1)); }
  // In so many features, at most; off: of the pose that they tell.
  PlaceMatch seen(std::size_t most = 1000, const Eigen::Vector3d& off_m = Eigen::Vector3d::Zero()) const {
    PlaceMatch out{.map = sim_.id, .key_camera = cam(0), .key_set = sim_.set.id, .median_depth = 5};
    out.cam_from_world = sim_.truth(cam(1), sim_.set.id) * Rigid3{Eigen::Quaterniond::Identity(), off_m};
    for (const MapPoint* p : sim_.map.recent_points()) {
      if (p->map != sim_.id || out.matches.size() >= most) continue;
      const ServerTrack* t = sim_.track_of(cam(1), sim_.world_point(*p));
      if (t != nullptr) out.matches.emplace_back(t->id, p->id);
    }
    return out;
  }
  PlaceDecision decide(std::optional<PlaceMatch> by_looks, ExpectedPlace expected = {}) {
    return judge_.decide(sim_.map, newest_image(second()), std::move(by_looks), std::move(expected), ViewGraph());
  }

  const test::SimWorld world_;
  test::SimMap sim_;
  bool second_is_placed_ = true;
  MapId in_ = sim_.id;
  Similarity3 in_from_world_;
  const DecideConfig config_;
  PlaceJudge judge_{config_};
};

TEST_F(DecideTest, NothingRecognisedIsUnknown) {
  EXPECT_EQ(decide(std::nullopt).action, kUnknown);
  EXPECT_EQ(judge_.waiting(sim_.map, cam(1)), Verification::Waiting::kNothing);
}

TEST_F(DecideTest, PointsWhereTheyAreExpectedGoBeforeAll) {
  ExpectedPlace expected;
  expected.in_place = seen().matches;
  const PlaceDecision d = decide(seen(5), expected);
  EXPECT_EQ(d.action, kSeenAsExpected);
  EXPECT_EQ(d.seen.matches, expected.in_place);
}

TEST_F(DecideTest, TooFewForATurnOfTheMapAreLookedAtAgain) {
  const auto few = static_cast<std::size_t>(config_.min_merge_inliers) - 1;
  const PlaceDecision decision = decide(seen(few));
  EXPECT_EQ(decision.action, kTooFew);
  EXPECT_EQ(decision.doubt, PlaceDoubt::kTooFewFeatures);
  EXPECT_EQ(decide(seen(few + 1)).action, kLink);
}

TEST_F(DecideTest, WhatWasFoundBesideWhereItWasExpectedMayBeFew) {
  ExpectedPlace expected;
  expected.beside = seen(8);
  expected.beside->expected = true;
  EXPECT_EQ(decide(seen(5), expected).action, kLink);
  EXPECT_EQ(decide(std::nullopt, expected).action, kLink);
}

TEST_F(DecideTest, KnownPointsWhereTheyShouldBeAreLinked) {
  const PlaceDecision d = decide(seen());
  EXPECT_EQ(d.action, kLink);
  EXPECT_EQ(d.seen.matches, seen().matches);
}

TEST_F(DecideTest, AMapThatHasDriftedIsClosedOnceASecondImageSaysSo) {
  in_from_world_ = {1, Eigen::Quaterniond::Identity(), {0.3, 0, 0}};
  step();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  EXPECT_EQ(judge_.waiting(sim_.map, cam(1)), Verification::Waiting::kAnywhere);
  EXPECT_EQ(decide(seen()).doubt, PlaceDoubt::kUnconfirmed) << "the same instant again is no second image";
  step();
  const PlaceDecision d = decide(seen());
  EXPECT_EQ(d.action, kClose);
  EXPECT_LT((d.in_from_own * Eigen::Vector3d(0.3, 0, 0)).norm(), 0.1);
  EXPECT_EQ(judge_.waiting(sim_.map, cam(1)), Verification::Waiting::kNothing);
}

// Near the end of a flight few images show where it began.
TEST_F(DecideTest, OneOfTheTwoImagesOfALoopMayShowFewPoints) {
  in_from_world_ = {1, Eigen::Quaterniond::Identity(), {0.3, 0, 0}};
  const auto few = static_cast<std::size_t>(config_.min_merge_inliers) - 1;
  step();
  EXPECT_EQ(decide(seen(few)).action, kTooFew);
  step();
  EXPECT_EQ(decide(seen(few)).action, kTooFew) << "twice few are few";
  step();
  EXPECT_EQ(decide(seen()).action, kClose);
  step();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  step();
  EXPECT_EQ(decide(seen(few, {1, 0, 0})).action, kTooFew) << "what few points say otherwise takes nothing away";
  step();
  EXPECT_EQ(decide(seen(few)).action, kClose);
}

TEST_F(DecideTest, ASecondImageThatSaysOtherwiseConfirmsNothing) {
  in_from_world_ = {1, Eigen::Quaterniond::Identity(), {0.3, 0, 0}};
  step();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  step();
  const PlaceDecision elsewhere = decide(seen(1000, {1.5, 0, 0}));
  EXPECT_EQ(elsewhere.action, kDoubtful);
  EXPECT_EQ(elsewhere.doubt, PlaceDoubt::kContradicted);
}

TEST_F(DecideTest, WhenTheMapHasMovedItBeginsAnew) {
  in_from_world_ = {1, Eigen::Quaterniond::Identity(), {0.3, 0, 0}};
  step();
  decide(seen());
  judge_.drawn_together(sim_.id);
  step();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
}

TEST_F(DecideTest, TwoMapsAreJoinedByTheSimilarityOfBoth) {
  put_second_elsewhere();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  step();
  const PlaceDecision d = decide(seen());
  ASSERT_EQ(d.action, kJoin);
  const Eigen::Vector3d somewhere(1, -1, 4);
  EXPECT_LT((d.in_from_own * (in_from_world_ * somewhere) - somewhere).norm(), 0.1);
  EXPECT_NEAR(d.in_from_own.scale, 0.5, 0.02);
}

// A young map may be bent: what two images say of it differs, but that it is the same place is beyond doubt.
TEST_F(DecideTest, ManyPointsJoinMapsThatDoNotFit) {
  constexpr std::size_t kFew = 39;
  const Eigen::Vector3d bent_m(1, 0, 0), elsewhere_m(3, 0, 0);
  put_second_elsewhere();
  ASSERT_GT(seen().matches.size(), 2 * kFew);
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  step();
  EXPECT_EQ(decide(seen(kFew, bent_m)).action, kDoubtful);
  step();
  EXPECT_EQ(decide(seen()).action, kDoubtful) << "it was not beyond doubt before";
  step();
  EXPECT_EQ(decide(seen(1000, elsewhere_m)).action, kDoubtful) << "nor is it bent so much";
  step();
  EXPECT_EQ(decide(seen(1000, elsewhere_m + bent_m)).action, kJoin);
}

TEST_F(DecideTest, WhatIsSaidOfTwoMapsOutlivesALoopInOneOfThem) {
  put_second_elsewhere();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  judge_.drawn_together(sim_.id);
  step();
  EXPECT_EQ(decide(seen()).action, kJoin);
}

TEST_F(DecideTest, WhatIsSaidOfAMapDoesNotOutliveThatItIsJoinedToAnother) {
  put_second_elsewhere();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
  judge_.joined(sim_.id, MapId(77));
  step();
  EXPECT_EQ(decide(seen()).action, kDoubtful);
}

TEST_F(DecideTest, WithoutDepthsOfItsOwnThereIsNoScale) {
  put_second_elsewhere();
  const std::vector<const MapPoint*> points = sim_.map.recent_points();
  for (const MapPoint* p : points) {
    if (p->map == in_) sim_.edit.remove_point(*p, Why::kTooFewViews);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(decide(seen()).action, kDoubtful);
    step();
  }
}

class DecideWithoutMap : public DecideTest {
 protected:
  explicit DecideWithoutMap(const test::WorldConfig& world = {}) : DecideTest(world) {
    second_is_placed_ = false;
    sim_.edit.leave_map(second());
    // Long enough ago that where it was lost tells nothing.
    for (std::uint32_t i = 0; i < sim_.map.sets_in(sim_.map.config().recent_s) + 2; ++i) {
      sim_.ingest();
      sim_.place_truly(cam(0));
    }
    sim_.add_points();
  }
};

TEST_F(DecideWithoutMap, FewFeaturesDoNotPlaceIt) {
  const auto least = static_cast<std::size_t>(config_.min_place_inliers);
  EXPECT_EQ(decide(seen(least - 1)).action, kTooFew);
  EXPECT_EQ(decide(seen(least)).action, kPlace);
}

TEST_F(DecideWithoutMap, OneImageWithReliefPlacesACamera) { EXPECT_EQ(decide(seen()).action, kPlace); }

class DecideAtAWall : public DecideWithoutMap {
 protected:
  DecideAtAWall() : DecideWithoutMap({.layout = test::Layout::kPlane}) {}
};

TEST_F(DecideAtAWall, AFlatPlaceDoesNot) {
  const PlaceDecision decision = decide(seen());
  EXPECT_EQ(decision.action, kDoubtful);
  EXPECT_EQ(decision.doubt, PlaceDoubt::kFlat);
}

// Two maps of one plane.
class DecideOverAPlane : public DecideTest {
 protected:
  DecideOverAPlane() : DecideTest({.layout = test::Layout::kPlane}) { put_second_elsewhere(); }
  PlaceDecision::Action look(double from_m, double off_m = 0) {
    PlaceMatch r = seen(1000, {off_m, 0, 0});
    r.median_depth = from_m;
    const PlaceDecision::Action action = decide(r).action;
    step();
    return action;
  }
  static constexpr double kFar_m = 6, kNear_m = 1;  // the plane is some 8 m wide
};

TEST_F(DecideOverAPlane, APrintJoinsNothing) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(look(kFar_m), kDoubtful);
}

TEST_F(DecideOverAPlane, GroundThatIsWiderThanPrintsDoes) {
  EXPECT_EQ(look(kNear_m), kDoubtful);
  EXPECT_EQ(look(kNear_m), kJoin);
}

TEST_F(DecideOverAPlane, GroundThatRepeatsItselfDoesNot) {
  EXPECT_EQ(look(kNear_m), kDoubtful);
  EXPECT_EQ(look(kNear_m, 3), kDoubtful) << "it is elsewhere, too";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(look(kNear_m, 3), kDoubtful);
}

}  // namespace
}  // namespace coslam::decide_test
