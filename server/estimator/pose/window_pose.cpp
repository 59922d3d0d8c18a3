// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/window_pose.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#include "common/geometry/far_point.h"
#include "server/estimator/map/lens_step.h"
#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

double sigma_px(const CameraLens& camera) { return std::max(kLeastSigma_px, camera.sigma_px); }

// Every view with a free pose, and some of those before.
std::vector<TrackPoint> views_of_use(const std::vector<TrackPoint>& seen, SetId free_since, bool older_too) {
  const auto free = std::ranges::find_if(seen, [&](const TrackPoint& s) { return s.set >= free_since; });
  const auto older = static_cast<std::size_t>(free - seen.begin());
  std::vector<TrackPoint> out;
  if (older_too) {
    const std::size_t most = std::min(older, kViewsOfTrack);
    for (std::size_t k = 0; k < most; ++k) out.push_back(seen[most == 1 ? older - 1 : k * (older - 1) / (most - 1)]);
  }
  out.insert(out.end(), free, seen.end());
  return out;
}

int points_seen(const Map& map, const MapCamera& camera) {
  return static_cast<int>(std::ranges::count_if(camera.tracks, [&](const auto& t) {
    const MapPoint* p = map.find(t.second.point);
    return p != nullptr && p->rests();
  }));
}

}  // namespace

// The poses of a window, and where each stands in the problem.
class WindowPose::Poses {
 public:
  Poses(const MapCamera& camera, SetId free_since, WindowProblem* problem)
      : camera_(camera), free_since_(free_since), problem_(problem) {}

  SetId free_since() const { return free_since_; }
  const Rigid3& start(int at) const { return problem_->cam_from_world[static_cast<std::size_t>(at)]; }
  // Of that set; empty when the camera has none there in its map.
  std::optional<int> at(SetId set) {
    const auto known = index_.find(set);
    if (known != index_.end()) return known->second;
    const FramePose* f = camera_.frame_at(set);
    if (f == nullptr || f->map != camera_.map) return std::nullopt;
    problem_->cam_from_world.push_back(f->cam_from_world);
    problem_->is_free.push_back(set >= free_since_ && !f->joint);
    return index_.emplace(set, static_cast<int>(problem_->is_free.size()) - 1).first->second;
  }
  void give_back(const WindowResult& solved, WindowPoseEdit* edit) const {
    for (const auto& [set, at] : index_) {
      const auto i = static_cast<std::size_t>(at);
      if (problem_->is_free[i]) edit->adjust_pose(camera_, *camera_.frame_at(set), solved.cam_from_world[i]);
    }
  }

 private:
  const MapCamera& camera_;
  SetId free_since_;
  WindowProblem* problem_;
  std::map<SetId, int> index_;
};

void WindowPose::remember(const Map& map, const MapCamera& camera, OfCamera* window) const {
  if (window->run != camera.run) *window = {.run = camera.run, .lens = camera.lens};
  if (const LensStep step(camera.model, std::exchange(window->lens, camera.lens), camera.lens); !step.none()) {
    for (auto& [id, f] : window->tracks) {
      for (TrackPoint& p : f.seen) step.move(&p.undistorted_px);
    }
  }
  const SetId ended_before = map.set_ago(config.free_s), seen_before = map.set_ago(config.seen_s);
  for (const auto& [id, track] : camera.tracks) {
    Followed& f = window->tracks[id];
    f.seen.push_back(track.seen.back());
    f.point = track.point;
    f.rests = track.motion == TrackMotion::kResting;
    if (f.seen.front().set < seen_before || f.seen.front().set.value < track.distrusted_before) {
      const SetId from = std::max(seen_before, SetId(track.distrusted_before));
      f.seen.erase(f.seen.begin(), std::ranges::lower_bound(f.seen, from, {}, &TrackPoint::set));
    }
  }
  const auto ended = [&](const auto& entry) {
    return entry.second.seen.empty() || entry.second.seen.back().set < ended_before;
  };
  if (std::ranges::any_of(window->tracks, ended)) erase_if(&window->tracks, ended);
}

