// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/classify.h"

#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "server/estimator/associate/verify.h"
#include "server/estimator/map/sighting.h"
#include "server/estimator/motion/follow.h"
#include "server/estimator/motion/rebind.h"

namespace coslam {
namespace {

constexpr float kMostStaticOffset_px = 0.7F;

// Several cameras see it elsewhere: it moves if they agree on where it is now, else it never was one place.
void judge_point(ClassifyEdit& edit, const MapPoint& p, ClassifyReport* report) {
  const Map& map = edit.map();
  ++report->uncertain;
  const std::vector<Seen> seen = seen_now(map, p);
  const Figures cameras{static_cast<double>(seen.size()), 0};
  if (const auto t = position_of(map, seen, kLeastParallax_rad)) {
    edit.start_moving(p, t->position, t->covariance, Why::kSeenElsewhere, cameras);
    record_past(edit, p, static_cast<std::size_t>(map.config().failures));
    ++report->dynamic;
  } else {
    edit.forget_past(p);
    edit.remove_point(p, Why::kNoOnePlace, cameras);
    ++report->removed;
  }
}

// One track alone left its point.
void let_slid_track_go(ClassifyEdit& edit, const MapCamera& camera, const ServerTrack& track, const MapPoint& p) {
  const Map& map = edit.map();
  const auto distance2 = gate_distance2({p.position, p.covariance}, camera.model, camera.frames.back().cam_from_world,
                                        track.seen.back().undistorted_px.cast<double>(), map.gate_sigma_px(camera));
  const Figures failed{static_cast<double>(track.gate_failures), distance2 ? std::sqrt(*distance2) : std::nan("")};
  edit.distrust_before(track, map.now());
  edit.unbind(camera.id, track, distance2 ? Why::kOutsideGate : Why::kBehindCamera, failed);
}

// Static points whose tracks failed the gate so often that it is no accident.
void judge_failures(ClassifyEdit& edit, const FrameSet& set, bool may_move, ClassifyReport* report) {
  const Map& map = edit.map();
  std::vector<BoundTrack> slid;
  std::set<PointId> elsewhere;
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    for (const auto& [id, track] : camera.tracks) {
      const MapPoint* p = map.find(track.point);
      if (p == nullptr || !p->rests() || track.gate_failures < map.config().failures) continue;
      if (may_move && (elsewhere.contains(p->id) || seen_elsewhere(map, *p))) {
        elsewhere.insert(p->id);
      } else {
        slid.push_back({camera.id, id});
      }
    }
  }
  for (const PointId id : elsewhere) judge_point(edit, *map.find(id), report);
  for (const BoundTrack& b : slid) {
    const ServerTrack& track = map.track(b);
    let_slid_track_go(edit, map.camera(b.camera), track, *map.find(track.point));
    ++report->slid;
  }
}

// Static points are seen exactly where their tracks are.
void let_go_of_other_corners(ClassifyEdit& edit, const MapPoint& p) {
  const std::vector<BoundTrack> bound = p.bound;
  for (const BoundTrack& b : bound) {
    const ServerTrack& t = edit.map().track(b);
    if (t.offset_px.norm() > kMostStaticOffset_px) edit.unbind(b.camera, t, Why::kOtherCorner, {t.offset_px.norm(), 0});
  }
}

// Moving points that stopped.
void settle(ClassifyEdit& edit, const FrameSet& set, const EvidenceConfig& config, ClassifyReport* report) {
  for (const MapPoint* p : edit.map().moving_points()) {
    if (p->last_seen != set.id || !stands_still(edit.map(), *p, config)) continue;
    let_go_of_other_corners(edit, *p);
    edit.stop_moving(*p, static_cast<int>(edit.map().sets_in(config.still_s)));
    ++report->stopped;
  }
}

// One camera alone cannot tell where its point is by now. What it has seen lately as something at rest, at whatever
// distance, is no longer taken for the point.
void give_back_resting(ClassifyEdit& edit, const FrameSet& set, const EvidenceConfig& config) {
  const Map& map = edit.map();
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    std::optional<double> median_depth;
    for (const auto& [id, track] : camera.tracks) {
      const MapPoint* p = map.find(track.point);
      if (p == nullptr || !p->moves() || p->last_seen == set.id) continue;
      if (!median_depth) median_depth = median_static_depth(map, camera);
      if (!may_rest(camera, track, *median_depth, config)) continue;
      const int frames = camera.frames_in(2 * config.still_s);
      edit.unbind(camera.id, track, Why::kStandsStill, {static_cast<double>(frames), 0});
    }
  }
}

void judge_free_tracks(ClassifyEdit& edit, const FrameSet& set, const EvidenceConfig& config, Workers& workers,
                       ClassifyReport* report) {
  std::vector<std::vector<TrackJudgement>> judged(set.frames.size());
  workers.each(judged.size(), [&](std::size_t i) {
    const MapCamera& camera = edit.map().camera(set.frames[i].camera);
    if (camera.frames.back().valid()) judged[i] = judge_tracks(edit.map(), camera, config);
  });
  for (std::size_t i = 0; i < judged.size(); ++i) {
    const MapCamera& camera = edit.map().camera(set.frames[i].camera);
    for (const TrackJudgement& j : judged[i]) {
      if (j.motion != j.track->motion) {
        edit.set_motion(camera.id, *j.track, j.motion,
                        {static_cast<double>(j.moving_neighbours), static_cast<double>(j.resting_neighbours)});
        if (j.co_moving_since) edit.mark_co_moving(*j.track, *j.co_moving_since);
      }
      report->moving_tracks += j.track->moves();
    }
  }
}

}  // namespace

ClassifyReport classify(ClassifyEdit& edit, const FrameSet& set, const ClassifyConfig& config, Workers& workers) {
  ClassifyReport report;
  judge_failures(edit, set, config.enabled, &report);
  if (!config.enabled) return report;
  FollowReport followed = follow_moving(edit, set, config.follow);
  rebind_moving(edit, set, config.follow, &followed);
  report.removed += followed.removed;
  report.rebound = followed.bound;
  settle(edit, set, config.evidence, &report);
  give_back_resting(edit, set, config.evidence);
  judge_free_tracks(edit, set, config.evidence, workers, &report);
  return report;
}

}  // namespace coslam
