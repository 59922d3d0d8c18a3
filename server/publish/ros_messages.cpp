// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/publish/ros_messages.h"

#include <iterator>

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

// From two poses: each with its variance, the errors taken for independent, which overestimates them.
ros::TwistWithCovariance twist_of(const PublicPose& pose) {
  ros::TwistWithCovariance out;
  out.covariance = diagonal(kUnknownVariance, kUnknownVariance);
  if (!pose.velocity) return out;
  out.twist = {ros::vector_of(pose.velocity->linear), ros::vector_of(pose.velocity->angular_rad)};
  if (!pose.covariance) return out;
  const Eigen::Matrix3d turn = pose.covariance->topLeftCorner<3, 3>().cast<double>();
  const Eigen::Matrix3d place = pose.covariance->bottomRightCorner<3, 3>().cast<double>();
  const double factor = 2 / (pose.velocity->over_s * pose.velocity->over_s);
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index col = 0; col < 3; ++col) {
      out.covariance[static_cast<std::size_t>(6 * row + col)] = factor * place(row, col);
      out.covariance[static_cast<std::size_t>(6 * (row + 3) + col + 3)] = factor * turn(row, col);
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
  ros::TFMessage out;
  for (const PublicPose& c : poses.cameras) {
    out.transforms.push_back({ros::header_of(c.capture_ns, frame_of(c.map, poses.main)),
                              camera_frame(names.of(c.agent)), ros::transform_of(c.cam_from_map.inverse())});
  }
  return out;
}

ros::Odometry odometry(const PublicPose& pose, MapId main, RosNames& names) {
  ros::Odometry out;
  out.header = ros::header_of(pose.capture_ns, frame_of(pose.map, main));
  out.child_frame_id = camera_frame(names.of(pose.agent));
  out.pose.pose = ros::pose_of(pose.cam_from_map.inverse());
  out.pose.covariance = pose.covariance ? ros::world_covariance(pose.cam_from_map, pose.covariance->cast<double>())
                                        : diagonal(kUnknownVariance, kUnknownVariance);
  out.twist = twist_of(pose);
  return out;
}

ros::Path path(const PublicPath& path, const PublicInstant& instant) {
  const std::string frame = frame_of(path.map, instant.main);
  ros::Path out;
  out.header = ros::header_of(instant.t_ns, frame);
  for (const auto& [t_ns, cam_from_map] : path.cam_from_map)
    out.poses.push_back({ros::header_of(t_ns, frame), ros::pose_of(cam_from_map.inverse())});
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