// What was followed as one of the things of the window; empty when it tells nothing.
std::optional<WindowThing> WindowPose::thing_of(const Map& map, const MapCamera& camera, const Followed& f,
                                                Poses* poses) const {
  const MapPoint* p = map.find(f.point);
  if (!f.rests || (p != nullptr && (!p->rests() || p->map != camera.map))) return std::nullopt;
  WindowThing thing;
  std::vector<View> views;
  for (const TrackPoint& s : views_of_use(f.seen, poses->free_since(), p == nullptr)) {
    const auto at = poses->at(s.set);
    if (!at) continue;
    thing.seen.emplace_back(*at, s.undistorted_px.cast<double>());
    views.push_back({&camera.model, poses->start(*at), thing.seen.back().second});
  }
  if (thing.seen.size() < (p != nullptr ? 1U : 2U)) return std::nullopt;
  thing.frame_from_world = views.front().cam_from_world;
  if (p != nullptr) return set_known(p->position, p->covariance, &thing) ? std::optional(thing) : std::nullopt;
  const double usual = 1 / camera.scene_depth;
  const Eigen::Vector2d ray = camera.model.normalized_from_pixel(thing.seen.front().second);
  if (!f.place || !set_start(*f.place, &thing)) {
    const FarPoint start = far_point(views, camera.scene_depth, sigma_px(camera));
    thing.theta = {ray.x(), ray.y(), start.inverse_depth};
  }
  thing.prior = {ray.x(), ray.y(), usual};
  thing.information(2, 2) = 1 / (usual * usual);
  return thing;
}

bool WindowPose::solve(WindowPoseEdit& edit, const MapCamera& camera, OfCamera* window) const {
  const auto frames = static_cast<std::size_t>(camera.frames_in(config.free_s, kLeastFrames));
  const auto present = camera.present_frames();
  if (present.size() <= frames || camera.scene_depth <= 0) return false;
  WindowProblem problem{.camera = &camera.model, .sigma_px = sigma_px(camera)};
  Poses poses(camera, present[present.size() - frames].set, &problem);
  std::vector<Followed*> followed;
  for (auto& [id, f] : window->tracks) {
    auto thing = thing_of(edit.map(), camera, f, &poses);
    if (!thing) continue;
    problem.things.push_back(std::move(*thing));
    followed.push_back(&f);
  }
  if (std::ranges::none_of(problem.is_free, std::identity{})) return false;
  const WindowResult r = solve_window(problem);
  poses.give_back(r, &edit);
  for (std::size_t i = 0; i < followed.size(); ++i) {
    followed[i]->place = place_of(problem.things[i].frame_from_world, r.theta[i]);
  }
  edit.push_pose_to_agent(camera);
  return true;
}

WindowPoseReport WindowPose::run(WindowPoseEdit& edit, const FrameSet& set, Workers& workers) {
  WindowPoseReport report;
  const Map& map = edit.map();
  if (!config.enabled) return report;
  std::vector<OfCamera*> of_cameras;
  for (const CameraFrame& cf : set.frames) of_cameras.push_back(&cameras_[cf.camera]);
  workers.each(of_cameras.size(), [&](std::size_t i) {
    const MapCamera& camera = map.camera(set.frames[i].camera);
    OfCamera& window = *of_cameras[i];
    remember(map, camera, &window);
    window.in_need = points_seen(map, camera) < map.config().few_points / (window.in_need ? 1 : 2);
  });
  for (std::size_t i = 0; i < of_cameras.size(); ++i) {
    const MapCamera& camera = map.camera(set.frames[i].camera);
    OfCamera& window = *of_cameras[i];
    if (!window.in_need || camera.map == MapId() || !camera.frames.back().valid() || map.is_posed_by_rig(camera))
      continue;
    if (solve(edit, camera, &window)) report.solved.push_back(camera.id);
  }
  return report;
}

}  // namespace coslam
