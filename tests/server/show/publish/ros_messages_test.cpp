// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/ros_messages.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>

#include "common/ros/convert.h"

namespace coslam::ros_messages_test {
namespace {

constexpr double kUnknown = 1e5;  // variances beyond it say that nobody knows

Eigen::Matrix<double, 6, 6> matrix_of(const ros::Covariance36& covariance) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance.data());
}

// A camera somewhere, looking somewhere.
PublicPose some_pose() {
  PublicPose pose{.agent = "left", .map = MapId(1), .capture_ns = 1'250'000'000};
  pose.cam_from_map = {so3_exp({0.3, -1.1, 0.5}), {1, 2, 3}};
  pose.cam_from_odom = {so3_exp({-0.2, 0.4, 0.9}), {0.5, 0, -1}};
  return pose;
}

// Not the same along any two axes, in the order of retract().
PoseCovariance some_covariance() {
  PoseCovariance out = PoseCovariance::Zero();
  out.diagonal() << 1e-4F, 2e-4F, 3e-4F, 0.01F, 0.04F, 0.09F;
  out(0, 3) = out(3, 0) = 2e-4F;
  return out;
}

// By many errors of the pose, drawn from its covariance, that move the camera in the world.
TEST(PoseInMap, ItsCovarianceIsThatOfThePlaceOfTheCameraInTheMap) {
  PublicPose pose = some_pose();
  pose.covariance = some_covariance();
  const auto told = matrix_of(pose_in_map(pose, MapId(1)).pose.covariance);
  const Eigen::Matrix<double, 6, 6> root = some_covariance().cast<double>().llt().matrixL();
  const Rigid3 map_from_cam = pose.cam_from_map.inverse();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, 6> drawn = Eigen::Matrix<double, 6, 6>::Zero();
  constexpr int kDraws = 20'000;
  for (int i = 0; i < kDraws; ++i) {
    const Vector6d error = root * Vector6d::NullaryExpr([&] { return normal(random); });
    const Rigid3 moved = retract(pose.cam_from_map, error).inverse();
    Vector6d seen;
    seen << moved.translation - map_from_cam.translation, so3_log(moved.rotation * map_from_cam.rotation.conjugate());
    drawn += seen * seen.transpose() / kDraws;
  }
  EXPECT_LT((told - drawn).norm(), 0.04 * drawn.norm());
  EXPECT_LT((told - told.transpose()).norm(), 1e-9);
}

TEST(PoseInMap, AMapThatHasNotMetTheMainOneHasItsOwnFrame) {
  PublicPose pose = some_pose();
  EXPECT_EQ(pose_in_map(pose, MapId(1)).header.frame_id, "map");
  pose.map = MapId(4);
  const ros::PoseWithCovarianceStamped told = pose_in_map(pose, MapId(1));
  EXPECT_EQ(told.header.frame_id, "map_4");
  EXPECT_EQ(told.header.stamp.sec, 1);
  EXPECT_EQ(told.header.stamp.nanosec, 250'000'000U);
  EXPECT_GT(matrix_of(told.pose.covariance).diagonal().minCoeff(), kUnknown);
}

TEST(Odometry, WithoutAVelocityNothingIsKnownOfIt) {
  RosNames names;
  const ros::Odometry told = odometry(some_pose(), names);
  EXPECT_EQ(told.twist.twist.linear.x, 0);
  EXPECT_GT(matrix_of(told.twist.covariance).diagonal().minCoeff(), kUnknown);
  PublicPose moving = some_pose();
  moving.velocity = PublicVelocity{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.1};
  const ros::Odometry unsure = odometry(moving, names);
  EXPECT_EQ(unsure.twist.twist.linear.x, 0.3) << "ahead is the camera's z";
  EXPECT_GT(matrix_of(unsure.twist.covariance).diagonal().minCoeff(), kUnknown) << "it has no covariance";
}

TEST(Odometry, TheVarianceOfAVelocityIsThatOfTwoPosesOverTheirTime) {
  RosNames names;
  PublicPose pose = some_pose();
  pose.covariance = some_covariance();
  pose.velocity = PublicVelocity{.over_s = 0.2};
  const auto told = matrix_of(odometry(pose, names).twist.covariance);
  constexpr double kFactor = 2 / (0.2 * 0.2);
  EXPECT_NEAR(told(0, 0), kFactor * 0.09, 1e-6) << "a body's x is the camera's z";
  EXPECT_NEAR(told(1, 1), kFactor * 0.01, 1e-6);
  EXPECT_NEAR(told(2, 2), kFactor * 0.04, 1e-6);
  EXPECT_NEAR(told(3, 3), kFactor * 3e-4, 1e-6);
  EXPECT_NEAR(told(4, 4), kFactor * 1e-4, 1e-6);
  EXPECT_NEAR(told(5, 5), kFactor * 2e-4, 1e-6);
}

TEST(PathMessage, EachPoseHasItsTimeAndAllHaveOneFrame) {
  const PublicPath path{.agent = "left",
                        .map = MapId(2),
                        .cam_from_map = {{1'000'000'000, Rigid3()}, {2'000'000'000, some_pose().cam_from_map}},
                        .key_cam_from_map = {}};
  const ros::Path told = coslam::path(path, {3'000'000'000, MapId(1)});
  EXPECT_EQ(told.header.stamp.sec, 3);
  ASSERT_EQ(told.poses.size(), 2U);
  EXPECT_EQ(told.poses[0].header.stamp.sec, 1);
  EXPECT_EQ(told.poses[1].header.frame_id, "map_2");
  const Eigen::Vector3d center = some_pose().cam_from_map.center();
  EXPECT_NEAR(told.poses[1].pose.position.y, center.y(), 1e-12);
  EXPECT_TRUE(key_frames(path, {3'000'000'000, MapId(1)}).poses.empty());
}

TEST(MovingMessages, OfOtherMapsThereAreObjectsAlone) {
  PublicMoving moving{{1'000'000'000, MapId(1)}, {}};
  moving.maps[MapId(2)].points.push_back({{1, 2, 3}, 0.1F, PointId(7), ObjectId(2)});
  moving.maps[MapId(2)].objects.push_back({ObjectId(2), {1, 2, 3}, {0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(moving_cloud(moving).width, 0U) << "the main map has no moving point";
  EXPECT_EQ(moving_cloud(moving).header.frame_id, "map");
  EXPECT_TRUE(object_detections(moving).detections.empty());
  const ros::MarkerArray markers = object_markers(moving);
  EXPECT_TRUE(std::ranges::any_of(markers.markers, [](const ros::Marker& m) { return m.header.frame_id == "map_2"; }));
}

TEST(MovingMessages, AnEmptyInstantHasEmptyMessages) {
  const PublicMoving nothing;
  EXPECT_EQ(moving_cloud(nothing).width, 0U);
  EXPECT_TRUE(object_detections(nothing).detections.empty());
  RosNames names;
  EXPECT_TRUE(tf_message({}, names).transforms.empty());
  EXPECT_EQ(static_cloud({}).width, 0U);
}

}  // namespace
}  // namespace coslam::ros_messages_test
