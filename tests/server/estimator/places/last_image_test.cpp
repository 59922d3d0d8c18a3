// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "server/estimator/places/place_recognition.h"
#include "tests/support/sim_map.h"

namespace coslam::last_image_test {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

// A camera whose run is about to end.
class LastImageTest : public testing::Test {
 protected:
  LastImageTest() {
    see();
    take();
  }
  // The next frame set; what its image shows goes apart.
  void see() { last_ = *sim_.look(false, true).frames[0].descriptors; }
  void take() {
    sim_.set.frames[0].descriptors.reset();
    sim_.take();
    sim_.place_truly();
    sim_.add_points();
  }
  bool remember() { return meetings_.remember_last(sim_.edit, CameraId(0), last_); }
  std::vector<const KeyImage*> remembered() const { return meetings_.places().images_of(sim_.map, sim_.id); }

  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, test::paths_side_by_side(1)};
  PlaceRecognition meetings_{{}};
  DescriptorReply last_;
};

TEST_F(LastImageTest, WhatItShowsIsAKnownPlace) {
  see();
  EXPECT_FALSE(remember()) << "its frame is still under way";
  EXPECT_THAT(remembered(), IsEmpty());
  take();
  EXPECT_TRUE(remember());
  ASSERT_THAT(remembered(), SizeIs(1));
  EXPECT_EQ(remembered()[0]->set, sim_.set.id);
  EXPECT_EQ(remembered()[0]->tracks, last_.tracks);
  EXPECT_GT(sim_.map.points_observed_at({sim_.set.id}).size(), 100U) << "its points are held for it";
}

TEST_F(LastImageTest, OneThatIsNotTheLastIsNone) {
  const DescriptorReply before = last_;
  see();
  take();
  last_ = before;
  EXPECT_TRUE(remember());
  EXPECT_THAT(remembered(), IsEmpty());
}

TEST_F(LastImageTest, OneOfARunBeforeIsNone) {
  last_.agent_run = RunId(last_.agent_run.value + 1);
  EXPECT_TRUE(remember());
  EXPECT_THAT(remembered(), IsEmpty());
}

}  // namespace
}  // namespace coslam::last_image_test
