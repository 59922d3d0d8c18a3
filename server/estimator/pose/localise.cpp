// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/localise.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/estimator/map/sighting.h"

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

namespace {

// Cameras whose pose is one: a free camera, or those of a rig in a metric map that have a frame now.
struct Body {
  std::vector<const CameraFrame*> frames;
  std::vector<RigView> views;
};

std::vector<Body> bodies_of(const Map& map, const FrameSet& set) {
  std::vector<Body> out;
  std::map<std::string, std::size_t> rigs;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (camera.map == MapId()) continue;
    if (!map.is_posed_by_rig(camera)) {
      out.push_back({{&cf}, {{&camera.model, Rigid3()}}});
      continue;
    }
    const auto [at, added] = rigs.try_emplace(camera.rig + "/" + std::to_string(camera.map.value), out.size());
    if (added) out.emplace_back();
    out[at->second].frames.push_back(&cf);
    out[at->second].views.push_back({&camera.model, camera.cam_from_rig});
  }
  return out;
}

// Of points that may move, too, where few others are seen now; sparse: in any case.
std::vector<PointObservation> observations_of(const Map& map, const Body& body, SetId set, bool sparse) {
  std::vector<PointObservation> all;
  for (std::size_t i = 0; i < body.frames.size(); ++i) {
    const MapCamera& camera = map.camera(body.frames[i]->camera);
    const bool on_trial_too = camera.sparse || sparse;
    auto observations = bound_observations(map, camera, set, on_trial_too);
    if (!on_trial_too && static_cast<int>(observations.size()) < map.config().few_points) {
      observations = bound_observations(map, camera, set, true);
    }
    add_far(map, camera, set, &observations);
    for (PointObservation& o : observations) {
      o.camera = static_cast<int>(i);
      all.push_back(o);
    }
  }
  return all;
}

double sigma_bound_px(const Map& map, const Body& body) {
  double most_px = 0;
  for (const CameraFrame* cf : body.frames) most_px = std::max(most_px, map.sigma_bound_px(map.camera(cf->camera)));
  return most_px;
}

// The newest pose that one of its cameras tells.
Rigid3 start_of(const Map& map, const Body& body) {
  std::size_t best = 0;
  for (std::size_t i = body.frames.size(); i-- > 0;) {
    if (body.frames[i]->frame.pose_state == PoseState::kTracked) best = i;
  }
  const CameraFrame& cf = *body.frames[best];
  return body.views[best].cam_from_rig.inverse() * start_pose(map, map.camera(cf.camera), cf.frame);
}

// What its cameras see of the inliers; 0 where one sees too few.
double depth_of(const std::vector<PointObservation>& observations, const PoseResult& r, const Body& body, std::size_t i,
                int least) {
  std::vector<double> depths;
  const Rigid3 cam_from_world = body.views[i].cam_from_rig * r.cam_from_world;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const PointObservation& o = observations[k];
    if (r.is_inlier[k] && !o.far && o.camera == static_cast<int>(i)) {
      depths.push_back((cam_from_world * o.point_in_world).z());
    }
  }
  return static_cast<int>(depths.size()) < least ? 0 : upper_median(depths);
}

// Where an agent says that it is by points of its own, that the map has not: the server was away, or is another one.
std::optional<Rigid3> own_word(const Map& map, const MapCamera& camera, const TrackFrame& frame) {
  const bool firm = frame.pose_inliers >= kFirmPoints && frame.hull_fraction >= static_cast<float>(kFirmHull);
  if (!frame.on_own_points || !firm || frame.pose_state != PoseState::kTracked || map.is_posed_by_rig(camera))
    return std::nullopt;
  const auto moved = camera.moved_since(frame.epoch);
  return moved ? std::optional(transform_world(frame.cam_from_world, *moved)) : std::nullopt;
}

// It rests on points of its own, and has not heard yet that this server goes on with the map: its word comes with the
// next frames, and is better than what few points say.
bool speaks_soon(const TrackFrame& frame) { return frame.on_own_points && frame.pose_state == PoseState::kNone; }

// Inliers but for directions.
int points_that_agree(const std::vector<PointObservation>& observations, const PoseResult& r) {
  int n = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) n += r.is_inlier[i] && !observations[i].far;
  return n;
}

struct Solved {
  std::vector<PointObservation> observations;
  PoseResult pose;
  bool sparse = false;  // better on points that may move than not at all
};

