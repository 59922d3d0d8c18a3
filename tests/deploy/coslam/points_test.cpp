// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace coslam::eval::points_test {
namespace {

TEST(StaticTruth, TakesTheMedianAndLeavesOutWhatScatters) {
  StaticTruth truth;
  for (const double x : {1.0, 1.01, 1.02}) truth.add(PointId(1), {{x, 0, 5}, 5});
  truth.add(PointId(2), {{0, 0, 5}, 5});                                         // seen once
  for (const double z : {5.0, 5.0, 5.3}) truth.add(PointId(3), {{0, 0, z}, 5});  // an edge of depth
  const auto positions = truth.positions();
  EXPECT_EQ(truth.points(), 3u);
  ASSERT_EQ(positions.size(), 1u);
  EXPECT_LT((positions.at(PointId(1)) - Eigen::Vector3d(1.01, 0, 5)).norm(), 1e-12);
}

TEST(StaticTruth, LeavesOutWhatMostlyLiesOnAnEdgeOfDepth) {
  StaticTruth truth;
  SurfacePoint on, off;
  on.position = off.position = {0, 0, 5};
  on.distance_m = off.distance_m = 5;
  on.on_depth_edge = true;
  for (const int of_three : {0, 1, 2}) {
    truth.add(PointId(1), of_three < 1 ? on : off);
    truth.add(PointId(2), of_three < 2 ? on : off);
  }
  const auto positions = truth.positions();
  EXPECT_TRUE(positions.contains(PointId(1)));
  EXPECT_FALSE(positions.contains(PointId(2)));
}

TEST(DepthEdge, AStepIsOneAndASlantIsNone) {
  const auto slant_m = [](const Eigen::Vector2d& by_px) { return 1 / (0.2 + 0.01 * by_px.x() - 0.02 * by_px.y()); };
  EXPECT_FALSE(is_on_depth_edge(5, slant_m));
  const auto step_m = [](const Eigen::Vector2d& by_px) { return by_px.x() > 0 ? 4.5 : 5; };
  EXPECT_TRUE(is_on_depth_edge(5, step_m));
  const auto ends_m = [](const Eigen::Vector2d& by_px) {
    return by_px.y() < 0 ? std::numeric_limits<double>::infinity() : 5;
  };
  EXPECT_TRUE(is_on_depth_edge(5, ends_m));
}

TEST(PointAccuracy, ByHand) {
  // The map is the truth at a tenth of its size, turned by a quarter about z: (x, y, z) m is (y, -x, z) / 10.
  const Similarity3 truth_from_map{10, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())),
                                   Eigen::Vector3d::Zero()};
  ResultPoint point;
  point.id = PointId(1);
  point.position = {0.2, -0.11, 0.3};  // (1.1, 2, 3) m
  point.covariance =
      Eigen::Vector3d(1, 4e-4, 1).asDiagonal();  // sigma 0.02 along the map's y: 0.2 m along the truth's x
  std::vector<ResultPoint> points = {point, point, point};
  points[1].state = PointState::kDynamic;
  points[2].id = PointId(7);  // has no truth
  const auto accuracy = accuracy_of(points, {{PointId(1), {1, 2, 3}}}, truth_from_map);
  EXPECT_EQ(accuracy.count, 1);
  EXPECT_NEAR(accuracy.error_median_m, 0.1, 1e-12);
  EXPECT_NEAR(accuracy.nees_median, 0.25, 1e-9);  // (0.1 / 0.2)^2
}

TEST(PointAccuracy, HonestCovariancesHaveTheNeesOfChiSquare) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d root = (Eigen::Matrix3d() << 0.02, 0, 0, 0.01, 0.03, 0, 0, 0.02, 0.2).finished();
  std::vector<ResultPoint> points;
  std::unordered_map<PointId, Eigen::Vector3d> truth;
  for (std::uint32_t i = 1; i <= 4000; ++i) {
    ResultPoint point;
    point.id = PointId(i);
    point.position = {normal(random), normal(random), normal(random)};
    point.covariance = root * root.transpose();
    truth[point.id] = point.position + root * Eigen::Vector3d(normal(random), normal(random), normal(random));
    points.push_back(point);
  }
  const auto accuracy = accuracy_of(points, truth, Similarity3());
  EXPECT_EQ(accuracy.nees_count, 4000);
  EXPECT_NEAR(accuracy.nees_median, 2.37, 0.15);
  EXPECT_NEAR(accuracy.nees_p90, 6.25, 0.4);
}

TEST(PointAccuracy, SingularCovariancesHaveNoNees) {
  ResultPoint point;
  point.id = PointId(1);
  const auto accuracy = accuracy_of({point}, {{PointId(1), {1, 0, 0}}}, Similarity3());
  EXPECT_EQ(accuracy.count, 1);
  EXPECT_EQ(accuracy.nees_count, 0);
}

}  // namespace
}  // namespace coslam::eval::points_test
