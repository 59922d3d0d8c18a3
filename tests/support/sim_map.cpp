// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/sim_map.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <string>
#include <utility>

#include "server/estimator/map/sighting.h"

namespace coslam::test {

SimMap::SimMap(const SimWorld& w, const std::vector<CameraPath>& paths, const TrackingConfig& tracking,
               const MapConfig& config)
    : world(w), edit(config), map(edit.map()) {
  for (const CameraPath& path : paths) {
    const std::size_t i = trackers.size();
    trackers.emplace_back(world, path, tracking, "cam" + std::to_string(i), RunId(100 + i));
    const CameraId c = edit.add_camera(trackers[i].name(), trackers[i].run(), sim_camera());
    edit.measure_sigma(map.camera(c), std::max(0.4, tracking.noise_px));
  }
  id = edit.new_map(Why::kStartedTogether, static_cast<double>(paths.size()));
}

FrameSet& SimMap::look(bool patches, bool descriptors) {
  set = FrameSet{SetId(next_set_), period_ns * next_set_, {}};
  for (std::size_t i = 0; i < trackers.size(); ++i) {
    CameraFrame cf{CameraId(static_cast<std::uint16_t>(i)), trackers[i].observe(FrameId(next_set_), set.t_ns), {}, {}};
    std::vector<TrackId> all;
    for (const TrackObservation& o : cf.frame.tracks) all.push_back(o.track);
    if (patches) cf.patches = trackers[i].cut(cf.frame, all);
    if (descriptors) cf.descriptors = trackers[i].describe(cf.frame);
    set.frames.push_back(std::move(cf));
  }
  ++next_set_;
  return set;
}

const FrameSet& SimMap::ingest(bool patches, bool descriptors) {
  look(patches, descriptors);
  take();
  return set;
}

void SimMap::place(CameraId camera, MapId in, const Rigid3& cam_from_world) {
  edit.place(map.camera(camera), set.id, in, cam_from_world, Why::kStartedTogether);
}

void SimMap::place_truly(CameraId camera) { place(camera, truth(camera, set.id)); }

void SimMap::place_truly() {
  for (const CameraFrame& cf : set.frames) place_truly(cf.camera);
}

void SimMap::advance(int sets, bool patches) {
  for (int i = 0; i < sets; ++i) {
    ingest(patches);
    place_truly();
  }
}

const MapPoint& SimMap::create(MapId in, const Eigen::Vector3d& position, double sigma_m, PointPhase phase) {
  return edit.create_point(in, position, sigma_m * sigma_m * Eigen::Matrix3d::Identity(), phase,
                           phase == PointPhase::kMoving ? Why::kMetWhileMoving : Why::kTwoCamerasNow);
}

const MapPoint& SimMap::add_point(int point, double sigma_m, const Eigen::Vector3d& off_m, PointPhase phase) {
  const MapPoint& p = create(world.position(point, set.t_ns) + off_m, sigma_m, phase);
  for (const MapCamera& c : map.cameras()) {
    const ServerTrack* t = track_of(c.id, point);
    if (c.map != id || t == nullptr || t->bound()) continue;
    if (p.moves()) {
      edit.bind_moving(p, c.id, *t, Eigen::Vector2f::Zero(), Why::kMadeFromIt);
    } else {
      bind(p, c.id, *t);
    }
  }
  return p;
}

void SimMap::add_points(double sigma_m) {
  std::normal_distribution<double> normal(0, sigma_m);
  std::vector<bool> has(static_cast<std::size_t>(world.size()), false);
  for (const auto& [point_id, p] : map.points()) {
    const int point = world_point(p);
    if (point >= 0) has[static_cast<std::size_t>(point)] = true;
  }
  for (int point = 0; point < world.size(); ++point) {
    if (has[static_cast<std::size_t>(point)] || world.moves(point)) continue;
    const bool seen = std::any_of(map.cameras().begin(), map.cameras().end(),
                                  [&](const MapCamera& c) { return c.map == id && track_of(c.id, point) != nullptr; });
    if (seen) add_point(point, sigma_m, {normal(random_), normal(random_), normal(random_)});
  }
}

void SimMap::record_now(const MapPoint& point) {
  MotionSample sample{.set = set.id, .t_ns = set.t_ns};
  for (const BoundTrack& b : point.bound) {
    const ServerTrack& t = map.track(b);
    sample.seen.push_back(sighting(map.camera(b.camera), t, t.seen.size() - 1));
  }
  edit.record_motion(point.id, std::move(sample));
}

int SimMap::world_point(const MapPoint& point) const {
  if (!point.bound.empty()) return world_point(point.bound.front().camera, point.bound.front().track);
  if (!point.key_observations.empty()) {
    return world_point(point.key_observations.front().camera, point.key_observations.front().track);
  }
  return -1;
}

const ServerTrack* SimMap::track_of(CameraId camera, int point) const {
  const auto id_of = trackers[camera.value].track_of(point);
  if (!id_of) return nullptr;
  const auto at = map.camera(camera).tracks.find(*id_of);
  return at == map.camera(camera).tracks.end() ? nullptr : &at->second;
}

bool SimMap::all_follow(int world_point) const {
  return std::ranges::all_of(map.cameras(), [&](const MapCamera& c) { return track_of(c.id, world_point) != nullptr; });
}

TrackObservation* SimMap::seen(CameraId camera, int point) {
  const auto track = trackers[camera.value].track_of(point);
  auto& all = set.frames[camera.value].frame.tracks;
  const auto at = std::ranges::find_if(all, [&](const TrackObservation& o) { return o.track == track; });
  return at == all.end() ? nullptr : &*at;
}

ImagePatch* SimMap::patch_of(CameraId camera, int point) {
  const auto track = trackers[camera.value].track_of(point);
  auto& reply = set.frames[camera.value].patches;
  if (!reply) return nullptr;
  const auto at = std::ranges::find_if(reply->patches, [&](const ImagePatch& p) { return p.track == track; });
  return at == reply->patches.end() ? nullptr : &*at;
}

Rigid3 SimMap::truth(CameraId camera, SetId at) const { return trackers[camera.value].truth(period_ns * at.value); }

double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.dot(covariance.ldlt().solve(error));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace coslam::test
