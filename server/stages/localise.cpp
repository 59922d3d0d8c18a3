// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/localise.h"

#include <algorithm>

#include "common/geometry/pose_refinement.h"

namespace coslam {
namespace {

std::vector<PointObservation> bound_observations(const Map& map, const MapCamera& camera, SetId set,
                                                 bool unproven_too) {
  std::vector<PointObservation> observations;
  for (const auto& [id, track] : camera.tracks) {
    if (track.point == PointId() || set.value < track.distrusted_before) continue;
    const MapPoint* p = map.find(track.point);
    if (p->state != PointState::kStatic || !(p->proven || unproven_too)) continue;
    const auto at = std::lower_bound(track.seen.begin(), track.seen.end(), set,
                                     [](const TrackPoint& s, SetId want) { return s.set < want; });
    if (at == track.seen.end() || at->set != set) continue;
    observations.push_back({p->position, p->covariance, at->undistorted_px.cast<double>()});
  }
  return observations;
}

bool good(const PoseResult& r, std::size_t observations, const LocaliseConfig& config) {
  return r.status == PoseStatus::kOk && r.inliers >= config.min_inliers &&
         r.inliers >= config.min_inlier_ratio * static_cast<double>(observations);
}

double sigma_bound_px(const Map& map, const MapCamera& camera) {
  return map.config().sigma_px * camera.model.width_px / 640.0;
}

void leave_map(Map& map, MapCamera& camera) {
  for (auto& [id, track] : camera.tracks) {
    if (track.point != PointId()) map.unbind(camera.id, track);
  }
  camera.map = MapId();
  camera.lost_sets = 0;
}

}  // namespace

Rigid3 start_pose(const Map& map, const MapCamera& camera, const TrackFrame& frame) {
  if (frame.pose_state == PoseState::kTracked && frame.epoch == map.epoch()) return frame.cam_from_world;
  const std::size_t n = camera.frames.size();
  const FramePose* last = nullptr;
  const FramePose* before = nullptr;
  for (std::size_t i = n - 1; i-- > 0 && before == nullptr;) {
    if (camera.frames[i].map != camera.map) continue;
    (last == nullptr ? last : before) = &camera.frames[i];
  }
  if (last == nullptr) return Rigid3();
  const std::uint32_t now = camera.frames.back().set.value;
  if (before == nullptr || last->set.value + 1 != now || before->set.value + 2 != now) return last->cam_from_world;
  return last->cam_from_world * before->cam_from_world.inverse() * last->cam_from_world;
}

LocaliseReport localise(Map& map, const FrameSet& set, const LocaliseConfig& config) {
  LocaliseReport report;
  for (const CameraFrame& cf : set.frames) {
    MapCamera& camera = map.camera(cf.camera);
    if (camera.map == MapId()) continue;
    auto observations = bound_observations(map, camera, set.id, camera.sparse);
    const Rigid3 start = start_pose(map, camera, cf.frame);
    PoseResult r = refine_pose(camera.model, observations, start, {.sigma_px = sigma_bound_px(map, camera)});
    if (!good(r, observations.size(), config) && !camera.sparse) {
      camera.sparse = true;  // better on points that may move than not at all
      observations = bound_observations(map, camera, set.id, true);
      r = refine_pose(camera.model, observations, start, {.sigma_px = sigma_bound_px(map, camera)});
    }
    if (good(r, observations.size(), config)) {
      camera.frames.back().cam_from_world = r.cam_from_world;
      camera.frames.back().map = camera.map;
      camera.sigma_px += std::max(0.1, 1.0 / ++camera.sigma_frames) * (r.sigma_px - camera.sigma_px);
      camera.lost_sets = 0;
      ++report.tracked;
    } else {
      ++report.lost;
      if (++camera.lost_sets > config.lost_after_sets) leave_map(map, camera);
    }
  }
  return report;
}

bool localise_past(Map& map, MapCamera& camera, SetId set, const Rigid3& start, const LocaliseConfig& config) {
  FramePose* frame = camera.frame_at(set);
  if (frame == nullptr) return false;
  const auto observations = bound_observations(map, camera, set, true);
  const PoseResult r = refine_pose(camera.model, observations, start, {.sigma_px = sigma_bound_px(map, camera)});
  if (!good(r, observations.size(), config)) return false;
  frame->cam_from_world = r.cam_from_world;
  frame->map = camera.map;
  return true;
}

void localise_backwards(Map& map, MapCamera& camera, SetId from, const LocaliseConfig& config) {
  const FramePose* known = camera.frame_at(from);
  Rigid3 pose = known->cam_from_world;
  for (std::size_t i = camera.frames.size(); i-- > 0;) {
    FramePose& f = camera.frames[i];
    if (f.set >= from) continue;
    if (f.valid()) break;
    if (!localise_past(map, camera, f.set, pose, config)) break;
    pose = f.cam_from_world;
  }
}

void set_pose(MapCamera& camera, SetId set, MapId map, const Rigid3& pose) {
  FramePose* f = camera.frame_at(set);
  f->map = map;
  f->cam_from_world = pose;
  camera.map = map;
  camera.lost_sets = 0;
}

}  // namespace coslam
