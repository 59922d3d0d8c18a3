// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/maps_pen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/server/estimator/map/shared_point.h"
#include "tests/support/map_checks.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// Key frames, and maps as wholes. What a merge tells is in edit_test.cpp, where it puts things in map_test.cpp.
namespace coslam::maps_pen_test {
namespace {

using test::observed;
using test::VectorNear;

constexpr CameraId kCam0(0), kCam1(1);

class MapsPenTest : public test::SharedPointTest {
 protected:
  MapsPenTest() : SharedPointTest(false) {}
  const MapCamera& camera(CameraId id) const { return sim_.map.camera(id); }
};

TEST_F(MapsPenTest, KeyFramesAreInOrderAndEachIsThereOnce) {
  const MapPoint& p = sim_.add_point(shared_);
  for (const std::uint32_t set : {4U, 1U, 5U, 1U, 4U, 0U}) edit_.add_key_frame(SetId(set));
  std::vector<std::uint32_t> sets;
  for (const KeyFrame& k : sim_.map.key_frames()) sets.push_back(k.set.value);
  EXPECT_EQ(sets, (std::vector<std::uint32_t>{0, 1, 4, 5}));
  EXPECT_EQ(p.key_observations.size(), 8U) << "by two cameras";
  EXPECT_TRUE(test::sorted_and_unique(p.key_observations));
}

TEST_F(MapsPenTest, ASparedCameraGivesNoObservationsNowNorLater) {
  const MapPoint& p = sim_.add_point(shared_);
  edit_.add_key_frame(SetId(3), {kCam1});
  EXPECT_TRUE(observed(p, SetId(3), kCam0, track(kCam0).id));
  EXPECT_FALSE(observed(p, SetId(3), kCam1, track(kCam1).id));
  edit_.unbind(kCam1, track(kCam1), Why::kOutsideGate);
  sim_.bind(p, kCam1, track(kCam1));
  EXPECT_FALSE(observed(p, SetId(3), kCam1, track(kCam1).id));
  test::expect_consistent(sim_.map);
}

TEST_F(MapsPenTest, TracksOutsideTheirGateGiveNoObservations) {
  const MapPoint& p = sim_.add_point(shared_);
  edit_.miss_gate(kCam0, track(kCam0), 4);
  edit_.distrust_before(track(kCam1), SetId(4));
  edit_.add_key_frame(SetId(3));
  EXPECT_TRUE(p.key_observations.empty());
  edit_.add_key_frame(SetId(5));
  EXPECT_EQ(p.key_observations.size(), 1U) << "of what is trusted again";
  edit_.add_key_image(sim_.set.id, kCam0);
  EXPECT_FALSE(observed(p, sim_.set.id, kCam0, track(kCam0).id));
}

TEST_F(MapsPenTest, AKeyImageOfAKeyFrameAddsNothing) {
  const MapPoint& p = sim_.add_point(shared_);
  edit_.add_key_frame(sim_.set.id);
  const std::size_t before = p.key_observations.size();
  edit_.add_key_image(sim_.set.id, kCam0);
  EXPECT_EQ(p.key_observations.size(), before);
  EXPECT_TRUE(sim_.map.key_images().contains({sim_.set.id, kCam0})) << "it is remembered nonetheless";
}

TEST_F(MapsPenTest, AKeyFrameAfterAKeyImageAddsWhatTheOtherCamerasSaw) {
  const MapPoint& p = sim_.add_point(shared_);
  edit_.add_key_image(sim_.set.id, kCam0);
  EXPECT_EQ(p.key_observations.size(), 1U);
  edit_.add_key_frame(sim_.set.id);
  EXPECT_EQ(p.key_observations.size(), 2U);
  test::expect_consistent(sim_.map);
}

TEST_F(MapsPenTest, ArchivedFramesGoWithTheirMap) {
  const MapId other = edit_.new_map(Why::kStartedAlone, 1);
  for (int i = 0; i < 4; ++i) {
    sim_.ingest();
    sim_.place(kCam0, other, Rigid3());
    sim_.place_truly(kCam1);
  }
  edit_.take_frames(camera(kCam0), SetId(8), {});
  ASSERT_EQ(camera(kCam0).past.placed.size(), 2U);
  EXPECT_EQ(camera(kCam0).frames_in_map(sim_.id), 6);
  EXPECT_EQ(camera(kCam0).frames_in_map(other), 4);
  edit_.merge(other, sim_.id, Similarity3());
  EXPECT_EQ(camera(kCam0).frames_in_map(sim_.id), 10);
  EXPECT_EQ(camera(kCam0).frames_in_map(other), 0);
}

TEST_F(MapsPenTest, AThirdMapStaysAsItIs) {
  const MapId second = edit_.new_map(Why::kStartedAlone, 1), third = edit_.new_map(Why::kStartedAlone, 1);
  const Eigen::Vector3d place(1, 2, 5);
  const MapPoint &of_first = sim_.create(sim_.id, place), &of_second = sim_.create(second, place),
                 &of_third = sim_.create(third, place);
  const Similarity3 move{2, so3_exp({0, 0.2, 0}), {3, 0, 0}};
  edit_.merge(second, sim_.id, move);
  EXPECT_EQ(of_first.position, place);
  EXPECT_THAT(of_second.position, VectorNear(move * place, 1e-12));
  EXPECT_EQ(of_second.map, sim_.id);
  EXPECT_EQ(of_third.position, place);
  EXPECT_EQ(of_third.map, third);
  edit_.transform(third, move, Why::kScaleKnown);
  EXPECT_EQ(of_first.position, place);
  EXPECT_THAT(of_third.position, VectorNear(move * place, 1e-12));
}

TEST_F(MapsPenTest, EveryMoveOfAMapIsRememberedForWhatWasArchivedBefore) {
  const MapId second = edit_.new_map(Why::kStartedAlone, 1);
  const Similarity3 move{2, so3_exp({0, 0.2, 0}), {3, 0, 0}};
  edit_.transform(second, move, Why::kScaleKnown);
  edit_.merge(second, sim_.id, move.inverse());
  ASSERT_EQ(sim_.map.moves().size(), 2U);
  EXPECT_EQ(sim_.map.moves()[0].from, second);
  EXPECT_EQ(sim_.map.moves()[0].into, second);
  EXPECT_EQ(sim_.map.moves()[1].from, second);
  EXPECT_EQ(sim_.map.moves()[1].into, sim_.id);
  EXPECT_DOUBLE_EQ(sim_.map.moves()[1].into_from_from.scale, 0.5);
}

}  // namespace
}  // namespace coslam::maps_pen_test
