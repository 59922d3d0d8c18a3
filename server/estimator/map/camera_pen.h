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

  // Updates the standard deviation of the camera's observations with one more frame: a running mean, faster at the
  // beginning.
  void measure_sigma(const MapCamera& camera, double sigma_px);
  void set_sparse(const MapCamera& camera, bool sparse) { mutable_camera(camera).sparse = sparse; }
  void set_scene_depth(const MapCamera& camera, double depth) { mutable_camera(camera).scene_depth = depth; }
  void set_clock_offset(const MapCamera& camera, TimeNs offset_ns) {
    mutable_camera(camera).clock_offset_ns = offset_ns;
  }
  // Reports that the camera's images were taken this much later than dated, relative to another camera; changes
  // nothing.
  void note_misdated(const MapCamera& camera, double lag_s, CameraId against) {
    note_camera(EventKind::kCameraMisdated, camera, Why::kMovesAtOtherTimes,
                {lag_s, static_cast<double>(against.value)});
  }

  // Puts a camera into a map, at its newest or an earlier set.
  void place(const MapCamera& camera, SetId set, MapId map, const Rigid3& cam_from_world, Why why,
             Figures figures = {});
  // Sets the camera's pose at a set, in the map that it is in.
  void set_pose(const MapCamera& camera, SetId set, const Rigid3& cam_from_world);
  // Sets the camera's newest pose to the agent's own, which rests on points that the map does not have.
  void accept_agent_pose(const MapCamera& camera, const Rigid3& cam_from_world);
  // Marks the newest pose as resting on more than its agent has: the agent is to take it.
  void push_pose_to_agent(const MapCamera& camera) { mutable_camera(camera).corrected = true; }
  // Sets the camera's newest pose, found together with the other cameras of its group; rests_on_moving: the static
  // points alone would not determine it.
  void set_joint_pose(const MapCamera& camera, const Rigid3& cam_from_world, bool rests_on_moving);
  // Notes that the newest frame has no pose; known: number of known points; agree: those that agree on a pose. Returns
  // how many frames in succession have none.
  int lose_pose(const MapCamera& camera, std::size_t known, int agree);
  void leave_map(const MapCamera& camera);
  // Replaces the estimate of an earlier pose.
  void adjust_pose(const MapCamera& camera, const FramePose& frame, const Rigid3& cam_from_world);
  // Replaces the estimate of an earlier pose, also of a frame that had none.
  void place_past(const MapCamera& camera, const FramePose& frame, MapId map, const Rigid3& cam_from_world);

  // Moves a camera's world, and has its agent move along.
  void carry_agent(const MapCamera& camera, const Similarity3& new_from_old);
  // Notes that the camera's agent was told how its world moved and of which map it is part.
  void mark_announced(const MapCamera& camera);
};

}  // namespace coslam
