// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/point_pen.h"

#include <algorithm>
#include <vector>

#include "common/base/check.h"

namespace coslam {

const MapPoint& PointPen::create_point(MapId map, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance,
                                       PointPhase phase, Why why, Figures figures) {
  const PointId id(map_.next_point_++);
  MapPoint& p = map_.points_.all[id];
  p.id = id;
  p.map = map;
  p.phase = phase;
  p.position = position;
  p.covariance = covariance;
  p.created = map_.now_;
  p.first_ns = p.last_ns = map_.now_ns_;
  touch(p);
  map_.untracked_.insert(id);
  map_.points_.index(p, true);
  note_point(EventKind::kPointMade, p, why, figures);
  return p;
}

void PointPen::erase_point(PointId id) {
  map_.untracked_.erase(id);
  map_.points_.erase(id);
}

void PointPen::remove_point(const MapPoint& point, Why why, Figures figures) {
  const std::vector<BoundTrack> bound = point.bound;
  for (const BoundTrack& b : bound) unbind(b.camera, map_.track(b), Why::kPointGone);
  note_point(EventKind::kPointRemoved, point, why, figures);
  erase_point(point.id);
}

void PointPen::set_phase(MapPoint& point, PointPhase phase, Why why, Figures figures) {
  if (point.phase == phase) return;
  COSLAM_CHECK(may_become(point.phase, phase), "a point's phases follow the table in states.h");
  point.phase = phase;
  if (point.moves()) {
    map_.points_.moving.emplace(point.id, &point);
  } else {
    map_.points_.moving.erase(point.id);
  }
  note_point(EventKind::kPointBecame, point, why, figures);
}

void PointPen::move_point(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance) {
  mutable_point(point).position = position;
  mutable_point(point).covariance = covariance;
}

void PointPen::reposition_point(const MapPoint& point, const Eigen::Vector3d& position) {
  mutable_point(point).position = position;
  mutable_point(point).covariance = map_.covariance_of(point);
}

void PointPen::transform_point(const MapPoint& point, const Similarity3& new_from_old) {
  const Eigen::Matrix3d m = new_from_old.scale * new_from_old.rotation.toRotationMatrix();
  mutable_point(point).position = new_from_old * point.position;
  mutable_point(point).covariance = m * point.covariance * m.transpose();
}

void PointPen::forget_past(const MapPoint& map_point) {
  MapPoint& point = mutable_point(map_point);
  point.key_observations.clear();
  point.updated_from.clear();
  for (const BoundTrack& b : point.bound) distrust_before(map_.track(b), map_.now_);
}

void PointPen::see(const MapPoint& map_point) {
  MapPoint& point = mutable_point(map_point);
  ++point.views;
  point.last_ns = map_.now_ns_;
  touch(point);
}

void PointPen::keep_recent(const MapPoint& point) { touch(mutable_point(point)); }

void PointPen::follow(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance) {
  move_point(point, position, covariance);
  see(point);
}

void PointPen::note_ray(const MapPoint& point, CameraId camera, const Eigen::Vector3d& ray_in_world) {
  auto& rays = mutable_point(point).updated_from;
  if (rays.size() <= camera.value) rays.resize(camera.value + std::size_t{1}, Eigen::Vector3d::Zero());
  rays[camera.value] = ray_in_world;
}

void PointPen::prove(const MapPoint& point) {
  set_phase(mutable_point(point), PointPhase::kStatic, Why::kStoodTheTrial, {static_cast<double>(point.views), 0});
}

void PointPen::put_on_trial(MapId map, Why why) {
  for (const MapPoint* p : map_.recent_points()) {
    if (p->map == map && p->proven()) set_phase(mutable_point(*p), PointPhase::kTrial, why);
  }
}

void PointPen::start_moving(const MapPoint& point, const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance,
                            Why why, Figures figures) {
  set_phase(mutable_point(point), PointPhase::kMoving, why, figures);
  forget_past(point);
  follow(point, position, covariance);
  for (const BoundTrack& b : point.bound) {
    pass_gate(map_.track(b));
    mutable_track(b).motion = TrackMotion::kMoving;
  }
}

void PointPen::stop_moving(const MapPoint& map_point, int frames) {
  MapPoint& point = mutable_point(map_point);
  set_phase(point, PointPhase::kTrial, Why::kStopped, {static_cast<double>(frames), 0});
  point.views = 0;
  point.updated_from.clear();
  for (const BoundTrack& b : point.bound) {
    ServerTrack& t = mutable_track(b);
    t.motion = TrackMotion::kResting;
    t.gate_failures = 0;
    t.distrusted_before = t.seen[t.seen.size() - std::min(t.seen.size(), static_cast<std::size_t>(frames))].set.value;
  }
  point.covariance = map_.covariance_of(point);
}

void PointPen::keep_newest_patches(const MapPoint& point, std::size_t most) {
  auto& all = mutable_point(point).patches;
  if (all.size() > most) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(most));
}

void PointPen::thin_patches(std::size_t most) {
  for (const PointId id : map_.repatched_) {
    MapPoint* p = mutable_point(id);
    while (p != nullptr && p->patches.size() > most) p->patches.erase(p->patches.begin() + 1);
  }
  map_.repatched_.clear();
}

void PointPen::drop_observation(const MapPoint& point, SetId set, CameraId camera, TrackId track) {
  std::erase_if(mutable_point(point).key_observations,
                [&](const KeyObservation& k) { return k.set == set && k.camera == camera && k.track == track; });
}

void PointPen::fuse(PointId kept_id, PointId removed_id, Why why, Figures figures) {
  MapPoint* into = mutable_point(kept_id);
  MapPoint* from = mutable_point(removed_id);
  if (into == nullptr || from == nullptr || kept_id == removed_id) return;
  for (const BoundTrack& b : from->bound) {
    mutable_track(b).point = kept_id;
    into->bound.push_back(b);
  }
  if (!into->bound.empty()) map_.untracked_.erase(kept_id);
  for (const KeyObservation& o : from->key_observations) observe(*into, o);
  into->patches.insert(into->patches.end(), from->patches.begin(), from->patches.end());
  map_.repatched_.push_back(kept_id);
  into->views += from->views;
  if (from->proven() && into->rests()) set_phase(*into, PointPhase::kStatic, Why::kOtherWasProven);
  if (const auto moved = map_.motions_.find(removed_id); moved != map_.motions_.end()) {
    auto& path = map_.motions_[kept_id];
    path.insert(path.end(), moved->second.begin(), moved->second.end());
    std::stable_sort(path.begin(), path.end(), [](const auto& a, const auto& b) { return a.set < b.set; });
    map_.motions_.erase(removed_id);
  }
  into->last_seen = std::max(into->last_seen, from->last_seen);
  into->first_ns = std::min(into->first_ns, from->first_ns);
  into->last_ns = std::max(into->last_ns, from->last_ns);
  map_.points_.recent.emplace(kept_id, into);
  Event e = event(EventKind::kPointFused, why, figures);
  e.map = into->map;
  e.point = kept_id;
  e.other = removed_id;
  journal_.note(e);
  erase_point(removed_id);
}

}  // namespace coslam
