// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/confirm.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/map_fit.h"
#include "tests/support/sim_map.h"

// What one image says of two maps, until another one says the same. What follows from it is in decide_test.cpp.
namespace coslam::confirm_test {
namespace {

using test::cam;
using Waiting = Verification::Waiting;

// Two cameras with a map each; the second recognises points of the first map.
class ConfirmTest : public testing::Test {
 protected:
  explicit ConfirmTest(test::Layout layout = test::Layout::kRoom) : world_({.layout = layout, .points = 150}) {
    step();
    sim_.add_points();
  }
  void step(int sets = 1) {
    for (int i = 0; i < sets; ++i) {
      sim_.ingest();
      sim_.place_truly(cam(0));
      sim_.place(cam(1), own_, transform_world(sim_.truth(cam(1), sim_.set.id), in_from_own_.inverse()));
    }
  }
  // The place is so far beside where truth has it.
  PlaceMatch seen(double beside_m = 0) const {
    PlaceMatch out{.map = sim_.id, .key_camera = cam(0), .key_set = sim_.set.id, .median_depth = 5};
    out.cam_from_world = sim_.truth(cam(1), sim_.set.id) * Rigid3{Eigen::Quaterniond::Identity(), {beside_m, 0, 0}};
    for (const auto& [id, p] : sim_.map.points()) out.matches.emplace_back(TrackId(id.value), id);
    return out;
  }
  PlaceDoubt examine(const PlaceMatch& seen, bool enough = true) {
    Similarity3 in_from_own = in_from_own_;
    in_from_own.translation += sim_.truth(cam(1), sim_.set.id).center() - seen.cam_from_world.center();
    return judge_.examine(sim_.map, newest_image(sim_.map.camera(cam(1))), seen, in_from_own, ViewGraph(), enough);
  }
  Waiting waiting(int camera) const { return judge_.waiting(sim_.map, cam(camera)); }

  const test::SimWorld world_;
  test::SimMap sim_{world_, test::paths_side_by_side(3)};
  const MapId own_ = sim_.edit.new_map(Why::kStartedAlone, 1);
  const Similarity3 in_from_own_{0.5, so3_exp({0.1, 0.4, 0}), {1, 2, 3}};
  Verification judge_;
};

TEST_F(ConfirmTest, TwoImagesThatAgreeConfirmAPlaceOnce) {
  EXPECT_EQ(examine(seen()), PlaceDoubt::kUnconfirmed);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kNone);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kUnconfirmed) << "what was confirmed is acted on, and over";
}

TEST_F(ConfirmTest, ImagesOfOneInstantAreOne) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(examine(seen()), PlaceDoubt::kUnconfirmed);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kNone);
}

TEST_F(ConfirmTest, OneOfTheImagesHasEnoughPoints) {
  EXPECT_EQ(examine(seen(), false), PlaceDoubt::kUnconfirmed);
  for (int i = 0; i < 3; ++i) {
    step();
    EXPECT_EQ(examine(seen(), false), PlaceDoubt::kTooFewFeatures);
  }
  step();
  EXPECT_EQ(examine(seen(), true), PlaceDoubt::kNone);
}

TEST_F(ConfirmTest, FewPointsThatSayOtherwiseTakeNothingAway) {
  examine(seen());
  step();
  EXPECT_EQ(examine(seen(3), false), PlaceDoubt::kTooFewFeatures);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kNone);
}

TEST_F(ConfirmTest, ManyPointsThatSayOtherwiseBeginAnew) {
  examine(seen());
  step();
  EXPECT_EQ(examine(seen(9)), PlaceDoubt::kContradicted);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kContradicted);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kNone);
}

TEST_F(ConfirmTest, AnImageIsForgottenWhenNoneConfirmsItSoon) {
  const auto soon = static_cast<int>(sim_.map.sets_in(5));
  examine(seen());
  step(soon);
  EXPECT_EQ(waiting(1), Waiting::kNothing);
  EXPECT_EQ(examine(seen()), PlaceDoubt::kUnconfirmed);
  step(soon - 1);
  EXPECT_EQ(waiting(1), Waiting::kAnywhere);
  EXPECT_EQ(examine(seen()), PlaceDoubt::kNone);
}

