// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/edit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "common/base/check.h"
#include "common/geometry/robust.h"

// Cameras, poses, tracks, and the map as a whole. Points: edit_points.cpp.
namespace coslam {
namespace {

// Newest observations of a track; when it has twice as many, every other older one goes.
constexpr std::size_t kTrackKeepAll = 128;
constexpr std::size_t kNewest = 16;  // frames or sets that tell the time between two

void thin_out(std::vector<TrackPoint>& seen) {
  if (seen.size() <= 2 * kTrackKeepAll) return;
  const std::size_t old = seen.size() - kTrackKeepAll;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (i >= old || i % 2 == 0) seen[kept++] = seen[i];
  }
  seen.resize(kept);
}

// Of each part of the image the track that was followed longest.
std::vector<HeldTrack> held_tracks(const MapCamera& camera) {
  constexpr int kAcross = 8, kDown = 6;
  std::array<const ServerTrack*, std::size_t{kAcross} * kDown> longest{};
  for (const auto& [id, track] : camera.tracks) {
    const Eigen::Vector2d raw = camera.raw_px(track.seen.back().undistorted_px.cast<double>());
    const int x = std::clamp(static_cast<int>(raw.x() * kAcross / camera.model.width_px), 0, kAcross - 1);
    const int y = std::clamp(static_cast<int>(raw.y() * kDown / camera.model.height_px), 0, kDown - 1);
    const ServerTrack*& best = longest[static_cast<std::size_t>(y * kAcross + x)];
    if (best == nullptr || track.seen.front().set < best->seen.front().set) best = &track;
  }
  std::vector<HeldTrack> out;
  for (const ServerTrack* track : longest) {
    if (track != nullptr) out.push_back({track->id, track->seen.back().undistorted_px});
  }
  out.shrink_to_fit();
  return out;
}

// Median of what passed between these; empty when there are fewer than two.
std::optional<double> interval_s(std::span<const TimeNs> times_ns) {
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    if (times_ns[i] > times_ns[i - 1]) gaps_s.push_back(to_seconds(times_ns[i] - times_ns[i - 1]));
  }
  return gaps_s.empty() ? std::nullopt : std::optional(upper_median(gaps_s));
}

}  // namespace

// ---- the journal ----

Event MapEdit::event(EventKind kind, Why why, Figures figures) const {
  return {.set = map_.now_, .t_ns = map_.now_ns_, .kind = kind, .why = why, .figures = figures};
}

void MapEdit::note_track(EventKind kind, CameraId camera, const ServerTrack& track, Why why, Figures figures) {
  Event e = event(kind, why, figures);
  e.camera = camera;
  e.map = map_.camera(camera).map;
  e.track = track.id;
  e.point = track.point;
  e.to = static_cast<std::uint8_t>(track.motion);
  journal_.note(e);
}

void MapEdit::note_camera(EventKind kind, const MapCamera& camera, Why why, Figures figures) {
  Event e = event(kind, why, figures);
  e.camera = camera.id;
  e.map = camera.map;
  journal_.note(e);
}

void MapEdit::note_moved(MapId map, Why why, Figures figures) {
  Event e = event(EventKind::kMapMoved, why, figures);
  e.map = map;
  journal_.note(e);
}

// ---- cameras ----

CameraId MapEdit::add_camera(const std::string& name, RunId run, const CameraModel& model) {
  MapCamera camera;
  camera.id = CameraId(static_cast<std::uint16_t>(map_.cameras_.size()));
  camera.name = name;
  camera.run = run;
  camera.model = model;
  for (const RigCamera& r : map_.rigs_) {
    if (r.first == name) camera.rig = name;
    if (r.camera != name) continue;
    camera.rig = r.first;
    camera.cam_from_rig = r.cam_from_first;
    break;
  }
  map_.cameras_.push_back(std::move(camera));
  note_camera(EventKind::kCameraJoined, map_.cameras_.back(), Why::kHello);
  return map_.cameras_.back().id;
}

void MapEdit::restart_camera(CameraId id, RunId run, const CameraModel& model) {
  MapCamera& c = own(id);
  for (auto& [track_id, track] : c.tracks) end_track(id, track, Why::kRestarted);
  c.tracks.clear();
  c.run = run;
  c.run_since = SetId(map_.now_.value + 1);
  change_model(&c, model);
  c.map = MapId();
  c.clock_offset_ns = 0;
  c.alive = true;
  note_camera(EventKind::kCameraJoined, c, Why::kRestarted);
}

