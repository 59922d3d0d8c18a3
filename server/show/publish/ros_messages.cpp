// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/ros_messages.h"

#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "common/ros/convert.h"
#include "common/ros/views.h"

namespace coslam {
namespace {

constexpr double kUnknownVariance = 1e6;

ros::Covariance36 diagonal(double linear, double angular) {
  ros::Covariance36 out{};
  for (std::size_t i = 0; i < 6; ++i) out[7 * i] = i < 3 ? linear : angular;
  return out;
}

ros::Header header_in(MapId map, const PublicInstant& instant) {
  return ros::header_of(instant.t_ns, frame_of(map, instant.main));
}

// Of base_link in a frame, from the camera's there.
ros::Pose pose_of_base(const Rigid3& cam_from_frame) {
  return ros::pose_of(cam_from_frame.inverse() * ros::base_from_optical().inverse());
}

ros::PoseWithCovariance estimate_of_base(const Rigid3& cam_from_frame,
                                         const std::optional<PoseCovariance>& covariance) {
  return {pose_of_base(cam_from_frame), covariance ? ros::world_covariance(cam_from_frame, covariance->cast<double>())
                                                   : diagonal(kUnknownVariance, kUnknownVariance)};
}

// Of base_link along its axes, from two poses: each with its variance, the errors taken for independent, which
// overestimates them.
ros::TwistWithCovariance twist_of(const PublicPose& pose) {
  ros::TwistWithCovariance out;
  out.covariance = diagonal(kUnknownVariance, kUnknownVariance);
  if (!pose.velocity) return out;
  const Eigen::Matrix3d turned = ros::base_from_optical().rotation.toRotationMatrix();
  out.twist = {ros::vector_of(turned * pose.velocity->linear), ros::vector_of(turned * pose.velocity->angular_rad)};
  if (!pose.covariance) return out;
  const double factor = 2 / (pose.velocity->over_s * pose.velocity->over_s);
  const auto in_base = [&](const Eigen::Matrix3f& of_camera) -> Eigen::Matrix3d {
    return factor * turned * of_camera.cast<double>() * turned.transpose();
  };
  const Eigen::Matrix3d turn = in_base(pose.covariance->topLeftCorner<3, 3>());
  const Eigen::Matrix3d place = in_base(pose.covariance->bottomRightCorner<3, 3>());
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index col = 0; col < 3; ++col) {
      out.covariance[static_cast<std::size_t>(6 * row + col)] = place(row, col);
      out.covariance[static_cast<std::size_t>(6 * (row + 3) + col + 3)] = turn(row, col);
    }
  }
  return out;
}

const PublicMoving::InMap& in_main(const PublicMoving& moving) {
  static const PublicMoving::InMap kNone;
  const auto at = moving.maps.find(moving.main);
  return at == moving.maps.end() ? kNone : at->second;
}

}  // namespace

ros::TFMessage tf_message(const PublicPoses& poses, RosNames& names) {
  const Rigid3 base_from_cam = ros::base_from_optical();
  ros::TFMessage out;
  for (const PublicPose& c : poses.cameras) {
    const std::string& name = names.ros_name(c.agent);
    const auto say = [&](std::string frame, std::string child, const Rigid3& frame_from_child) {
      out.transforms.push_back(
          {ros::header_of(c.capture_ns, std::move(frame)), std::move(child), ros::transform_of(frame_from_child)});
    };
    say(frame_of(c.map, poses.main), odom_frame(name), c.cam_from_map.inverse() * c.cam_from_odom);
    say(odom_frame(name), base_frame(name), c.cam_from_odom.inverse() * base_from_cam.inverse());
    say(base_frame(name), camera_frame(name), base_from_cam);
  }
  return out;
}

ros::PoseWithCovarianceStamped pose_in_map(const PublicPose& pose, MapId main) {
  return {ros::header_of(pose.capture_ns, frame_of(pose.map, main)),
          estimate_of_base(pose.cam_from_map, pose.covariance)};
}

ros::Odometry odometry(const PublicPose& pose, RosNames& names) {
  const std::string& name = names.ros_name(pose.agent);
  return {ros::header_of(pose.capture_ns, odom_frame(name)), base_frame(name),
          estimate_of_base(pose.cam_from_odom, pose.covariance), twist_of(pose)};
}

ros::Path path(const PublicPath& path, const PublicInstant& instant) {
  const std::string frame = frame_of(path.map, instant.main);
  ros::Path out;
  out.header = ros::header_of(instant.t_ns, frame);
  for (const auto& [t_ns, cam_from_map] : path.cam_from_map)
    out.poses.push_back({ros::header_of(t_ns, frame), pose_of_base(cam_from_map)});
  return out;
}

ros::PoseArray key_frames(const PublicPath& path, const PublicInstant& instant) {
  ros::PoseArray out;
  out.header = ros::header_of(instant.t_ns, frame_of(path.map, instant.main));
  for (const Rigid3& cam_from_map : path.key_cam_from_map) out.poses.push_back(pose_of_base(cam_from_map));
  return out;
}

ros::PointCloud2 static_cloud(const PublicCloud& cloud) {
  return ros::static_cloud(header_in(cloud.main, cloud), cloud.points);
}

ros::PointCloud2 moving_cloud(const PublicMoving& moving) {
  return ros::moving_cloud(header_in(moving.main, moving), in_main(moving).points);
}

ros::MarkerArray object_markers(const PublicMoving& moving) {
  ros::MarkerArray out;
  for (const auto& [map, in_map] : moving.maps) {
    ros::MarkerArray markers = ros::object_markers(header_in(map, moving), in_map.objects);
    out.markers.insert(out.markers.end(), std::make_move_iterator(markers.markers.begin()),
                       std::make_move_iterator(markers.markers.end()));
  }
  return out;
}

ros::Detection3DArray object_detections(const PublicMoving& moving) {
  return ros::object_detections(header_in(moving.main, moving), in_main(moving).objects);
}

}  // namespace coslam
