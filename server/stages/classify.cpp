// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/stages/classify.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace coslam {
namespace {

struct Seen {
  BoundTrack track;
  View view;
};

// Observations of this very set, of cameras with a pose.
std::vector<Seen> seen_now(const Map& map, const MapPoint& p) {
  std::vector<Seen> out;
  for (const BoundTrack& b : p.bound) {
    const MapCamera& c = map.camera(b.camera);
    const FramePose& f = c.frames.back();
    const ServerTrack& t = c.tracks.at(b.track);
    if (f.set != map.now() || !f.valid() || f.map != p.map || t.seen.back().set != f.set) continue;
    out.push_back({b, {&c.model, f.cam_from_world, t.seen.back().undistorted_px.cast<double>()}});
  }
  return out;
}

int cameras_of(const std::vector<Seen>& seen) {
  std::vector<CameraId> cameras;
  for (const Seen& s : seen) {
    if (std::find(cameras.begin(), cameras.end(), s.track.camera) == cameras.end()) cameras.push_back(s.track.camera);
  }
  return static_cast<int>(cameras.size());
}

constexpr double kMinParallax_rad = 0.01;

// Where the point is now, by what is seen now; empty when the observations do not agree on one position.
std::optional<TriangulationResult> position_now(const Map& map, const std::vector<Seen>& seen) {
  if (cameras_of(seen) < 2) return std::nullopt;
  std::vector<View> views;
  double gate_px = 0, sigma_px = 0;
  for (const Seen& s : seen) {
    views.push_back(s.view);
    gate_px = std::max(gate_px, map.gate_sigma_px(map.camera(s.track.camera)));
    sigma_px = std::max(sigma_px, map.covariance_sigma_px(map.camera(s.track.camera)));
  }
  const TriangulationResult t = triangulate(views, sigma_px, kMinParallax_rad);
  if (t.status != TriangulationStatus::kOk || t.max_error_px > map.config().theta * gate_px) return std::nullopt;
  return t;
}

void take(MapPoint& p, const TriangulationResult& t, const FrameSet& set) {
  p.position = t.position;
  p.covariance = t.covariance;
  p.last_seen = set.id;
  p.last_ns = set.t_ns;
  ++p.views;
}

ServerTrack& track_of(Map& map, const BoundTrack& b) { return map.camera(b.camera).tracks.at(b.track); }

// Its observations so far are of a place that it left.
void forget_past(Map& map, MapPoint& p) {
  p.key_observations.clear();
  p.updated_from.clear();
  for (const BoundTrack& b : p.bound) track_of(map, b).distrusted_before = map.now().value;
}

void become_dynamic(Map& map, MapPoint& p, const TriangulationResult& t, const FrameSet& set) {
  p.state = PointState::kDynamic;
  forget_past(map, p);
  take(p, t, set);
  for (const BoundTrack& b : p.bound) {
    track_of(map, b).gate_failures = 0;
    track_of(map, b).moving = true;
  }
}

// Static points that several cameras see elsewhere; tracks of one camera are left to verify().
void doubt(Map& map, const FrameSet& set, const ClassifyConfig& config, ClassifyReport* report) {
  for (const CameraFrame& cf : set.frames) {
    for (auto& [id, track] : map.camera(cf.camera).tracks) {
      MapPoint* p = map.find(track.point);
      if (p == nullptr || p->state != PointState::kStatic || track.gate_failures < config.failures) continue;
      int elsewhere = 0, cameras = 0;
      for (const Seen& s : seen_now(map, *p)) {
        ++cameras;
        elsewhere += track_of(map, s.track).gate_failures > 0;
      }
      if (cameras < 2 || elsewhere < 2) continue;
      p->state = PointState::kUncertain;
      ++report->uncertain;
    }
  }
}

void judge(Map& map, const FrameSet& set, ClassifyReport* report) {
  std::vector<PointId> gone;
  for (auto& [id, p] : map.points()) {
    if (p.state != PointState::kUncertain) continue;
    if (const auto t = position_now(map, seen_now(map, p))) {
      become_dynamic(map, p, *t, set);
      ++report->dynamic;
    } else {
      gone.push_back(id);
    }
  }
  for (const PointId id : gone) {
    forget_past(map, *map.find(id));
    map.remove_point(id);
    ++report->removed;
  }
}

// One of more than two observations is wrong: which one, if without it the others agree.
std::optional<std::size_t> odd_one_out(const Map& map, const std::vector<Seen>& seen) {
  if (seen.size() < 3) return std::nullopt;
  std::optional<std::size_t> odd;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    std::vector<Seen> others = seen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (!position_now(map, others)) continue;
    if (odd) return std::nullopt;
    odd = i;
  }
  return odd;
}