Solved solve(const Map& map, SetId set, const Body& body, const LocaliseConfig& config) {
  Solved out{observations_of(map, body, set, false), {}};
  const Rigid3 start = start_of(map, body);
  const PoseRefinementConfig refinement{.sigma_px = sigma_bound_px(map, body)};
  out.pose = refine_rig_pose(body.views, out.observations, start, refinement);
  const auto sparse = [&](const CameraFrame* cf) { return map.camera(cf->camera).sparse; };
  if (good(out.pose, config) || std::ranges::all_of(body.frames, sparse)) return out;
  out.sparse = true;
  out.observations = observations_of(map, body, set, true);
  out.pose = refine_rig_pose(body.views, out.observations, start, refinement);
  return out;
}

void place(LocaliseEdit& edit, const FrameSet& set, const Body& body, const Solved& solved,
           const LocaliseConfig& config, LocaliseReport* report) {
  const Map& map = edit.map();
  const auto& [observations, r, sparse] = solved;
  if (sparse) {
    for (const CameraFrame* cf : body.frames) edit.set_sparse(map.camera(cf->camera), true);
  }
  const bool firm = good(r, config) && points_that_agree(observations, r) >= kFirmPoints;
  for (std::size_t i = 0; i < body.frames.size(); ++i) {
    const MapCamera& camera = map.camera(body.frames[i]->camera);
    const auto agent_pose = firm ? std::nullopt : own_word(map, camera, body.frames[i]->frame);
    if (agent_pose) {
      edit.accept_agent_pose(camera, *agent_pose);
      ++report->on_own_word;
    } else if (good(r, config) && (firm || !speaks_soon(body.frames[i]->frame))) {
      edit.set_pose(camera, set.id, body.views[i].cam_from_rig * r.cam_from_world);
      edit.measure_sigma(camera, r.sigma_px);
      const double depth = depth_of(observations, r, body, i, config.min_inliers);
      if (depth > 0) edit.set_scene_depth(camera, depth);
      ++report->tracked;
    } else {
      ++report->lost;
      const int lost = edit.lose_pose(camera, observations.size(), r.inliers);
      if (lost > camera.frames_in(config.lost_after_s, kLeastFrames)) edit.leave_map(camera);
    }
  }
}

// A camera of a rig is where the others of it are.
void place_mates(LocaliseEdit& edit, const FrameSet& set, LocaliseReport* report) {
  const Map& map = edit.map();
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (camera.map != MapId()) continue;
    for (const CameraId id : map.rig_mates(camera)) {
      const MapCamera& mate = map.camera(id);
      if (mate.frames.empty() || mate.frames.back().set != set.id || !mate.frames.back().valid()) continue;
      if (!map.is_metric(mate.map)) continue;
      const Rigid3 rig_from_world = mate.cam_from_rig.inverse() * mate.frames.back().cam_from_world;
      edit.place(camera, set.id, mate.map, camera.cam_from_rig * rig_from_world, Why::kRig, {});
      ++report->tracked;
      break;
    }
  }
}

}  // namespace

LocaliseReport localise(LocaliseEdit& edit, const FrameSet& set, const LocaliseConfig& config, Workers& workers) {
  LocaliseReport report;
  const std::vector<Body> bodies = bodies_of(edit.map(), set);
  std::vector<Solved> solved(bodies.size());
  workers.each(bodies.size(), [&](std::size_t i) { solved[i] = solve(edit.map(), set.id, bodies[i], config); });
  for (std::size_t i = 0; i < bodies.size(); ++i) place(edit, set, bodies[i], solved[i], config, &report);
  place_mates(edit, set, &report);
  return report;
}

bool localise_past(FramePoseEdit& edit, const MapCamera& camera, SetId set, const Rigid3& start,
                   const LocaliseConfig& config) {
  const Map& map = edit.map();
  if (camera.frame_at(set) == nullptr) return false;
  const auto observations = bound_observations(map, camera, set, true);
  const PoseResult r = refine_pose(camera.model, observations, start, {.sigma_px = map.sigma_bound_px(camera)});
  if (!good(r, config)) return false;
  edit.set_pose(camera, set, r.cam_from_world);
  return true;
}

void localise_backwards(FramePoseEdit& edit, const MapCamera& camera, SetId from, const LocaliseConfig& config) {
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
