// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/odom_frames.h"

#include "common/ros/convert.h"

namespace coslam {

Rigid3 OdomFrames::follow(const std::string& agent, TimeNs capture_ns, const Rigid3& cam_from_map,
                          const PoseAt& pose_at) {
  const auto [at, is_new] = newest_.try_emplace(agent, Newest{capture_ns, ros::base_from_optical().inverse()});
  Newest& newest = at->second;
  if (is_new) return newest.cam_from_odom;
  if (const auto before_from_map = pose_at(newest.capture_ns)) {
    newest.cam_from_odom = cam_from_map * before_from_map->inverse() * newest.cam_from_odom;
    newest.cam_from_odom.rotation.normalize();
  }
  newest.capture_ns = capture_ns;
  return newest.cam_from_odom;
}

}  // namespace coslam
