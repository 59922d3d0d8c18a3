// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/camera_pen.h"

#include <algorithm>

namespace coslam {

void CameraPen::measure_sigma(const MapCamera& camera, double sigma_px) {
  MapCamera& c = mutable_camera(camera);
  c.sigma_px += std::max(0.1, 1.0 / ++c.sigma_frames) * (sigma_px - c.sigma_px);
}

void CameraPen::place(const MapCamera& camera, SetId set, MapId map, const Rigid3& cam_from_world, Why why,
                      Figures figures) {
  MapCamera& c = mutable_camera(camera);
  const bool anew = c.map != map || c.lost_sets > 0;
  if (c.map != map) c.announced.clear();
  c.map = map;
  c.lost_sets = 0;
  set_pose(camera, set, cam_from_world);
  if (anew) note_camera(EventKind::kCameraPlaced, c, why, figures);
}

void CameraPen::set_pose(const MapCamera& camera, SetId set, const Rigid3& cam_from_world) {
  MapCamera& c = mutable_camera(camera);
  FramePose& f = c.frames[static_cast<std::size_t>(c.frame_at(set) - c.frames.data())];
  f.map = c.map;
  f.cam_from_world = cam_from_world;
  if (c.lost_sets > 0) {
    note_camera(EventKind::kCameraFound, c, Why::kPoseAgain, {static_cast<double>(c.lost_sets), 0});
  }
  c.lost_sets = 0;
}

void CameraPen::set_joint_pose(const MapCamera& camera, const Rigid3& cam_from_world, bool rests_on_moving) {
  MapCamera& c = mutable_camera(camera);
  set_pose(camera, c.frames.back().set, cam_from_world);
  c.frames.back().joint = rests_on_moving;
  c.corrected = true;
}

void CameraPen::accept_agent_pose(const MapCamera& camera, const Rigid3& cam_from_world) {
  set_pose(camera, camera.frames.back().set, cam_from_world);
  mutable_camera(camera).frames.back().joint = true;
}

int CameraPen::lose_pose(const MapCamera& camera, std::size_t known, int agree) {
  if (camera.lost_sets == 0) {
    note_camera(EventKind::kCameraLost, camera, Why::kNoPose, {static_cast<double>(known), static_cast<double>(agree)});
  }
  return ++mutable_camera(camera).lost_sets;
}

void CameraPen::leave_map(const MapCamera& camera) {
  MapCamera& c = mutable_camera(camera);
  for (auto& [id, track] : c.tracks) {
    if (track.bound()) unbind(c.id, track, Why::kCameraLeft);
  }
  note_camera(EventKind::kCameraLeft, c, Why::kLostTooLong, {static_cast<double>(c.lost_sets), 0});
  c.map = MapId();
  c.lost_sets = 0;
  c.announced.clear();
}

void CameraPen::adjust_pose(const MapCamera& camera, const FramePose& frame, const Rigid3& cam_from_world) {
  mutable_camera(camera).frames[static_cast<std::size_t>(&frame - camera.frames.data())].cam_from_world =
      cam_from_world;
}

void CameraPen::place_past(const MapCamera& camera, const FramePose& frame, MapId map, const Rigid3& cam_from_world) {
  mutable_camera(camera).frames[static_cast<std::size_t>(&frame - camera.frames.data())].map = map;
  adjust_pose(camera, frame, cam_from_world);
}

void CameraPen::carry_agent(const MapCamera& camera, const Similarity3& new_from_old) {
  MapCamera& c = mutable_camera(camera);
  c.moved = new_from_old * c.moved;
  for (AnnouncedEpoch& t : c.announced) t.moved = new_from_old * t.moved;
  c.scene_depth *= new_from_old.scale;
}

void CameraPen::mark_announced(const MapCamera& camera) {
  constexpr std::size_t kMost = 64;
  MapCamera& c = mutable_camera(camera);
  c.moved = Similarity3();
  c.merged_from = MapId();
  if (c.announced.empty() || c.announced.back().epoch != map_.epoch_)
    c.announced.push_back({map_.epoch_, Similarity3()});
  if (c.announced.size() > kMost) c.announced.pop_front();
}

}  // namespace coslam
