// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/model/agent_pose.h"
#include "common/model/track_frame.h"
#include "common/ros/px4_messages.h"
#include "server/show/bridge/map_level.h"

namespace coslam {

// Mounting of the camera on the vehicle. Body axes are those of PX4: forward, right, down.
struct Px4Config {
  std::string agent;  // agent whose camera is on the vehicle; empty: nothing is sent
  std::string topic = "/fmu/in/vehicle_visual_odometry";
  double forward_m = 0, right_m = 0, down_m = 0;    // position of the camera from the vehicle's origin
  double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;  // rotation to the right, up, right side down; from looking ahead
};

template <class V>
void describe(V& v, Px4Config& c) {
  v.field("agent", c.agent, "agent whose poses PX4 gets; empty: none");
  v.field("topic", c.topic, "where, as ROS names it; with a namespace /uav_1/fmu/in/vehicle_visual_odometry");
  v.field("forward_m", c.forward_m, {-100, 100}, "the camera's place on the vehicle, forward of its origin");
  v.field("right_m", c.right_m, {-100, 100}, "the same, to the right");
  v.field("down_m", c.down_m, {-100, 100}, "the same, down");
  v.field("yaw_deg", c.yaw_deg, {-180, 180}, "where the camera looks: to the right of straight ahead");
  v.field("pitch_deg", c.pitch_deg, {-90, 90}, "the same, upwards: -90 looks straight down");
  v.field("roll_deg", c.roll_deg, {-180, 180}, "how it is turned about its view, right side down");
}

// Why there is nothing for PX4.
enum class Px4Refusal : std::uint8_t {
  kLost,          // the agent, or the server about it
  kNotTold,       // the server has not said yet in which map and unit the pose is
  kScaleUnknown,  // lengths are no metres
  kTooOld,        // frame is too old by the clock of this machine
  kAhead,         // frame is ahead of the clock of this machine
  kDoubted,       // the agent's images are not to be believed
};
const char* sentence_of(Px4Refusal refusal);

// Odometry of a vehicle for EKF2 of PX4: its pose in a fixed frame that points ahead of the map's first camera, right
// and down (POSE_FRAME_FRD), at the pace of the camera. The vehicle relies on it, so only poses that are certain are
// sent. Pure.
class Px4Odometry {
 public:
  explicit Px4Odometry(const Px4Config& config, const MapLevel& level = {});

  const std::string& agent() const { return config_.agent; }
  // Takes in the server's message about the agent: the frame and the unit of its poses.
  void see(const AgentPose& pose);
  struct Answer {
    std::optional<ros::VehicleOdometry> odometry;
    std::optional<Px4Refusal> refused;
  };
  // A frame of the agent. now_ns: UTC of this machine, whose clock the stamps are of.
  Answer on_frame(const TrackFrame& frame, TimeNs now_ns);

 private:
  struct Vehicle {
    TimeNs t_ns = 0;
    Rigid3 frd_from_body;
  };
  // Origin of a pose: between different origins the pose jumps.
  struct Origin {
    RunId agent_run, server_run;
    MapId map;
    friend bool operator==(const Origin&, const Origin&) = default;
  };

  std::optional<Px4Refusal> refusal_of(const TrackFrame& frame, TimeNs now_ns) const;
  void count_jump(const Vehicle& now, const Origin& origin, double sigma_m);
  bool continues(const Vehicle& now, double sigma_m) const;

  const Px4Config config_;
  const Rigid3 body_from_cam_;
  const Eigen::Quaterniond frd_from_map_;
  std::optional<AgentPose> agent_pose_;
  std::optional<Origin> origin_;
  std::optional<Vehicle> last_, before_last_;
  bool lost_ = false;  // since the last pose
  std::uint8_t resets_ = 0;
};

}  // namespace coslam