// The present position explains every frame of the last ones, in at least two cameras.
bool stands_still(const Map& map, const MapPoint& p, int frames) {
  int cameras = 0;
  for (const BoundTrack& b : p.bound) {
    const MapCamera& c = map.camera(b.camera);
    const ServerTrack& t = c.tracks.at(b.track);
    if (static_cast<int>(t.seen.size()) < frames) continue;
    const double most_px = map.config().theta * map.gate_sigma_px(c);
    int checked = 0;
    for (std::size_t i = t.seen.size(); i-- > 0 && checked < frames;) {
      const FramePose* f = c.frame_at(t.seen[i].set);
      if (f == nullptr || f->map != p.map) continue;
      Eigen::Vector2d px;
      if (!project_world(c.model, f->cam_from_world, p.position, &px)) return false;
      if ((px - t.seen[i].undistorted_px.cast<double>()).norm() > most_px) return false;
      ++checked;
    }
    cameras += checked >= frames;
  }
  return cameras >= 2;
}

void become_static(Map& map, MapPoint& p, int frames) {
  p.state = PointState::kStatic;
  p.updated_from.clear();
  for (const BoundTrack& b : p.bound) {
    ServerTrack& t = track_of(map, b);
    t.moving = false;
    t.gate_failures = 0;
    t.distrusted_before = t.seen[t.seen.size() - std::min(t.seen.size(), static_cast<std::size_t>(frames))].set.value;
  }
  p.covariance = map.covariance_of(p);
}

void follow(Map& map, const FrameSet& set, const ClassifyConfig& config, ClassifyReport* report) {
  constexpr std::uint32_t kForgetSets = 60;  // without a position
  std::vector<PointId> gone;
  for (auto& [id, p] : map.points()) {
    if (p.state != PointState::kDynamic) continue;
    std::vector<Seen> seen = seen_now(map, p);
    auto t = position_now(map, seen);
    if (!t) {
      if (const auto odd = odd_one_out(map, seen)) {
        const BoundTrack b = seen[*odd].track;
        map.unbind(b.camera, track_of(map, b));
        t = position_now(map, seen_now(map, p));
      } else if (cameras_of(seen) >= 2) {
        // Two disagree, and nobody can tell who is right.
        for (const Seen& s : seen) ++track_of(map, s.track).gate_failures;
        if (track_of(map, seen.front().track).gate_failures >= config.failures) gone.push_back(id);
        continue;
      }
    }
    if (t) {
      take(p, *t, set);
      for (const Seen& s : seen) track_of(map, s.track).gate_failures = 0;
      map.record_motion(p);
      if (stands_still(map, p, config.still_frames)) {
        become_static(map, p, config.still_frames);
        ++report->stopped;
      }
    } else if (p.last_seen.value + kForgetSets < set.id.value) {
      gone.push_back(id);
    }
  }
  for (const PointId id : gone) {
    map.remove_point(id);
    ++report->removed;
  }
}

// Largest miss of the best static explanation of a track's newest views, near or infinitely far; pixels.
double static_miss_px(const std::vector<View>& views) {
  double near_px = 1e9;
  const TriangulationResult t = triangulate(views, 1.0, 0.0);
  if (t.status == TriangulationStatus::kOk) near_px = t.max_error_px;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const View& v : views) direction += world_ray(v);
  double far_px = 0;
  for (const View& v : views) {
    const Eigen::Vector3d in_cam = v.cam_from_world.rotation * direction;
    if (in_cam.z() <= 0) return near_px;
    far_px = std::max(far_px, (v.camera->project(in_cam) - v.undistorted_px).norm());
  }
  return std::min(near_px, far_px);
}

enum class Verdict : std::uint8_t { kYoung, kUndecided, kStill, kMoves };

struct Judged {
  ServerTrack* track;
  Eigen::Vector2d px;
  Verdict verdict = Verdict::kYoung;
  std::optional<Eigen::Vector2d> flow_px;  // over the last frames
};

