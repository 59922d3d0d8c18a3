// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/bridge/px4_odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "common/ros/cdr.h"

namespace coslam::px4_odometry_test {
namespace {

constexpr TimeNs kFrame_ns = 33'333'333;
constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000;

// A vehicle that flies as the test says, and what PX4 hears of it.
class Px4Test : public testing::Test {
 protected:
  explicit Px4Test(const Px4Config& config = {.agent = "cam0"}, const MapLevel& level = {}) : px4_(config, level) {
    told();
  }

  void told(bool scale_known = true, std::uint32_t epoch = 1, PoseState state = PoseState::kTracked) {
    AgentPose pose{"cam0", RunId(1), RunId(2), t_ns_, map_, MapEpoch(epoch), state, scale_known, {}};
    epoch_ = MapEpoch(epoch);
    px4_.see(pose);
  }

  TrackFrame frame(const Rigid3& map_from_cam) {
    TrackFrame f;
    f.agent = "cam0";
    f.agent_run = RunId(1);
    f.server_run = RunId(2);
    f.epoch = epoch_;
    f.capture_ns = t_ns_;
    f.pose_state = PoseState::kTracked;
    f.cam_from_world = map_from_cam.inverse();
    f.pose_covariance.diagonal().setConstant(1e-4F);
    f.pose_inliers = 80;
    t_ns_ += kFrame_ns;
    return f;
  }

  Px4Odometry::Answer at(const Rigid3& map_from_cam, double age_s = 0.02) {
    const TrackFrame f = frame(map_from_cam);
    return px4_.on_frame(f, f.capture_ns + to_ns(age_s));
  }
  ros::VehicleOdometry heard(const Rigid3& map_from_cam) {
    const auto answer = at(map_from_cam);
    EXPECT_TRUE(answer.odometry) << (answer.refused ? sentence_of(*answer.refused) : "");
    return answer.odometry.value_or(ros::VehicleOdometry());
  }

  Px4Odometry px4_;
  TimeNs t_ns_ = kStart_ns;
  MapId map_{1};
  MapEpoch epoch_{1};
};

void expect_near(const std::array<float, 3>& got, const Eigen::Vector3d& expected, double within = 1e-5) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got[static_cast<std::size_t>(i)], expected[i], within) << i;
}
void expect_turn(const std::array<float, 4>& q, double half_rad, const Eigen::Vector3d& axis) {
  EXPECT_NEAR(q[0], std::cos(half_rad), 1e-6);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(q[static_cast<std::size_t>(i + 1)], std::sin(half_rad) * axis[i], 1e-6) << i;
}

const Eigen::Quaterniond kLevel = Eigen::Quaterniond::Identity();  // as the map's first camera: x right, y down
Eigen::Quaterniond turned(double rad, const Eigen::Vector3d& camera_axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rad, camera_axis));
}

TEST_F(Px4Test, TheAxesAreForwardRightDown) {
  expect_near(heard({kLevel, {0, 0, 0}}).position, {0, 0, 0});
  expect_near(heard({kLevel, {0, 0, 0.1}}).position, {0.1, 0, 0});
  expect_near(heard({kLevel, {0.1, 0, 0.1}}).position, {0.1, 0.1, 0});
  expect_near(heard({kLevel, {0.1, -0.1, 0.1}}).position, {0.1, 0.1, -0.1});  // up is negative
}

TEST_F(Px4Test, TurnsAreThoseOfTheBody) {
  const double rad = 0.1;
  expect_turn(heard({turned(0, {0, 1, 0}), {0, 0, 0}}).q, 0, {0, 0, 0});
  expect_turn(heard({turned(rad, {0, 1, 0}), {0, 0, 0}}).q, rad / 2, {0, 0, 1});  // yaw: it looks to the right
  expect_turn(heard({turned(rad, {1, 0, 0}), {0, 0, 0}}).q, rad / 2, {0, 1, 0});  // pitch: it looks up
  expect_turn(heard({turned(rad, {0, 0, 1}), {0, 0, 0}}).q, rad / 2, {1, 0, 0});  // roll: its right side is down
}

