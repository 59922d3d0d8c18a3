// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/track_pen.h"

#include <cmath>
#include <vector>

#include "common/base/check.h"

namespace coslam {

// Its point no longer knows of it.
void TrackPen::let_go(CameraId camera, ServerTrack& track) {
  MapPoint* p = mutable_point(track.point);
  if (p == nullptr) return;
  std::erase(p->bound, BoundTrack{camera, track.id});
  if (p->bound.empty()) map_.untracked_.insert(p->id);
}

void TrackPen::end_track(CameraId camera, ServerTrack& track, Why why) {
  note_track(EventKind::kTrackEnded, camera, track, why,
             {static_cast<double>(track.seen.back().set.value - track.seen.front().set.value + 1), 0});
  let_go(camera, track);
}

void TrackPen::bind(const MapPoint& to, CameraId camera, const ServerTrack& server_track, Why why, Figures figures) {
  MapPoint& point = mutable_point(to);
  ServerTrack& track = mutable_track(server_track);
  COSLAM_CHECK(!track.bound(), "a track is bound once");
  track.point = point.id;
  track.gate_failures = 0;
  point.bound.push_back({camera, track.id});
  map_.untracked_.erase(point.id);
  for (const TrackPoint& s : track.seen) {
    if (s.set.value < track.distrusted_before || !map_.keeps_observations_of(s.set, camera)) continue;
    observe(point, {s.set, camera, track.id, s.undistorted_px});
  }
  give_patch(point, camera, track);
  note_track(EventKind::kTrackBound, camera, track, why, figures);
}

void TrackPen::bind_moving(const MapPoint& point, CameraId camera, const ServerTrack& track,
                           const Eigen::Vector2f& offset_px, Why why, Figures figures) {
  mutable_track(track).offset_px = offset_px;
  mutable_track(track).motion = TrackMotion::kMoving;
  bind(point, camera, track, why, figures);
  mutable_point(point).key_observations.clear();
}

void TrackPen::unbind(CameraId camera, const ServerTrack& server_track, Why why, Figures figures) {
  ServerTrack& track = mutable_track(server_track);
  note_track(EventKind::kTrackUnbound, camera, track, why, figures);
  let_go(camera, track);
  track.point = PointId();
  track.gate_failures = 0;
  track.offset_px.setZero();
}

void TrackPen::give_patch(const MapPoint& point, CameraId camera, const ServerTrack& track) {
  if (!track.patch) return;
  mutable_point(point).patches.push_back({camera, track.patch_set, *track.patch, track.offset_px});
  map_.repatched_.push_back(point.id);
}

int TrackPen::miss_gate(CameraId camera, const ServerTrack& track, double sigmas) {
  if (track.gate_failures == 0) {
    const Why why = std::isfinite(sigmas) ? Why::kOutsideGate : Why::kBehindCamera;
    note_track(EventKind::kTrackMissed, camera, track, why, {1, sigmas});
  }
  return ++mutable_track(track).gate_failures;
}

void TrackPen::set_motion(CameraId camera, const ServerTrack& track, TrackMotion motion, Figures figures) {
  if (track.motion == motion) return;
  const Why why = motion < track.motion ? Why::kStaticPlace : Why::kNoStaticPlace;
  mutable_track(track).motion = motion;
  note_track(EventKind::kTrackBecame, camera, track, why, figures);
}

}  // namespace coslam
