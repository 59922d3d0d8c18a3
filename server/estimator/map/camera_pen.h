// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "server/estimator/map/point_pen.h"

namespace coslam {

// Verbs on cameras, their poses, and what their agents were told.
class CameraPen : public PointPen {
 protected:
  using PointPen::PointPen;

  // Takes in the standard deviation of the camera's observations in one more frame: a running mean, faster at the
  // beginning.
  void measure_sigma(const MapCamera& camera, double sigma_px);
  void set_sparse(const MapCamera& camera, bool sparse) { own(camera).sparse = sparse; }
  void set_scene_depth(const MapCamera& camera, double depth) { own(camera).scene_depth = depth; }
  void set_clock_offset(const MapCamera& camera, TimeNs offset_ns) { own(camera).clock_offset_ns = offset_ns; }
  // The camera's images were taken so much later than they are dated, against another camera's: only told.
  void note_misdated(const MapCamera& camera, double lag_s, CameraId against) {
    note_camera(EventKind::kCameraMisdated, camera, Why::kMovesAtOtherTimes,
                {lag_s, static_cast<double>(against.value)});
  }

  // Puts a camera into a map, at its newest or an earlier set.
  void place(const MapCamera& camera, SetId set, MapId map, const Rigid3& cam_from_world, Why why,
             Figures figures = {});
  // The camera's pose at a set, in the map that it is in.
  void set_pose(const MapCamera& camera, SetId set, const Rigid3& cam_from_world);
  // The camera's newest pose, as its agent says, which has points that the map has not.
  void accept_agent_pose(const MapCamera& camera, const Rigid3& cam_from_world);
  // The newest pose rests on more than its agent has: the agent is to take it.
  void push_pose_to_agent(const MapCamera& camera) { own(camera).corrected = true; }
  // The camera's newest pose, found together with the other cameras of its group; rests_on_moving: the static points
  // alone would not hold it.
  void set_joint_pose(const MapCamera& camera, const Rigid3& cam_from_world, bool rests_on_moving);
  // The newest frame has no pose, with so many points known and so many that agree. Returns how many in succession.
  int lose_pose(const MapCamera& camera, std::size_t known, int agree);
  void leave_map(const MapCamera& camera);
  // Another estimate of an earlier pose.
  void adjust_pose(const MapCamera& camera, const FramePose& frame, const Rigid3& cam_from_world);
  // Another estimate of an earlier pose, also of a frame that had none.
  void place_past(const MapCamera& camera, const FramePose& frame, MapId map, const Rigid3& cam_from_world);

  // The camera's world moved, and its agent is to move along.
  void carry_agent(const MapCamera& camera, const Similarity3& new_from_old);
  // The camera's agent was told how its world moved and of which map it is part.
  void mark_announced(const MapCamera& camera);
};

}  // namespace coslam