TEST_F(ConfirmTest, BothCamerasWaitAndNoOther) {
  EXPECT_EQ(waiting(1), Waiting::kNothing);
  examine(seen());
  EXPECT_EQ(waiting(0), Waiting::kAnywhere);
  EXPECT_EQ(waiting(1), Waiting::kAnywhere);
  EXPECT_EQ(waiting(2), Waiting::kNothing);
  step();
  examine(seen());
  EXPECT_EQ(waiting(1), Waiting::kNothing) << "it is confirmed";
}

TEST_F(ConfirmTest, WhereAPlaceWasExpectedOneMoreLookThereIsEnough) {
  PlaceMatch expected = seen();
  expected.expected = true;
  examine(expected);
  EXPECT_EQ(waiting(1), Waiting::kExpected);
}

TEST_F(ConfirmTest, AJoinedMapLeavesNothingToConfirm) {
  examine(seen());
  judge_.drawn_together(sim_.id);
  EXPECT_EQ(waiting(1), Waiting::kAnywhere) << "a loop in one of them says nothing of the two";
  judge_.joined(own_, MapId(9));
  EXPECT_EQ(waiting(1), Waiting::kNothing);
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kUnconfirmed);
}

TEST_F(ConfirmTest, TheDirectionInWhichTheMapsAreComparedDoesNotMatter) {
  examine(seen());
  step();
  // The first camera recognises a place of the second map: that is the same hypothesis.
  PlaceMatch back{.map = own_, .key_camera = cam(1), .key_set = sim_.set.id, .median_depth = 5};
  const Similarity3 own_from_in = in_from_own_.inverse();
  back.median_depth *= own_from_in.scale;
  back.cam_from_world = transform_world(sim_.truth(cam(0), sim_.set.id), own_from_in);
  for (int p = 0; p < world_.size(); ++p) {
    const PointId id = sim_.create(own_, own_from_in * world_.position(p)).id;
    back.matches.emplace_back(TrackId(id.value), id);
  }
  EXPECT_EQ(judge_.examine(sim_.map, newest_image(sim_.map.camera(cam(0))), back, own_from_in, ViewGraph(), true),
            PlaceDoubt::kNone);
}

class ConfirmAtAWall : public ConfirmTest {
 protected:
  ConfirmAtAWall() : ConfirmTest(test::Layout::kPlane) {}
};

TEST_F(ConfirmAtAWall, WhatIsFlatIsNotConfirmedAndMoreOfItIsWaitedFor) {
  examine(seen());
  step();
  EXPECT_EQ(examine(seen()), PlaceDoubt::kFlat);
  EXPECT_EQ(waiting(1), Waiting::kAnywhere);
  step(static_cast<int>(sim_.map.sets_in(5)));
  EXPECT_EQ(waiting(1), Waiting::kMore) << "for longer, in another view";
  EXPECT_EQ(examine(seen()), PlaceDoubt::kFlat);
}

TEST_F(ConfirmAtAWall, WhereItWasExpectedAPlaceMayBeFlat) {
  PlaceMatch expected = seen();
  expected.expected = true;
  examine(expected);
  step();
  expected = seen();
  expected.expected = true;
  EXPECT_EQ(examine(expected), PlaceDoubt::kNone);
}

TEST_F(ConfirmAtAWall, ThatAMapRepeatsItselfIsKnownOfTheMapItBecamePartOf) {
  const auto look = [&](double beside_m) {
    PlaceMatch r = seen(beside_m);
    r.median_depth = 1;  // the wall is many times as wide
    const PlaceDoubt doubt = examine(r);
    step();
    return doubt;
  };
  EXPECT_EQ(look(0), PlaceDoubt::kUnconfirmed);
  EXPECT_EQ(look(3), PlaceDoubt::kContradicted) << "the same print elsewhere";
  judge_.joined(sim_.id, MapId(9));
  judge_.joined(own_, MapId(8));
  for (int i = 0; i < 3; ++i) EXPECT_NE(look(0), PlaceDoubt::kNone);
}

}  // namespace
}  // namespace coslam::confirm_test
