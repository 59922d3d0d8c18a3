// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/pose/localise.h"

#include <algorithm>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/map/sighting.h"

namespace coslam {
namespace {

std::vector<PointObservation> bound_observations(const Map& map, const MapCamera& camera, SetId set,
                                                 bool on_trial_too) {
  std::vector<PointObservation> observations;
  for (const auto& [id, track] : camera.tracks) {
    if (!track.bound() || set.value < track.distrusted_before) continue;
    const MapPoint* p = map.find(track.point);
    if (!p->proven() && !(p->rests() && on_trial_too)) continue;
    const auto i = track.index_at(set);
    if (i) observations.push_back({p->position, p->covariance, track.seen[*i].undistorted_px.cast<double>()});
  }
  return observations;
}

// Where points are few: tracks without one, by their directions. Beside many points they add little but the error of
// what is taken to rest.
void add_far(const Map& map, const MapCamera& camera, SetId set, std::vector<PointObservation>* observations) {
  if (static_cast<int>(observations->size()) >= map.config().few_points) return;
  for (const auto& [id, track] : camera.tracks) {
    if (track.seen.back().set != set) continue;
    const auto far = far_point_of(map, camera, track);
    if (far)
      observations->push_back({far->position, far->covariance, track.seen.back().undistorted_px.cast<double>(), true});
  }
}

double median_depth(const std::vector<PointObservation>& observations, const PoseResult& pose, int least) {
  std::vector<double> depths;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (pose.is_inlier[i] && !observations[i].far)
      depths.push_back((pose.cam_from_world * observations[i].point_in_world).z());
  }
  return static_cast<int>(depths.size()) < least ? 0 : upper_median(depths);
}

bool good(const PoseResult& r, const LocaliseConfig& config) {
  return r.status == PoseStatus::kOk && r.inliers >= config.min_inliers;
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

LocaliseReport localise(MapEdit& edit, const FrameSet& set, const LocaliseConfig& config) {
  const Map& map = edit.map();
  LocaliseReport report;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (camera.map == MapId()) continue;
    auto observations = bound_observations(map, camera, set.id, camera.sparse);
    add_far(map, camera, set.id, &observations);
    const Rigid3 start = start_pose(map, camera, cf.frame);
    PoseResult r = refine_pose(camera.model, observations, start, {.sigma_px = map.sigma_bound_px(camera)});
    if (!good(r, config) && !camera.sparse) {
      edit.set_sparse(camera, true);  // better on points that may move than not at all
      observations = bound_observations(map, camera, set.id, true);
      add_far(map, camera, set.id, &observations);
      r = refine_pose(camera.model, observations, start, {.sigma_px = map.sigma_bound_px(camera)});
    }
    if (good(r, config)) {
      edit.set_pose(camera, set.id, r.cam_from_world);
      edit.measure_sigma(camera, r.sigma_px);
      if (const double depth = median_depth(observations, r, config.min_inliers); depth > 0)
        edit.set_scene_depth(camera, depth);
      ++report.tracked;
    } else {
      ++report.lost;
      const int lost = edit.lose_pose(camera, observations.size(), r.inliers);
      if (lost > camera.frames_in(config.lost_after_s, kLeastFrames)) edit.leave_map(camera);
    }
  }
  return report;
}

bool localise_past(MapEdit& edit, const MapCamera& camera, SetId set, const Rigid3& start,
                   const LocaliseConfig& config) {
  const Map& map = edit.map();
  if (camera.frame_at(set) == nullptr) return false;
  const auto observations = bound_observations(map, camera, set, true);
  const PoseResult r = refine_pose(camera.model, observations, start, {.sigma_px = map.sigma_bound_px(camera)});
  if (!good(r, config)) return false;
  edit.set_pose(camera, set, r.cam_from_world);
  return true;
}

void localise_backwards(MapEdit& edit, const MapCamera& camera, SetId from, const LocaliseConfig& config) {
  const FramePose* known = camera.frame_at(from);
  Rigid3 pose = known->cam_from_world;
  for (std::size_t i = camera.frames.size(); i-- > 0;) {
    const FramePose& f = camera.frames[i];
    if (f.set >= from) continue;
    if (f.valid()) break;
    if (!localise_past(edit, camera, f.set, pose, config)) break;
    pose = f.cam_from_world;
  }
}

}  // namespace coslam