void MapEdit::measure_sigma(const MapCamera& camera, double sigma_px) {
  MapCamera& c = own(camera);
  c.sigma_px += std::max(0.1, 1.0 / ++c.sigma_frames) * (sigma_px - c.sigma_px);
}

void MapEdit::agent_was_told(const MapCamera& camera) {
  constexpr std::size_t kMost = 64;
  MapCamera& c = own(camera);
  c.moved = Similarity3();
  c.merged_from = MapId();
  if (c.told.empty() || c.told.back().epoch != map_.epoch_) c.told.push_back({map_.epoch_, Similarity3()});
  if (c.told.size() > kMost) c.told.pop_front();
}

// ---- poses ----

void MapEdit::place(const MapCamera& camera, SetId set, MapId map, const Rigid3& cam_from_world, Why why,
                    Figures figures) {
  MapCamera& c = own(camera);
  const bool anew = c.map != map || c.lost_sets > 0;
  if (c.map != map) c.told.clear();
  c.map = map;
  c.lost_sets = 0;
  set_pose(camera, set, cam_from_world);
  if (anew) note_camera(EventKind::kCameraPlaced, c, why, figures);
}

void MapEdit::set_pose(const MapCamera& camera, SetId set, const Rigid3& cam_from_world) {
  MapCamera& c = own(camera);
  FramePose& f = c.frames[static_cast<std::size_t>(c.frame_at(set) - c.frames.data())];
  f.map = c.map;
  f.cam_from_world = cam_from_world;
  if (c.lost_sets > 0) {
    note_camera(EventKind::kCameraFound, c, Why::kPoseAgain, {static_cast<double>(c.lost_sets), 0});
  }
  c.lost_sets = 0;
}

void MapEdit::set_joint_pose(const MapCamera& camera, const Rigid3& cam_from_world, bool rests_on_moving) {
  MapCamera& c = own(camera);
  set_pose(camera, c.frames.back().set, cam_from_world);
  c.frames.back().joint = rests_on_moving;
  c.corrected = true;
}

void MapEdit::take_word(const MapCamera& camera, const Rigid3& cam_from_world) {
  set_pose(camera, camera.frames.back().set, cam_from_world);
  own(camera).frames.back().joint = true;
}

int MapEdit::lose_pose(const MapCamera& camera, std::size_t known, int agree) {
  if (camera.lost_sets == 0) {
    note_camera(EventKind::kCameraLost, camera, Why::kNoPose, {static_cast<double>(known), static_cast<double>(agree)});
  }
  return ++own(camera).lost_sets;
}

void MapEdit::leave_map(const MapCamera& camera) {
  MapCamera& c = own(camera);
  for (auto& [id, track] : c.tracks) {
    if (track.bound()) unbind(c.id, track, Why::kCameraLeft);
  }
  note_camera(EventKind::kCameraLeft, c, Why::kLostTooLong, {static_cast<double>(c.lost_sets), 0});
  c.map = MapId();
  c.lost_sets = 0;
  c.told.clear();
}

void MapEdit::adjust_pose(const MapCamera& camera, const FramePose& frame, const Rigid3& cam_from_world) {
  own(camera).frames[static_cast<std::size_t>(&frame - camera.frames.data())].cam_from_world = cam_from_world;
}

void MapEdit::place_past(const MapCamera& camera, const FramePose& frame, MapId map, const Rigid3& cam_from_world) {
  own(camera).frames[static_cast<std::size_t>(&frame - camera.frames.data())].map = map;
  adjust_pose(camera, frame, cam_from_world);
}

void MapEdit::carry_agent(const MapCamera& camera, const Similarity3& new_from_old) {
  MapCamera& c = own(camera);
  c.moved = new_from_old * c.moved;
  for (ToldEpoch& t : c.told) t.moved = new_from_old * t.moved;
  c.scene_depth *= new_from_old.scale;
}

// ---- tracks ----

