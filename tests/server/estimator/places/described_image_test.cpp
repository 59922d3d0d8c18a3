// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/described_image.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/estimator/places/place_recognition.h"
#include "tests/server/estimator/places/place_stages.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::described_image_test {
namespace {

using test::cam;

// A camera whose tracks live for about half a second.
class DescribedImageTest : public testing::Test {
 protected:
  DescribedImageTest() : sim_(world_, test::paths_side_by_side(1), {.ends = 0.07}) {}
  // says: what the frame says of its descriptors.
  void step(DescriptorsSent says = DescriptorsSent::kNone) {
    CameraFrame& cf = sim_.look(false, says != DescriptorsSent::kNone).frames[0];
    cf.frame.descriptors_sent = says;
    if (says == DescriptorsSent::kLater) reply_ = std::exchange(cf.descriptors, std::nullopt);
    sim_.take();
    sim_.place_truly();
    sim_.add_points();
    awaited_.await(sim_.edit, sim_.set.frames[0]);
  }
  const MapCamera& camera() const { return sim_.map.camera(cam(0)); }
  // The reply comes with the newest frame.
  DescribedImage take() {
    CameraFrame cf = sim_.set.frames[0];
    cf.descriptors = reply_;
    DescribedImage image = awaited_.image_of(sim_.map, cf);
    awaited_.came(cf);
    return image;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  AwaitedDescriptors awaited_;
  std::optional<DescriptorReply> reply_;
};

TEST_F(DescribedImageTest, DescriptorsThatComeLateAreOfTheirImage) {
  step();
  step(DescriptorsSent::kLater);
  const DescribedImage then = newest_image(camera());
  ASSERT_GT(then.points.size(), 100U);
  for (int i = 0; i < 45; ++i) step();
  const auto live =
      std::ranges::count_if(then.pixels, [&](const auto& p) { return camera().tracks.contains(p.first); });
  ASSERT_LT(live, 0.2 * static_cast<double>(then.pixels.size())) << "most tracks have ended";
  const DescribedImage image = take();
  EXPECT_EQ(image.set, then.set);
  EXPECT_EQ(image.pixels, then.pixels);
  EXPECT_GE(image.points.size(), 0.95 * static_cast<double>(then.points.size()));
  for (const auto& [track, point] : image.points) {
    EXPECT_EQ(sim_.world_point(*sim_.map.find(point)), sim_.world_point(cam(0), track));
  }
  EXPECT_EQ(take().set, sim_.set.id) << "once";
}

TEST_F(DescribedImageTest, WhatBecameOnePointSinceIsThatPoint) {
  step();
  step(DescriptorsSent::kLater);
  const auto [track, point] = *newest_image(camera()).points.begin();
  const PointId older = sim_.create(sim_.map.find(point)->position).id;
  sim_.edit.fuse(older, point, Why::kOneCorner, {});
  step();
  EXPECT_EQ(take().points.at(track), older);
}

TEST_F(DescribedImageTest, ThoseOfAnImageThatIsNotKnownAreOfTheNewest) {
  step();
  step(DescriptorsSent::kWithFrame);
  reply_ = sim_.set.frames[0].descriptors;
  step();
  EXPECT_EQ(take().set, sim_.set.id);
}

TEST_F(DescribedImageTest, AnImageFromBeforeTheCameraLeftItsMapIsOfNoUse) {
  step();
  step(DescriptorsSent::kLater);
  sim_.edit.leave_map(camera());
  const MapId other = sim_.edit.new_map(Why::kStartedAlone, 1);
  sim_.ingest();
  sim_.place(cam(0), other, Rigid3());
  EXPECT_EQ(take().set, sim_.set.id);
}

TEST_F(DescribedImageTest, IsForgottenWhenNothingComes) {
  step();
  step(DescriptorsSent::kLater);
  const SetId at = sim_.set.id;
  EXPECT_TRUE(sim_.map.keeps_observations_of(at, cam(0)));
  for (int i = 0; i < 160; ++i) step();
  EXPECT_FALSE(sim_.map.keeps_observations_of(at, cam(0)));
  EXPECT_EQ(take().set, sim_.set.id);
}

TEST_F(DescribedImageTest, OneThatNeverSendsWhatItAnnouncesCostsLittle) {
  step();
  step(DescriptorsSent::kLater);
  const SetId at = sim_.set.id;
  for (int i = 0; i < 8; ++i) step(DescriptorsSent::kLater);
  EXPECT_FALSE(sim_.map.keeps_observations_of(at, cam(0)));
}

// Two cameras in maps of their own recognise each other's places, though descriptors come after a second and a half,
// when three tracks of four have ended.
TEST(MeetLateTest, MapsMeetThoughDescriptorsComeLate) {
  const test::SimWorld world{{}};
  test::SimMap sim(world, test::paths_side_by_side(2), {.ends = 0.03});
  test::PlaceStages stages;
  const MapId own = sim.edit.new_map(Why::kStartedAlone, 1);
  const Similarity3 own_from_world{2, so3_exp({0.1, 0.4, 0}), {1, 2, 3}};
  std::map<std::uint32_t, std::vector<CameraFrame>> under_way;  // by the set that they come with
  int merged = 0;
  for (int i = 0; i < 150 && merged == 0; ++i) {
    FrameSet& set = sim.look(false, i % 15 == 0);
    for (CameraFrame& cf : set.frames) {
      if (!cf.descriptors) continue;
      under_way[set.id.value + 45].push_back(cf);
      cf.frame.descriptors_sent = DescriptorsSent::kLater;
      cf.descriptors.reset();
    }
    for (CameraFrame& late : under_way[set.id.value]) {
      std::ranges::find(set.frames, late.camera, &CameraFrame::camera)->descriptors = late.descriptors;
    }
    sim.take();
    sim.place_truly(cam(0));
    sim.place(cam(1), own, transform_world(sim.truth(cam(1), set.id), own_from_world));
    for (int p = 0; p < world.size(); ++p) {
      const ServerTrack *first = sim.track_of(cam(0), p), *second = sim.track_of(cam(1), p);
      if (first != nullptr && !first->bound()) sim.bind(sim.create(world.position(p)), cam(0), *first);
      if (second != nullptr && !second->bound())
        sim.bind(sim.create(own, own_from_world * world.position(p)), cam(1), *second);
    }
    merged += stages.run(sim.edit, sim.set, view_graph(sim.map, sim.set)).merged;
  }
  ASSERT_EQ(merged, 1);
  EXPECT_EQ(sim.map.camera(cam(0)).map, sim.map.camera(cam(1)).map);
}

}  // namespace
}  // namespace coslam::described_image_test
