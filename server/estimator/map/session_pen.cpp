// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/session_pen.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include "common/base/check.h"
#include "common/geometry/robust.h"

namespace coslam {
namespace {

// Newest observations of a track; when it has twice as many, every other older one goes.
constexpr std::size_t kTrackKeepAll = 128;
constexpr std::size_t kNewest = 16;  // frames or sets that tell the time between two

void thin_out(std::vector<TrackPoint>& seen) {
  if (seen.size() <= 2 * kTrackKeepAll) return;
  const std::size_t old = seen.size() - kTrackKeepAll;
  std::size_t count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (i >= old || i % 2 == 0) seen[count++] = seen[i];
  }
  seen.resize(count);
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

CameraId SessionPen::add_camera(const std::string& name, RunId run, const CameraModel& model) {
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

void SessionPen::restart_camera(CameraId id, RunId run, const CameraModel& model) {
  MapCamera& c = mutable_camera(id);
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

void SessionPen::ingest(const FrameSet& set) {
  COSLAM_CHECK(set.id.value == 0 || set.id > map_.now_ || map_.cameras_.empty(), "frame sets come in order");
  map_.now_ = set.id;
  map_.now_ns_ = set.t_ns;
  auto& times_ns = map_.set_times_ns_;
  times_ns.push_back(set.t_ns);
  if (times_ns.size() > kNewest) times_ns.erase(times_ns.begin());
  map_.set_interval_s_ = interval_s(times_ns).value_or(map_.set_interval_s_);
  erase_if(&map_.points_.recent, [&](const auto& entry) { return !map_.is_recent(entry.second->last_seen); });
  for (const CameraFrame& cf : set.frames) take_tracks(mutable_camera(cf.camera), cf, set.id);
}

void SessionPen::take_tracks(MapCamera& c, const CameraFrame& cf, SetId set) {
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

void SessionPen::shift_times(TimeNs by_ns) {
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

}  // namespace coslam