constexpr std::size_t kFlowFrames = 8;

std::optional<Eigen::Vector2d> flow_of(const ServerTrack& t) {
  if (t.seen.size() <= kFlowFrames) return std::nullopt;
  return (t.seen.back().undistorted_px - t.seen[t.seen.size() - 1 - kFlowFrames].undistorted_px).cast<double>();
}

std::vector<View> newest_views(const MapCamera& camera, const ServerTrack& track, int frames) {
  std::vector<View> views;
  for (std::size_t i = track.seen.size(); i-- > 0 && static_cast<int>(views.size()) < frames;) {
    const FramePose* f = camera.frame_at(track.seen[i].set);
    if (f == nullptr || f->map != camera.map) continue;
    views.push_back({&camera.model, f->cam_from_world, track.seen[i].undistorted_px.cast<double>()});
  }
  return views;
}

Verdict verdict_of(const Map& map, const MapCamera& camera, const ServerTrack& track, const ClassifyConfig& config) {
  if (const MapPoint* p = map.find(track.point)) {
    return p->state == PointState::kDynamic ? Verdict::kMoves : Verdict::kStill;
  }
  const auto views = newest_views(camera, track, config.test_frames);
  if (static_cast<int>(views.size()) < config.test_frames / 2) return Verdict::kYoung;
  const double most_px = config.motion_px * camera.model.width_px / 640.0;
  return static_miss_px(views) > most_px ? Verdict::kMoves : Verdict::kUndecided;
}

// What the tracks around one do.
struct Around {
  int moving = 0, still = 0;
  Eigen::Vector2d moving_flow_px = Eigen::Vector2d::Zero(), still_flow_px = Eigen::Vector2d::Zero();  // means
};

Around around(const std::vector<Judged>& all, const Judged& j, double radius_px) {
  Around a;
  int flows_moving = 0, flows_still = 0;
  for (const Judged& o : all) {
    const double distance2 = (o.px - j.px).squaredNorm();
    if (&o == &j || distance2 > 9 * radius_px * radius_px) continue;
    const bool close = distance2 < radius_px * radius_px;
    if (o.verdict == Verdict::kMoves && close) {
      ++a.moving;
      if (o.flow_px && ++flows_moving > 0) a.moving_flow_px += *o.flow_px;
    }
    if (o.verdict == Verdict::kStill) {
      a.still += close;
      if (o.flow_px && ++flows_still > 0) a.still_flow_px += *o.flow_px;
    }
  }
  a.moving_flow_px /= std::max(1, flows_moving);
  a.still_flow_px /= std::max(1, flows_still);
  return a;
}

void judge_tracks(Map& map, const FrameSet& set, const ClassifyConfig& config, ClassifyReport* report) {
  for (const CameraFrame& cf : set.frames) {
    MapCamera& camera = map.camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    std::vector<Judged> all;
    for (auto& [id, track] : camera.tracks) {
      all.push_back({&track, track.seen.back().undistorted_px.cast<double>(), verdict_of(map, camera, track, config),
                     flow_of(track)});
    }
    const double radius_px = config.neighbour_radius * std::max(camera.model.width_px, camera.model.height_px);
    for (const Judged& j : all) {
      if (j.track->point != PointId()) continue;
      j.track->moving = false;
      if (j.verdict == Verdict::kYoung && !j.flow_px) continue;
      const Around a = around(all, j, radius_px);
      if (j.verdict == Verdict::kMoves) {
        j.track->moving = a.moving > 0 && a.moving >= config.neighbour_share * (a.moving + a.still);
      } else if (j.flow_px && a.moving >= 2) {
        // It goes with its moving neighbours rather than with what stands still.
        const double with_px = (*j.flow_px - a.moving_flow_px).norm(), apart_px = (*j.flow_px - a.still_flow_px).norm();
        j.track->moving = with_px < 0.5 * apart_px;
      }
      report->moving_tracks += j.track->moving;
    }
  }
}

}  // namespace

ClassifyReport classify(Map& map, const FrameSet& set, const ClassifyConfig& config) {
  ClassifyReport report;
  if (!config.enabled) return report;
  doubt(map, set, config, &report);
  judge(map, set, &report);
  follow(map, set, config, &report);
  judge_tracks(map, set, config, &report);
  return report;
}

}  // namespace coslam