void MapEdit::ingest(const FrameSet& set) {
  COSLAM_CHECK(set.id.value == 0 || set.id > map_.now_ || map_.cameras_.empty(), "frame sets come in order");
  map_.now_ = set.id;
  map_.now_ns_ = set.t_ns;
  auto& times_ns = map_.set_times_ns_;
  times_ns.push_back(set.t_ns);
  if (times_ns.size() > kNewest) times_ns.erase(times_ns.begin());
  map_.set_interval_s_ = interval_s(times_ns).value_or(map_.set_interval_s_);
  erase_if(&map_.points_.recent, [&](const auto& entry) { return !map_.is_recent(entry.second->last_seen); });
  for (const CameraFrame& cf : set.frames) take_tracks(own(cf.camera), cf, set.id);
}

void MapEdit::take_tracks(MapCamera& c, const CameraFrame& cf, SetId set) {
  c.frames.push_back({set, cf.frame.frame, cf.frame.capture_ns, {}, {}});
  std::vector<TimeNs> times_ns;
  for (std::size_t i = c.frames.size() - std::min(c.frames.size(), kNewest); i < c.frames.size(); ++i) {
    times_ns.push_back(c.frames[i].capture_ns);
  }
  c.frame_interval_s = interval_s(times_ns).value_or(c.frame_interval_s);
  c.corrected = false;
  for (const TrackObservation& o : cf.frame.tracks) {
    ServerTrack& track = c.tracks[o.track];
    track.id = o.track;
    track.seen.push_back({set, o.undistorted_px});
    thin_out(track.seen);
  }
  const auto ended = [set](const auto& entry) { return entry.second.seen.back().set != set; };
  for (auto& entry : c.tracks) {
    if (ended(entry)) end_track(cf.camera, entry.second, Why::kImageEnded);
  }
  erase_if(&c.tracks, ended);
  c.frames.back().held = held_tracks(c);
  if (!cf.patches) return;
  for (const ImagePatch& p : cf.patches->patches) {
    const auto at = c.tracks.find(p.track);
    if (at == c.tracks.end()) continue;
    at->second.patch = p.grey;
    at->second.patch_set = set;
  }
}

// Its point no longer knows of it.
void MapEdit::let_go(CameraId camera, ServerTrack& track) {
  MapPoint* p = own(track.point);
  if (p == nullptr) return;
  std::erase(p->bound, BoundTrack{camera, track.id});
  if (p->bound.empty()) map_.loose_.insert(p->id);
}

void MapEdit::end_track(CameraId camera, ServerTrack& track, Why why) {
  note_track(EventKind::kTrackEnded, camera, track, why,
             {static_cast<double>(track.seen.back().set.value - track.seen.front().set.value + 1), 0});
  let_go(camera, track);
}

void MapEdit::bind(const MapPoint& to, CameraId camera, const ServerTrack& of, Why why, Figures figures) {
  MapPoint& point = own(to);
  ServerTrack& track = own(of);
  COSLAM_CHECK(!track.bound(), "a track is bound once");
  track.point = point.id;
  track.gate_failures = 0;
  point.bound.push_back({camera, track.id});
  map_.loose_.erase(point.id);
  for (const TrackPoint& s : track.seen) {
    if (s.set.value < track.distrusted_before || !map_.keeps_observations_of(s.set, camera)) continue;
    observe(point, {s.set, camera, track.id, s.undistorted_px});
  }
  give_patch(point, camera, track);
  note_track(EventKind::kTrackBound, camera, track, why, figures);
}

void MapEdit::bind_moving(const MapPoint& point, CameraId camera, const ServerTrack& track,
                          const Eigen::Vector2f& offset_px, Why why, Figures figures) {
  own(track).offset_px = offset_px;
  own(track).motion = TrackMotion::kMoving;
  bind(point, camera, track, why, figures);
  own(point).key_observations.clear();
}

void MapEdit::unbind(CameraId camera, const ServerTrack& of, Why why, Figures figures) {
  ServerTrack& track = own(of);
  note_track(EventKind::kTrackUnbound, camera, track, why, figures);
  let_go(camera, track);
  track.point = PointId();
  track.gate_failures = 0;
  track.offset_px.setZero();
}

int MapEdit::miss_gate(CameraId camera, const ServerTrack& track, double sigmas) {
  if (track.gate_failures == 0) {
    const Why why = std::isfinite(sigmas) ? Why::kOutsideGate : Why::kBehindCamera;
    note_track(EventKind::kTrackMissed, camera, track, why, {1, sigmas});
  }
  return ++own(track).gate_failures;
}