// A circle of 5 m at 2 m/s to the right, climbing: position and heading at each instant, without a reset.
TEST_F(Px4Test, AKnownFlightIsToldAsItIs) {
  const double radius_m = 5, speed_mps = 2, climb_mps = 0.5;
  for (int i = 0; i < 300; ++i) {
    const double t_s = to_seconds(i * kFrame_ns), angle = speed_mps / radius_m * t_s;
    // In the map: z ahead, x right, y down.
    const Eigen::Vector3d place(radius_m * (1 - std::cos(angle)), -climb_mps * t_s, radius_m * std::sin(angle));
    const ros::VehicleOdometry o = heard({turned(angle, {0, 1, 0}), place});
    expect_near(o.position, {place.z(), place.x(), place.y()}, 1e-4);
    const double yaw = 2 * std::atan2(o.q[3], o.q[0]);
    EXPECT_NEAR(std::remainder(yaw - angle, 2 * std::numbers::pi), 0, 1e-4);
    EXPECT_EQ(o.pose_frame, ros::VehicleOdometry::kFrd);
    EXPECT_EQ(o.timestamp_sample, static_cast<std::uint64_t>((kStart_ns + i * kFrame_ns) / 1000));
    EXPECT_EQ(o.timestamp, o.timestamp_sample + 20'000);
    EXPECT_EQ(o.reset_counter, 0);
    EXPECT_TRUE(std::isnan(o.velocity[0]) && std::isnan(o.angular_velocity[2]) && std::isnan(o.velocity_variance[1]));
    EXPECT_EQ(o.quality, 80);
    EXPECT_EQ(ros::to_cdr(o).size(), 118U);
  }
}

TEST_F(Px4Test, VariancesAreAlongTheAxesToldOfAndAboutThoseOfTheBody) {
  // Camera: turned to the right by 90 degrees. Its own x, y, z are then the map's -z, y, x.
  TrackFrame f = frame({turned(std::numbers::pi / 2, {0, 1, 0}), {0, 0, 0}});
  f.pose_covariance.diagonal() << 1e-4F, 2e-4F, 3e-4F, 1e-2F, 2e-2F, 3e-2F;  // turns, then place, by the camera's axes
  const auto o = px4_.on_frame(f, f.capture_ns).odometry.value();
  expect_near(o.position_variance, {1e-2, 3e-2, 2e-2}, 1e-6);     // ahead: the map's z; right: its x; down: its y
  expect_near(o.orientation_variance, {3e-4, 1e-4, 2e-4}, 1e-8);  // roll about the view, pitch about its x, yaw
  f = frame({kLevel, {0, 0, 0}});
  f.pose_covariance.setZero();
  const auto unknown = px4_.on_frame(f, f.capture_ns).odometry.value();
  EXPECT_TRUE(std::isnan(unknown.position_variance[0]) && std::isnan(unknown.orientation_variance[2]));
}

TEST_F(Px4Test, WhatIsNotSureIsNotSaid) {
  const Rigid3 pose(kLevel, {0, 0, 0});
  EXPECT_TRUE(at(pose).odometry);
  told(false);
  EXPECT_EQ(at(pose).refused, Px4Refusal::kScaleUnknown);
  told(true);
  EXPECT_TRUE(at(pose, 0.19).odometry);
  EXPECT_EQ(at(pose, 0.21).refused, Px4Refusal::kTooOld);
  EXPECT_EQ(at(pose, -1).refused, Px4Refusal::kAhead);
  told(true, 1, PoseState::kLost);
  EXPECT_EQ(at(pose).refused, Px4Refusal::kLost);
  told(true);
  TrackFrame lost = frame(pose);
  lost.pose_state = PoseState::kLost;
  EXPECT_EQ(px4_.on_frame(lost, lost.capture_ns).refused, Px4Refusal::kLost);
  EXPECT_TRUE(at(pose).odometry);
  TrackFrame doubted = frame(pose);
  doubted.images_doubted = true;
  EXPECT_EQ(px4_.on_frame(doubted, doubted.capture_ns).refused, Px4Refusal::kDoubted);
}

TEST_F(Px4Test, StampsAreThoseOfTheClockAsItIsSetNow) {
  constexpr TimeNs kBack_ns = -3'600'000'000'000;
  const Rigid3 pose(kLevel, {0, 0, 0});
  EXPECT_TRUE(at(pose).odometry);
  TrackFrame f = frame(pose);
  f.clock_set_ns = kBack_ns;
  const auto answer = px4_.on_frame(f, f.capture_ns + kBack_ns + 20'000'000);
  ASSERT_TRUE(answer.odometry) << sentence_of(*answer.refused);
  EXPECT_EQ(answer.odometry->timestamp_sample, static_cast<std::uint64_t>((f.capture_ns + kBack_ns) / 1000));
  EXPECT_EQ(answer.odometry->reset_counter, 0) << "the vehicle did not jump";
  f.capture_ns = std::numeric_limits<TimeNs>::min();
  EXPECT_EQ(px4_.on_frame(f, kStart_ns).refused, Px4Refusal::kTooOld);
}

TEST_F(Px4Test, AnEpochOrAServerThatIsNotKnownYetIsWaitedFor) {
  const Rigid3 pose(kLevel, {0, 0, 0});
  EXPECT_TRUE(at(pose).odometry);
  epoch_ = MapEpoch(2);  // the agent took over what the server did, the server's word about it is still to come
  EXPECT_EQ(at(pose).refused, Px4Refusal::kNotTold);
  told(true, 2);
  EXPECT_TRUE(at(pose).odometry);
  epoch_ = MapEpoch(1);  // the word is ahead of the agent
  EXPECT_TRUE(at(pose).odometry);
  TrackFrame other = frame(pose);
  other.agent_run = RunId(9);
  EXPECT_EQ(px4_.on_frame(other, other.capture_ns).refused, Px4Refusal::kNotTold);
  other = frame(pose);
  other.server_run = RunId(9);
  EXPECT_EQ(px4_.on_frame(other, other.capture_ns).refused, Px4Refusal::kNotTold);
}

TEST_F(Px4Test, ACorrectionThatJumpsRaisesTheCounter) {
  double z = 0;
  const auto fly = [&] { return heard({kLevel, {0, 0, z += 0.05}}).reset_counter; };
  for (int i = 0; i < 10; ++i) EXPECT_EQ(fly(), 0);
  told(true, 2);
  z += 0.02;  // a correction of 2 cm is within what poses scatter
  EXPECT_EQ(fly(), 0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(fly(), 0);
  told(true, 3);
  z += 0.5;
  EXPECT_EQ(fly(), 1);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(fly(), 1) << "once for each jump";
  EXPECT_EQ(heard({turned(0.3, {0, 1, 0}), {0, 0, z += 0.05}}).reset_counter, 2) << "a turn is a jump too";
}

TEST_F(Px4Test, ANewMapOrAPoseAfterALossRaisesTheCounter) {
  const Rigid3 pose(kLevel, {0, 0, 0});
  EXPECT_EQ(heard(pose).reset_counter, 0);
  map_ = MapId(2);
  told();
  EXPECT_EQ(heard(pose).reset_counter, 1);
  TrackFrame lost = frame(pose);
  lost.pose_state = PoseState::kLost;
  px4_.on_frame(lost, lost.capture_ns);
  EXPECT_EQ(heard(pose).reset_counter, 2);
  t_ns_ += to_ns(3);  // nothing was heard for long
  EXPECT_EQ(heard(pose).reset_counter, 3);
  for (int i = 0; i < 253; ++i) {
    t_ns_ += to_ns(1);
    heard(pose);
  }
  EXPECT_EQ(heard(pose).reset_counter, 0) << "it is an octet";
}

class Px4Mounted : public Px4Test {
 protected:
  // Looking down by 30 degrees, 20 cm ahead of the vehicle's origin and 5 cm below it; so is the map's first camera.
  Px4Mounted()
      : Px4Test({.agent = "cam0", .forward_m = 0.2, .down_m = 0.05, .pitch_deg = -30},
                {.down_y = std::cos(std::numbers::pi / 6), .down_z = std::sin(std::numbers::pi / 6)}) {}
};

TEST_F(Px4Mounted, TheVehicleIsWhereItIsNotItsCamera) {
  const ros::VehicleOdometry start = heard({kLevel, {0, 0, 0}});
  expect_near(start.position, {-0.2, 0, -0.05});
  expect_turn(start.q, 0, {0, 0, 0});  // level, though its camera is not
  // Straight ahead, level, is up in the image.
  const Eigen::Vector3d ahead(0, -std::sin(std::numbers::pi / 6), std::cos(std::numbers::pi / 6));
  expect_near(heard({kLevel, 0.1 * ahead}).position, {-0.1, 0, -0.05});
}

class Px4LooksDown : public Px4Test {
 protected:
  Px4LooksDown() : Px4Test({.agent = "cam0", .pitch_deg = -90}, {.down_y = 0, .down_z = 1}) {}
};

TEST_F(Px4LooksDown, UpInTheImageIsAhead) {
  const ros::VehicleOdometry start = heard({kLevel, {0, 0, 0}});
  expect_turn(start.q, 0, {0, 0, 0});
  expect_near(heard({kLevel, {0.02, -0.1, -0.05}}).position, {0.1, 0.02, -0.05});
}

TEST(MapLevel, TheUprightAxesAreAheadLeftAndUp) {
  const Eigen::Quaterniond level = flu_from_map({});
  EXPECT_TRUE((level * Eigen::Vector3d(0, 0, 1)).isApprox(Eigen::Vector3d(1, 0, 0))) << "ahead";
  EXPECT_TRUE((level * Eigen::Vector3d(-1, 0, 0)).isApprox(Eigen::Vector3d(0, 1, 0))) << "left";
  EXPECT_TRUE((level * Eigen::Vector3d(0, -1, 0)).isApprox(Eigen::Vector3d(0, 0, 1))) << "up";
}

}  // namespace
}  // namespace coslam::px4_odometry_test
