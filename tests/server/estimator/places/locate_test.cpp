// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/locate.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

#include "server/estimator/places/key_image_database.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::locate_test {
namespace {

using test::cam;
using test::PoseNear;

// Camera 0 remembers two images; camera 1 sees the same from beside.
class LocateTest : public testing::Test {
 protected:
  LocateTest() {
    for (int i = 0; i < 2; ++i) {
      sim_.ingest(false, true);
      sim_.place_truly(cam(0));
      sim_.add_points();
      places_.add(sim_.edit, newest_image(sim_.map.camera(cam(0))), *sim_.set.frames[0].descriptors);
    }
    images_ = places_.images_of(sim_.map, sim_.id);
  }
  void SetUp() override { ASSERT_EQ(images_.size(), 2U); }
  FeaturesOfImage features() const {
    return features_of(newest_image(sim_.map.camera(cam(1))), *sim_.set.frames[1].descriptors);
  }
  Rigid3 truth() const { return sim_.truth(cam(1), sim_.set.id); }
  KnownPoints known() const { return known_points(sim_.map, sim_.id, images_); }
  static bool any(PointId) { return true; }
  // Matches of which the track and the point are not of one place of the world.
  int wrong_in(const Matched& matched, const KnownPoints& known) const {
    int wrong = 0;
    for (std::size_t i = 0; i < matched.tracks.size(); ++i) {
      const PointId id = known.ids[static_cast<std::size_t>(matched.known[i])];
      wrong += sim_.world_point(cam(1), matched.tracks[i]) != sim_.world_point(*sim_.map.find(id));
    }
    return wrong;
  }

  const test::SimWorld world_{{.points = 200}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  KeyImageDatabase places_{RecogniseConfig{}};
  std::vector<const KeyImage*> images_;
};

TEST_F(LocateTest, KnownPointsAreThoseThatRestAndWereDescribed) {
  const KnownPoints all = known();
  ASSERT_GT(all.ids.size(), 60U);
  EXPECT_EQ(all.positions.size(), all.ids.size());
  EXPECT_EQ(all.images.size(), all.ids.size());
  EXPECT_EQ(all.descriptors.size(), all.ids.size() * kDescriptorBytes);
  EXPECT_TRUE(std::ranges::is_sorted(all.ids));
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    EXPECT_EQ(all.positions[i], sim_.map.find(all.ids[i])->position);
  }
  sim_.set_moving(*sim_.map.find(all.ids[0]));
  EXPECT_EQ(known().ids, std::vector(all.ids.begin() + 1, all.ids.end()));
  EXPECT_TRUE(known_points(sim_.map, MapId(9), images_).ids.empty()) << "they are of this map";
  EXPECT_TRUE(known_points(sim_.map, sim_.id, {}).ids.empty());
}

TEST_F(LocateTest, APointLooksAsInTheBestImageThatShowsIt) {
  const std::vector<const KeyImage*> newest_first{images_[1], images_[0]};
  const KnownPoints forward = known(), backward = known_points(sim_.map, sim_.id, newest_first);
  EXPECT_EQ(forward.ids, backward.ids);
  const auto of_first = [](const KnownPoints& k) { return std::ranges::count(k.images, 0); };
  EXPECT_GT(of_first(forward), 60);
  EXPECT_GT(of_first(backward), 60) << "most are in both images";
  for (std::size_t i = 0; i < forward.ids.size(); ++i) {
    const MapPoint& p = *sim_.map.find(forward.ids[i]);
    const KeyImage& image = *images_[static_cast<std::size_t>(forward.images[i])];
    EXPECT_TRUE(std::ranges::any_of(
        p.key_observations, [&](const KeyObservation& o) { return o.set == image.set && o.camera == image.camera; }));
  }
}

TEST_F(LocateTest, NearWhereThePoseHasThemPointsAreMatchedByTheirLooks) {
  const KnownPoints points = known();
  const NearMatches matches = match_near(features(), truth(), points, any);
  EXPECT_GT(matches.tracks.size(), 40U);
  EXPECT_EQ(wrong_in(matches, points), 0);
  ASSERT_EQ(matches.off_px.size(), matches.tracks.size());
  EXPECT_LT(test::median(matches.off_px), 5);
  const Rigid3 far_off = truth() * Rigid3(Eigen::Quaterniond::Identity(), {0, 1.5, 0});
  EXPECT_LT(match_near(features(), far_off, points, any).tracks.size(), matches.tracks.size() / 4);
  const PointId one = points.ids[static_cast<std::size_t>(matches.known.front())];
  const NearMatches few = match_near(features(), truth(), points, [&](PointId id) { return id == one; });
  ASSERT_EQ(few.tracks.size(), 1U);
  EXPECT_EQ(few.tracks[0], matches.tracks[0]);
}

TEST_F(LocateTest, FeaturesWithoutAPlaceOrAnImageWithoutAnyMatchNothing) {
  FeaturesOfImage blank = features();
  blank.pixels.clear();
  EXPECT_TRUE(match_near(blank, truth(), known(), any).tracks.empty());
  EXPECT_TRUE(match_near(features(), truth(), KnownPoints(), any).tracks.empty());
}

TEST_F(LocateTest, TheMatchesTellThePoseAndWhichImageShowsIt) {
  const KnownPoints points = known();
  const NearMatches matches = match_near(features(), truth(), points, any);
  const auto place = locate(sim_.map, cam(1), images_, sim_.id, points, matches, {1.5, 12, 0.08});
  ASSERT_TRUE(place);
  EXPECT_EQ(place->map, sim_.id);
  EXPECT_EQ(place->key_camera, cam(0));
  EXPECT_TRUE(place->key_set == images_[0]->set || place->key_set == images_[1]->set);
  EXPECT_THAT(place->cam_from_world, PoseNear(truth(), 0.005, 0.03));
  EXPECT_GT(place->matches.size(), 40U);
  EXPECT_GT(place->median_depth, 2);
  EXPECT_LT(place->median_depth, 10);
}

TEST_F(LocateTest, TooFewMatchesOrTooSmallAPartOfTheImageTellNone) {
  const KnownPoints points = known();
  const NearMatches matches = match_near(features(), truth(), points, any);
  const auto found = [&](const Matched& matched, const Agreement& wanted) {
    return locate(sim_.map, cam(1), images_, sim_.id, points, matched, wanted).has_value();
  };
  EXPECT_TRUE(found(matches, {1.5, 12, 0.08}));
  EXPECT_FALSE(found(matches, {1.5, static_cast<int>(matches.tracks.size()) + 1, 0.08}));
  EXPECT_FALSE(found(matches, {1.5, 12, 1.01})) << "more than all of it";
  EXPECT_FALSE(found({}, {1.5, 7, 0}));
  Matched shuffled = matches;
  std::ranges::reverse(shuffled.known);
  EXPECT_FALSE(found(shuffled, {1.5, 12, 0.08}));
}

TEST_F(LocateTest, TwiceIsFromLooksAloneToAPose) {
  const auto place = locate_twice(sim_.map, images_, sim_.id, features(), {});
  ASSERT_TRUE(place);
  EXPECT_THAT(place->cam_from_world, PoseNear(truth(), 0.005, 0.03));
  EXPECT_FALSE(locate_twice(sim_.map, images_, MapId(9), features(), {}));
  RecogniseConfig strict;
  strict.min_first = 10'000;
  EXPECT_FALSE(locate_twice(sim_.map, images_, sim_.id, features(), strict));
}

}  // namespace
}  // namespace coslam::locate_test