void MapEdit::set_motion(CameraId camera, const ServerTrack& track, TrackMotion motion, Figures figures) {
  if (track.motion == motion) return;
  const Why why = motion < track.motion ? Why::kStaticPlace : Why::kNoStaticPlace;
  own(track).motion = motion;
  note_track(EventKind::kTrackBecame, camera, track, why, figures);
}

// ---- the whole ----

void MapEdit::shift_times(TimeNs by_ns) {
  map_.now_ns_ += by_ns;
  map_.shifted_ns_ += by_ns;
  for (TimeNs& t_ns : map_.set_times_ns_) t_ns += by_ns;
  for (MapCamera& c : map_.cameras_) {
    for (FramePose& f : c.frames) f.capture_ns += by_ns;
    c.past.first_ns += by_ns;
    for (auto& [from_ns, to_ns] : c.past.lost) {
      from_ns += by_ns;
      to_ns += by_ns;
    }
  }
  for (auto& [id, p] : map_.points_.all) {
    p.first_ns += by_ns;
    p.last_ns += by_ns;
  }
  for (auto& [id, samples] : map_.motions_) {
    for (MotionSample& s : samples) s.t_ns += by_ns;
  }
}

MapId MapEdit::new_map(Why why, double figure) {
  Event e = event(EventKind::kMapStarted, why, {figure, 0});
  e.map = MapId(map_.next_map_++);
  journal_.note(e);
  return e.map;
}

void MapEdit::add_key_frame(SetId set, const std::vector<CameraId>& spared) {
  if (map_.is_key_frame(set)) return;
  const auto at = std::upper_bound(map_.key_frames_.begin(), map_.key_frames_.end(), KeyFrame{set},
                                   [](const KeyFrame& a, const KeyFrame& b) { return a.set < b.set; });
  map_.key_frames_.insert(at, {set});
  for (const CameraId camera : spared) map_.spared_images_.emplace(set, camera);
  for (const MapCamera& c : map_.cameras_) {
    if (!map_.keeps_observations_of(set, c.id)) continue;
    for (const auto& [id, t] : c.tracks) {
      MapPoint* p = own(t.point);
      if (p == nullptr || set.value < t.distrusted_before || t.gate_failures > 0) continue;
      if (const auto i = t.index_at(set)) observe(*p, {set, c.id, id, t.seen[*i].undistorted_px});
    }
  }
}

void MapEdit::add_key_image(SetId set, CameraId camera) {
  if (!map_.key_images_.emplace(set, camera).second || map_.is_key_frame(set)) return;
  for (const auto& [id, track] : map_.camera(camera).tracks) {
    MapPoint* p = own(track.point);
    if (p == nullptr || track.seen.back().set != set || track.gate_failures > 0) continue;
    observe(*p, {set, camera, id, track.seen.back().undistorted_px});
  }
}

void MapEdit::move_map(MapId map, const Similarity3& new_from_old) {
  for (const auto& [id, p] : map_.points_.all) {
    if (p.map == map) transform_point(p, new_from_old);
  }
  for (MapCamera& c : map_.cameras_) {
    for (FramePose& f : c.frames) {
      if (f.map == map) f.cam_from_world = transform_world(f.cam_from_world, new_from_old);
    }
    if (c.map != map) continue;
    carry_agent(c, new_from_old);
  }
  raise_epoch();
}

void MapEdit::transform(MapId map, const Similarity3& new_from_old, Why why) {
  move_map(map, new_from_old);
  map_.moves_.push_back({map, map, new_from_old});
  note_moved(map, why, {new_from_old.scale, 0});
}

void MapEdit::merge(MapId from, MapId into, const Similarity3& into_from_from) {
  move_map(from, into_from_from);
  map_.moves_.push_back({from, into, into_from_from});
  for (auto& [id, p] : map_.points_.all) {
    if (p.map == from) p.map = into;
  }
  for (MapCamera& c : map_.cameras_) {
    for (FramePose& f : c.frames) {
      if (f.map == from) f.map = into;
    }
    if (const auto past = c.past.placed.extract(from)) c.past.placed[into] += past.mapped();
    if (c.map != from) continue;
    c.map = into;
    if (c.merged_from == MapId()) c.merged_from = from;
  }
  Event e = event(EventKind::kMapMerged, Why::kMapsMet, {into_from_from.scale, 0});
  e.map = into;
  e.from = from;
  journal_.note(e);
}

}  // namespace coslam
