// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/announce_moving.h"

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam::announce_moving_test {
namespace {

class MovingWriterTest : public testing::Test {
 protected:
  MovingWriterTest() : sim_(world_, test::paths_side_by_side(2)) { sim_.advance(); }
  // A moving point at the n-th of the world's points that both cameras see.
  const MapPoint& moving_point(double sigma = 0.05) {
    while (!sim_.all_follow(next_)) ++next_;
    return sim_.add_point(next_++, sigma, Eigen::Vector3d::Zero(), PointPhase::kMoving);
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  MovingWriter writer_{RunId(7)};
  int next_ = 0;
};

TEST_F(MovingWriterTest, NothingThatMovesNothingToSay) {
  sim_.add_points();
  EXPECT_TRUE(writer_.write(sim_.map, {}, {sim_.id}).empty());
}

TEST_F(MovingWriterTest, PointsWithTheirObjectsAndOneEmptyStateAfterwards) {
  const PointId first = moving_point().id, second = moving_point().id;
  MovingObject object{ObjectId(3), sim_.id, {}, {first}};
  object.motion.velocity.x() = 1.5;
  auto states = writer_.write(sim_.map, {object}, {sim_.id});
  ASSERT_EQ(states.size(), 1U);
  const MovingState& s = states[0];
  EXPECT_EQ(s.server_run, RunId(7));
  EXPECT_EQ(s.map, sim_.id);
  EXPECT_EQ(s.epoch, sim_.map.epoch());
  EXPECT_EQ(s.t_ns, sim_.set.t_ns);
  EXPECT_TRUE(s.scale_known);
  EXPECT_EQ(s.left_out, 0U);
  ASSERT_EQ(s.objects.size(), 1U);
  EXPECT_EQ(s.objects[0].object, ObjectId(3));
  EXPECT_EQ(s.objects[0].velocity_per_s.x(), 1.5f);
  EXPECT_EQ(s.objects[0].points, 1);
  ASSERT_EQ(s.points.size(), 2U);
  for (const MovingPointState& p : s.points) {
    EXPECT_EQ(p.object, p.point == first ? ObjectId(3) : ObjectId());
    EXPECT_EQ(p.position, sim_.map.find(p.point)->position.cast<float>());
    EXPECT_EQ(p.cameras, 2);
  }
  for (const PointId id : {first, second}) sim_.edit.remove_point(*sim_.map.find(id), Why::kOutOfSight);
  states = writer_.write(sim_.map, {}, {});
  ASSERT_EQ(states.size(), 1U);
  EXPECT_TRUE(states[0].points.empty() && states[0].objects.empty());
  EXPECT_FALSE(states[0].scale_known);
  EXPECT_TRUE(writer_.write(sim_.map, {}, {sim_.id}).empty());
}

TEST_F(MovingWriterTest, TheMostCertainPointsAreKept) {
  for (int i = 0; i < 40; ++i) moving_point(0.01 * (40 - i));
  const MovingState s = writer_.write(sim_.map, {}, {sim_.id}).at(0);
  EXPECT_EQ(s.points.size(), most_moving_points(0));
  EXPECT_EQ(s.left_out, 40 - most_moving_points(0));
  EXPECT_NEAR(s.points.front().covariance[0], 1e-4, 1e-8);
}

TEST_F(MovingWriterTest, APointThatIsNotSeenNowIsNotTold) {
  moving_point();
  sim_.advance(2);
  EXPECT_TRUE(writer_.write(sim_.map, {}, {sim_.id}).empty());
}

}  // namespace
}  // namespace coslam::announce_moving_test
