// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/ros/std_messages.h"

// geometry_msgs, tf2_msgs and nav_msgs.
namespace coslam::ros {

// Six by six by rows: x, y, z, then rotations about the fixed axes x, y, z, in the frame of the header.
using Covariance36 = std::array<double, 36>;

struct Point {
  static constexpr const char* kType = "geometry_msgs/Point";
  double x = 0, y = 0, z = 0;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};

struct Vector3 {
  static constexpr const char* kType = "geometry_msgs/Vector3";
  double x = 0, y = 0, z = 0;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};

struct Quaternion {
  static constexpr const char* kType = "geometry_msgs/Quaternion";
  double x = 0, y = 0, z = 0, w = 1;
  static void fields(auto& m, auto& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
    visit("w", m.w);
  }
};

struct Pose {
  static constexpr const char* kType = "geometry_msgs/Pose";
  Point position;
  Quaternion orientation;
  static void fields(auto& m, auto& visit) {
    visit("position", m.position);
    visit("orientation", m.orientation);
  }
};

struct PoseStamped {
  static constexpr const char* kType = "geometry_msgs/PoseStamped";
  Header header;
  Pose pose;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};

struct PoseArray {
  static constexpr const char* kType = "geometry_msgs/PoseArray";
  Header header;
  std::vector<Pose> poses;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("poses", m.poses);
  }
};

struct PoseWithCovariance {
  static constexpr const char* kType = "geometry_msgs/PoseWithCovariance";
  Pose pose;
  Covariance36 covariance{};
  static void fields(auto& m, auto& visit) {
    visit("pose", m.pose);
    visit("covariance", m.covariance);
  }
};

struct PoseWithCovarianceStamped {
  static constexpr const char* kType = "geometry_msgs/PoseWithCovarianceStamped";
  Header header;
  PoseWithCovariance pose;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};

struct Twist {
  static constexpr const char* kType = "geometry_msgs/Twist";
  Vector3 linear, angular;
  static void fields(auto& m, auto& visit) {
    visit("linear", m.linear);
    visit("angular", m.angular);
  }
};

struct TwistWithCovariance {
  static constexpr const char* kType = "geometry_msgs/TwistWithCovariance";
  Twist twist;
  Covariance36 covariance{};
  static void fields(auto& m, auto& visit) {
    visit("twist", m.twist);
    visit("covariance", m.covariance);
  }
};

struct Transform {
  static constexpr const char* kType = "geometry_msgs/Transform";
  Vector3 translation;
  Quaternion rotation;
  static void fields(auto& m, auto& visit) {
    visit("translation", m.translation);
    visit("rotation", m.rotation);
  }
};

// Maps coordinates in the child's frame to coordinates in the header's.
struct TransformStamped {
  static constexpr const char* kType = "geometry_msgs/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("transform", m.transform);
  }
};

struct TFMessage {
  static constexpr const char* kType = "tf2_msgs/TFMessage";
  std::vector<TransformStamped> transforms;
  static void fields(auto& m, auto& visit) { visit("transforms", m.transforms); }
};

// The pose is in the header's frame, the twist in the child's.
struct Odometry {
  static constexpr const char* kType = "nav_msgs/Odometry";
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("pose", m.pose);
    visit("twist", m.twist);
  }
};

struct Path {
  static constexpr const char* kType = "nav_msgs/Path";
  Header header;
  std::vector<PoseStamped> poses;
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("poses", m.poses);
  }
};

}  // namespace coslam::ros
