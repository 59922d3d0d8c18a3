// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/key_image_database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/estimator/places/scene_shape.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::key_image_database_test {
namespace {

using test::cam;
using test::PoseNear;

class HasReliefTest : public testing::Test {
 protected:
  void add(const Eigen::Vector3d& position, double sigma = 0.001) {
    MapPoint p;
    p.position = position;
    p.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    points_.push_back(p);
  }
  void add_poster() {
    for (int i = 0; i < 60; ++i) add({0.03 * i, 0.5 * std::sin(i), 3 + 0.02 * i + 0.01 * std::cos(7 * i)});
  }
  bool relief() const {
    std::vector<const MapPoint*> points;
    for (const MapPoint& p : points_) points.push_back(&p);
    return has_relief(points, 3);
  }
  std::vector<MapPoint> points_;
};

TEST(CoversGround, WiderThanAnyPrintBothWays) {
  std::vector<MapPoint> points(200);
  const auto covers = [&](double along_m, double across_m, std::size_t count) {
    std::vector<const MapPoint*> out;
    for (std::size_t i = 0; i < count; ++i) {
      const double a = static_cast<double>(i % 20) / 19, b = static_cast<double>(i / 20) / 9;
      points[i].position = {along_m * a, 1, across_m * b};
      out.push_back(&points[i]);
    }
    return covers_ground(out, 10);
  };
  EXPECT_TRUE(covers(40, 10, 200));
  EXPECT_FALSE(covers(25, 10, 200)) << "as an image shows it";
  EXPECT_FALSE(covers(40, 3, 200)) << "a line";
  EXPECT_FALSE(covers(40, 10, 60)) << "a few points";
}

TEST_F(HasReliefTest, NothingHasNone) { EXPECT_FALSE(relief()); }

TEST_F(HasReliefTest, APosterHasNone) {
  add_poster();
  EXPECT_FALSE(relief());
}

TEST_F(HasReliefTest, SomethingBeforeThePosterIs) {
  add_poster();
  for (int i = 0; i < 10; ++i) add({0.09 * i, 0.5 * std::cos(i), 2.2 + 0.02 * i});
  EXPECT_TRUE(relief());
}

TEST_F(HasReliefTest, PointsOfUncertainDepthTellNothing) {
  add_poster();
  for (int i = 0; i < 20; ++i) add({0.09 * i, 0.5 * std::cos(i), 2.2 + 0.02 * i}, 0.5);
  EXPECT_FALSE(relief());
}

// Camera 0 has a map and remembers an image; camera 1 sees the same from beside, and has none.
class PlaceMemoryTest : public testing::Test {
 protected:
  PlaceMemoryTest() {
    sim_.ingest(false, true);
    sim_.place_truly(cam(0));
    sim_.add_points();
    blur_looks(sim_.set.frames[0], 0);
    blur_looks(sim_.set.frames[1], 1);
    places_.add(sim_.edit, newest_image(sim_.map.camera(cam(0))), *sim_.set.frames[0].descriptors);
  }
  // Of the points of the world but each eighth, those with neighbouring numbers look alike.
  void blur_looks(CameraFrame& frame, int camera) const {
    DescriptorReply& reply = *frame.descriptors;
    for (std::size_t i = 0; i < reply.tracks.size(); ++i) {
      const int point = sim_.world_point(cam(camera), reply.tracks[i]);
      if (point < 0 || point % 8 == 0) continue;
      const auto at = reply.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
      std::fill(at, at + kDescriptorBytes, static_cast<std::uint8_t>(1));
      for (int k = 0; k < 8; ++k) at[(31 * (point / 2 % 40) + 7 * k) % kDescriptorBytes] = 90;
    }
  }
  std::optional<PlaceMatch> find() const {
    return places_.find(sim_.map, newest_image(sim_.map.camera(cam(1))), *sim_.set.frames[1].descriptors,
                        [](const KeyImage&, MapId) { return true; });
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  KeyImageDatabase places_{RecogniseConfig{}};
};

TEST_F(PlaceMemoryTest, WhereThePoseSaysLooksNeedNotBeTheOnlyOnesOfTheirKind) {
  const auto seen = find();
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->map, sim_.id);
  EXPECT_THAT(seen->cam_from_world, PoseNear(sim_.truth(cam(1), sim_.set.id), 0.005, 0.02));
  int alike = 0, wrong = 0;
  for (const auto& [track, point] : seen->matches) {
    const int shown = sim_.world_point(cam(1), track);
    alike += shown % 8 != 0;
    wrong += shown != sim_.world_point(*sim_.map.find(point));
  }
  EXPECT_GT(alike, 40) << "of " << seen->matches.size();
  EXPECT_EQ(wrong, 0);
}

TEST_F(PlaceMemoryTest, TellsWhoseMapsItRemembers) {
  EXPECT_THAT(places_.maps(sim_.map), testing::ElementsAre(sim_.id));
  EXPECT_THAT(KeyImageDatabase(RecogniseConfig{}).maps(sim_.map), testing::IsEmpty());
}

}  // namespace
}  // namespace coslam::key_image_database_test
