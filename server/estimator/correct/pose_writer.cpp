// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/pose_writer.h"

#include "common/geometry/camera_in_world.h"

namespace coslam {
namespace {

AgentPose pose_of(const Map& map, const MapCamera& camera, const CameraFrame& cf, SetId set, RunId server_run) {
  AgentPose p;
  p.agent = camera.name;
  p.agent_run = camera.run;
  p.server_run = server_run;
  p.t_ns = cf.frame.capture_ns;
  p.epoch = map.epoch();
  if (camera.frames.empty()) return p;
  const FramePose& newest = camera.frames.back();
  if (newest.set != set || !newest.valid()) {
    p.state = camera.map == MapId() ? PoseState::kNone : PoseState::kLost;
    return p;
  }
  p.map = newest.map;
  p.state = PoseState::kTracked;
  p.map_from_cam = newest.cam_from_world.inverse();
  const bool known = cf.frame.pose_state == PoseState::kTracked && cf.frame.server_run == server_run;
  if (!known) return p;
  const Matrix6d covariance = cf.frame.pose_covariance.cast<double>();
  p.covariance = camera_covariance_in_world(newest.cam_from_world, covariance).cast<float>();
  return p;
}

}  // namespace

std::vector<AgentPose> agent_poses(const Map& map, const FrameSet& set, RunId server_run,
                                   const std::function<bool(MapId)>& in_metres) {
  std::vector<AgentPose> poses;
  for (const CameraFrame& cf : set.frames) {
    poses.push_back(pose_of(map, map.camera(cf.camera), cf, set.id, server_run));
    poses.back().scale_known = poses.back().map != MapId() && in_metres(poses.back().map);
  }
  return poses;
}

}  // namespace coslam
