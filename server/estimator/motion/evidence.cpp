// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/evidence.h"

#include <algorithm>
#include <cstdint>
#include <span>

#include "common/geometry/robust.h"
#include "server/estimator/associate/verify.h"
#include "server/estimator/map/sighting.h"
#include "server/estimator/motion/co_moving.h"
#include "server/estimator/motion/rest_hypothesis.h"

namespace coslam {
namespace {

constexpr double kNearest = 0.15;  // nothing that stands still is expected closer, of the median depth

// Speed in the image at which a track has moved against where its point is now taken to be, over the last frames; empty
// when it is too young, or was further off than the gate once.
std::optional<double> apparent_speed_px_s(const Map& map, const MapCamera& c, const ServerTrack& t, const MapPoint& p,
                                          int frames) {
  const double most_px = map.config().theta * map.gate_sigma_px(c);
  double n = 0, sum_t = 0, sum_tt = 0;
  Eigen::Vector2d sum_r = Eigen::Vector2d::Zero(), sum_rt = Eigen::Vector2d::Zero();
  for (std::size_t i = t.seen.size(); i-- > 0 && n < frames;) {
    const FramePose* f = c.frame_at(t.seen[i].set);
    if (f == nullptr || f->map != p.map) continue;
    Eigen::Vector2d px;
    if (!project_world(c.model, f->cam_from_world, p.position, &px)) return std::nullopt;
    const Eigen::Vector2d r = (t.seen[i].undistorted_px + t.offset_px).cast<double>() - px;
    if (r.norm() > most_px) return std::nullopt;
    const double t_s = to_seconds(f->capture_ns - map.now_ns());
    n += 1;
    sum_t += t_s;
    sum_tt += t_s * t_s;
    sum_r += r;
    sum_rt += r * t_s;
  }
  const double spread = n * sum_tt - sum_t * sum_t;
  if (n < frames || spread <= 0) return std::nullopt;
  return ((n * sum_rt - sum_t * sum_r) / spread).norm();
}

// Its tracks have not moved against it for so long, in at least two cameras.
bool stood_still_for(const Map& map, const MapPoint& p, double time_s, double most_px_s) {
  int cameras = 0;
  for (const BoundTrack& b : p.bound) {
    const MapCamera& c = map.camera(b.camera);
    const ServerTrack& t = c.tracks.at(b.track);
    const int frames = c.frames_in(time_s, kLeastFrames);
    if (static_cast<int>(t.seen.size()) < frames) continue;
    const auto speed_px_s = apparent_speed_px_s(map, c, t, p, frames);
    if (!speed_px_s || *speed_px_s > c.model.px_from_640(most_px_s)) return false;
    ++cameras;
  }
  return cameras >= 2;
}

// What a thing at rest may seem to have moved in the last frames.
double still_px(const MapCamera& camera, std::size_t frames, const EvidenceConfig& config) {
  const TimeNs since_ns = camera.frames[camera.frames.size() - 1 - frames].capture_ns;
  return camera.model.px_from_640(config.still_px_s * to_seconds(camera.frames.back().capture_ns - since_ns));
}

std::vector<View> newest_views(const MapCamera& camera, const ServerTrack& track, int most) {
  return newest_views(camera, track, static_cast<std::size_t>(most), Past::kAll);
}

enum class Verdict : std::uint8_t { kYoung, kUndecided, kStill, kDoubtful, kMoves };

// Of a track by itself.
Verdict verdict_of(const Map& map, const MapCamera& camera, const ServerTrack& track, double median_depth,
                   const EvidenceConfig& config) {
  if (const MapPoint* p = map.find(track.point)) return p->moves() ? Verdict::kMoves : Verdict::kStill;
  const double nearest = kNearest * median_depth, to_640 = 640.0 / camera.model.width_px;
  const auto views = newest_views(camera, track, camera.frames_in(config.test_s, kLeastFrames));
  if (static_cast<int>(views.size()) < camera.frames_in(config.least_s, kLeastFrames)) return Verdict::kYoung;
  const auto goes_on = [&](std::size_t newest) {
    return goes_on_with_camera(track, std::span(views).first(newest), median_depth, config.doubtful_px / to_640);
  };
  if (goes_on(views.size())) return Verdict::kMoves;
  if (!moves_by_more(views, views.size() - 1, nearest, config.doubtful_px / to_640)) return Verdict::kUndecided;
  const auto few = static_cast<std::size_t>(camera.frames_in(config.still_s, kLeastFrames));
  for (const std::size_t frames : {few, 2 * few}) {  // a longer look for tracks with more noise
    if (views.size() <= frames) break;
    if (moves_by_more(views, frames, nearest, still_px(camera, frames, config))) continue;
    return goes_on(frames + 1) ? Verdict::kMoves : Verdict::kUndecided;
  }
  // Corners where one thing hides another slide when the camera moves: by a part of the parallax, and not for long.
  constexpr double kMostSlide = 2.5;
  const double slide_px =
      std::min(config.motion_parallax * parallax_px(views, median_depth), kMostSlide * config.motion_px / to_640);
  const double most_px = std::max(config.motion_px / to_640, slide_px);
  const bool moves = moves_by_more(views, views.size() - 1, nearest, most_px);
  return moves || goes_on(std::min(few + 1, views.size())) ? Verdict::kMoves : Verdict::kDoubtful;
}

struct Judged {
  const ServerTrack* track;
  Eigen::Vector2d px;
  Verdict verdict = Verdict::kYoung;
  std::optional<Eigen::Vector2d> flow_px;  // over the last frames
};

using Judgements = std::vector<const Judged*>;

std::optional<Eigen::Vector2d> flow_of(const MapCamera& c, const ServerTrack& t, const EvidenceConfig& config) {
  const auto frames = static_cast<std::size_t>(c.frames_in(config.least_s, kLeastFrames));
  if (t.seen.size() <= frames) return std::nullopt;
  return (t.seen.back().undistorted_px - t.seen[t.seen.size() - 1 - frames].undistorted_px).cast<double>();
}

Judgements between(const std::vector<Judged>& all, Verdict least, Verdict most) {
  Judgements out;
  for (const Judged& j : all) {
    if (j.verdict >= least && j.verdict <= most) out.push_back(&j);
  }
  return out;
}

// What some tracks around one do.
struct Neighbours {
  int close = 0;
  Eigen::Vector2d flow_px = Eigen::Vector2d::Zero();  // mean
};

// near_px: of those whose flow counts.
Neighbours neighbours_of(const Judgements& group, const Judged& j, double close_px, double near_px) {
  Neighbours a;
  int flows = 0;
  for (const Judged* o : group) {
    const double distance2 = (o->px - j.px).squaredNorm();
    if (o == &j || distance2 > near_px * near_px) continue;
    a.close += distance2 < close_px * close_px;
    if (o->flow_px && ++flows > 0) a.flow_px += *o->flow_px;
  }
  a.flow_px /= std::max(1, flows);
  return a;
}

// Its own verdict counts when its surroundings agree; without one it goes with its moving neighbours or with what
// stands still.
bool agrees_with_neighbours(const Judged& j, const Judgements& movers, bool moves, const Judgements& resting,
                            double radius_px, double share) {
  if (!moves && !j.flow_px) return false;
  const Neighbours moving = neighbours_of(movers, j, radius_px, radius_px);
  if (moving.close < (moves ? 1 : 2)) return false;
  const Neighbours still = neighbours_of(resting, j, radius_px, 3 * radius_px);
  if (moves) return moving.close >= share * (moving.close + still.close);
  return (*j.flow_px - moving.flow_px).norm() < 0.5 * (*j.flow_px - still.flow_px).norm();
}

// Where the two tracks, each with its offset, were one place, at the instant of the first one's i-th observation.
std::optional<TriangulationResult> meeting(const Map& map, const PairView& view, const ServerTrack& a, std::size_t i,
                                           const ServerTrack& b, std::size_t j) {
  const FramePose* f = view.first->frame_at(a.seen[i].set);
  if (f == nullptr) return std::nullopt;
  const TimeNs t_ns = view.first->taken_ns(*f);
  const auto va = view_at(*view.first, a, i, t_ns), vb = view_at(*view.second, b, j, t_ns);
  if (!va || !vb) return std::nullopt;
  return position_of(map, {{{view.first->id, a.id}, *va}, {{view.second->id, b.id}, *vb}}, 0);
}

// The two tracks were one place at every instant that both saw, as far back as asked: what a mismatch along the
// epipolar line does not keep up while the thing moves. Where that was at the first of them.
std::optional<Eigen::Vector3d> continuous_back(const Map& map, const PairView& view, const ServerTrack& a,
                                               const ServerTrack& b, int least, int most) {
  int checked = 0;
  std::optional<Eigen::Vector3d> oldest;
  for (std::size_t i = a.seen.size(); i-- > 0 && checked < most;) {
    const SetId at = a.seen[i].set;
    const auto other = b.index_at(at);
    if (!other) continue;
    if (!view.first->frame_at(at)->valid() || !view.second->frame_at(at)->valid()) continue;
    const auto met = meeting(map, view, a, i, b, *other);
    if (!met) return std::nullopt;
    oldest = met->position;
    ++checked;
  }
  return checked >= least ? oldest : std::nullopt;
}

// The camera's track is no longer at what its thing left.
bool has_left(const Map& map, const MapCamera& camera, const Rigid3& cam_from_world, const Feature& f,
              const Eigen::Vector3d& place) {
  Eigen::Vector2d px;
  if (!project_world(camera.model, cam_from_world, place, &px)) return true;
  return (f.px + f.track->offset_px.cast<double>() - px).norm() > map.config().theta * map.gate_sigma_px(camera);
}

}  // namespace

bool seen_elsewhere(const Map& map, const MapPoint& point) {
  const std::vector<Seen> seen = seen_now(map, point);
  return std::ranges::count_if(seen, [&](const Seen& s) { return map.track(s.track).gate_failures > 0; }) >= 2;
}

bool stands_still(const Map& map, const MapPoint& point, const EvidenceConfig& config) {
  // Twice as long a look for tracks with more noise.
  return stood_still_for(map, point, config.still_s, config.still_px_s) ||
         stood_still_for(map, point, 2 * config.still_s, config.still_px_s);
}

double median_static_depth(const Map& map, const MapCamera& camera) {
  std::vector<double> depths;
  for (const auto& [id, track] : camera.tracks) {
    const MapPoint* p = map.find(track.point);
    if (p == nullptr || !p->proven()) continue;
    depths.push_back((camera.frames.back().cam_from_world * p->position).z());
  }
  return upper_median(depths);
}

bool may_rest(const MapCamera& camera, const ServerTrack& track, double median_depth, const EvidenceConfig& config) {
  const int frames = camera.frames_in(2 * config.still_s, kLeastFrames);
  const std::vector<View> views = newest_views(camera, track, frames + 1);
  const auto last = static_cast<std::size_t>(frames);
  if (views.size() <= last) return false;
  return !moves_by_more(views, last, kNearest * median_depth, still_px(camera, last, config));
}

std::vector<TrackJudgement> judge_tracks(const Map& map, const MapCamera& camera, const EvidenceConfig& config) {
  std::vector<Judged> all;
  const double median_depth = median_static_depth(map, camera);
  for (const auto& [id, track] : camera.tracks) {
    all.push_back({&track, track.seen.back().undistorted_px.cast<double>(),
                   verdict_of(map, camera, track, median_depth, config), flow_of(camera, track, config)});
  }
  const double radius_px = kNeighbours * std::max(camera.model.width_px, camera.model.height_px);
  const Judgements resting = between(all, Verdict::kStill, Verdict::kStill),
                   moving = between(all, Verdict::kMoves, Verdict::kMoves),
                   doubtful = between(all, Verdict::kDoubtful, Verdict::kMoves);
  const auto agrees = [&](const Judged& j, const Judgements& movers, Verdict least) {
    return agrees_with_neighbours(j, movers, j.verdict >= least, resting, radius_px, config.neighbour_share);
  };
  std::vector<TrackJudgement> out;
  for (const Judged& j : all) {
    if (j.track->bound()) continue;
    TrackJudgement t{j.track, TrackMotion::kResting};
    if (agrees(j, moving, Verdict::kMoves)) {
      t.motion = TrackMotion::kMoving;
    } else if (agrees(j, doubtful, Verdict::kDoubtful)) {
      t.motion = TrackMotion::kDoubtful;
    }
    if (t.motion != j.track->motion) {
      t.moving_neighbours = neighbours_of(moving, j, radius_px, radius_px).close;
      t.resting_neighbours = neighbours_of(resting, j, radius_px, radius_px).close;
      if (t.motion == TrackMotion::kMoving) {
        t.co_moving_since = co_moving_since(camera, *j.track, median_depth, config);
      }
    }
    out.push_back(t);
  }
  return out;
}

bool moved_as_one(const Map& map, const PairView& view, const Feature& a, const Feature& b, double back_s) {
  const int back = std::max(view.first->frames_in(back_s, kLeastFrames), view.second->frames_in(back_s));
  const auto before = continuous_back(map, view, *a.track, *b.track, back / 2, back);
  if (!before) return false;
  if (a.track->moves() && b.track->moves()) return true;
  return has_left(map, *view.first, view.first_pose, a, *before) &&
         has_left(map, *view.second, view.second_pose, b, *before);
}

}  // namespace coslam
